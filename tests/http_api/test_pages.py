import re
import shutil
from pathlib import Path

import pytest
from starlette.applications import Starlette
from starlette.testclient import TestClient

from stepramp.http_api import pages
from stepramp.http_api.app import create_app
from stepramp.http_api.page_files import PageFiles
from stepramp.http_api.pages import frontend

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


def test_the_icon_that_browsers_ask_for_by_themselves_is_the_page_s(client: TestClient) -> None:
    icon = client.get("/favicon.ico")
    assert (icon.status_code, icon.headers["content-type"]) == (200, "image/svg+xml")
    assert icon.content == client.get("/favicon.svg").content


def test_plotly_is_the_installed_package_s(client: TestClient) -> None:
    response = client.get("/assets/plotly/plotly.min.js")
    assert response.headers["content-type"].startswith("text/javascript")
    etag = {"if-none-match": response.headers["etag"]}
    assert client.get("/assets/plotly/plotly.min.js", headers=etag).status_code == 304
    assert "plotly.js v" in response.text[:200]


def test_a_browser_asks_once_for_what_the_page_is_made_of(client: TestClient) -> None:
    start = client.get("/")
    assert start.headers["cache-control"] == "no-cache"
    links = re.findall(r"(?:src|href)=\"(page-[^\"]+)\"", start.text)
    version = links[0].partition("/")[0]
    for link in (*links, f"{version}/assets/methods.js", f"{version}/model/fields.js"):
        kept = client.get(f"/{link}")
        assert kept.status_code == 200
        assert kept.headers["cache-control"] == "max-age=31536000, immutable"
        asked = client.get(f"/{link.partition('/')[2]}")
        assert asked.content == kept.content
        assert asked.headers["cache-control"] == "no-cache"
    assert client.head(f"/{version}/app/main.js").status_code == 200
    assert client.post(f"/{version}/app/main.js").status_code == 405
    assert client.get(f"/{version}/api/v1/health").status_code == 404


def test_another_version_of_the_page_has_other_addresses(tmp_path: Path) -> None:
    folder = tmp_path / "frontend"
    shutil.copytree(frontend(), folder)
    client = TestClient(Starlette())
    client.app.router.default = PageFiles(folder)  # type: ignore[attr-defined]

    def main_module() -> str:
        found = re.search(r"page-\w+/app/main\.js", client.get("/").text)
        assert found
        return found[0]

    before = main_module()
    assert main_module() == before
    with (folder / "ui" / "dom.js").open("a") as changed:
        changed.write("// more\n")
    after = main_module()
    assert after != before
    assert client.get(after).status_code == 200
    assert client.get(before).status_code == 404


def test_the_documentation_is_found_without_a_slash_at_its_end(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "index.html").write_text("the documentation")
    monkeypatch.setattr(pages, "documentation", lambda: tmp_path)
    client = TestClient(create_app(data=tmp_path), base_url="http://127.0.0.1:8000")
    sent = client.get("/help", follow_redirects=False)
    assert (sent.status_code, sent.headers["location"]) == (307, "/help/")
    assert client.get("/help").text == "the documentation"


def test_the_description_gives_every_number_of_an_answer_a_unit_or_a_meaning(client: TestClient) -> None:
    description = client.get("/api/v1/openapi.json").json()
    for name, schema in description["components"]["schemas"].items():
        for field, about in schema.get("properties", {}).items():
            kinds = {about.get("type"), *(each.get("type") for each in about.get("anyOf", []))}
            if kinds & {"number", "integer", "array"} and field not in ("value", "errors"):
                known = "description" in about or about.get("items", {}).get("$ref")
                assert known, f"{name}.{field} has no description"
