import re

from starlette.testclient import TestClient

# Names of XML vocabularies, which nothing fetches.
NAMES_NOT_ADDRESSES = re.compile(r"https?://www\.w3\.org/[\w/]+")


def addresses(text: str) -> list[str]:
    return re.findall(r"(?:https?:)?//[\w.-]+\.\w+[^\s\"')]*", NAMES_NOT_ADDRESSES.sub("", text))


def test_the_page_and_the_api_page_load_from_this_server_alone(client: TestClient) -> None:
    for page in ("/", "/docs"):
        html = client.get(page).text
        assert "<title>StepRamp" in html
        loaded = re.findall(r"(?:src|href)=\"([^\"]+)\"", html)
        assert loaded
        for link in loaded:
            assert addresses(link) == []
            if not link.startswith("#"):
                assert client.get(f"/{link.lstrip('./')}").status_code == 200, link


def test_plotly_is_the_installed_package_s(client: TestClient) -> None:
    response = client.get("/assets/plotly/plotly.min.js")
    assert response.headers["content-type"].startswith("text/javascript")
    etag = {"if-none-match": response.headers["etag"]}
    assert client.get("/assets/plotly/plotly.min.js", headers=etag).status_code == 304
    assert "plotly.js v" in response.text[:200]


def test_the_description_gives_every_number_of_an_answer_a_unit_or_a_meaning(client: TestClient) -> None:
    description = client.get("/api/v1/openapi.json").json()
    for name, schema in description["components"]["schemas"].items():
        for field, about in schema.get("properties", {}).items():
            kinds = {about.get("type"), *(each.get("type") for each in about.get("anyOf", []))}
            if kinds & {"number", "integer", "array"} and field not in ("value", "errors"):
                known = "description" in about or about.get("items", {}).get("$ref")
                assert known, f"{name}.{field} has no description"
