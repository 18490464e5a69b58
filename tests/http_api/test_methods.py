"""The list of methods that the page and other programs are served."""

import json

from starlette.testclient import TestClient

NAMES = [
    "exact", "ideal", "midpoint", "first_order", "second_order", "compromise", "tuned", "newton", "austin", "table",
]  # fmt: skip


def test_the_methods_are_served_with_all_that_the_page_says_of_them(client: TestClient) -> None:
    answer = client.get("/api/v1/methods").json()
    assert answer["reference"] == "exact"
    by_name = {each["name"]: each for each in answer["methods"]}
    assert list(by_name) == NAMES
    assert by_name["first_order"] == {
        "name": "first_order",
        "label": "1st order",
        "formula": "20",
        "help": "Each interval from the one before with three multiplications. From rest it errs most in its first "
        "steps.",
        "arithmetics": ["float32", "float64", "fixed"],
        "style": {"light": "#d2601a", "dark": "#ee6a1a", "dash": [9, 3]},
        "plays_table": False,
        "is_tuned": False,
        "is_shown_at_first": True,
        "code": {"format": "c_first_order", "label": "1st order", "help": "Formula 20: p (1 + q), the quickest."},
    }
    assert by_name["ideal"]["style"]["dash"] == [2, 3]
    assert [name for name in NAMES if by_name[name]["code"]] == [
        "first_order", "second_order", "compromise", "newton",
    ]  # fmt: skip
    assert [name for name in NAMES if by_name[name]["plays_table"]] == ["table"]
    assert [name for name in NAMES if by_name[name]["is_tuned"]] == ["tuned"]


def test_the_page_imports_what_the_api_answers(client: TestClient) -> None:
    module = client.get("/assets/methods.js")
    assert module.headers["content-type"].partition(";")[0] == "text/javascript"
    answer = module.text.removeprefix("export default ").removesuffix(";\n")
    assert json.loads(answer) == client.get("/api/v1/methods").json()


def test_they_are_those_that_a_design_may_have(client: TestClient) -> None:
    schema = client.get("/api/v1/openapi.json").json()["components"]["schemas"]["Method"]
    assert schema["properties"]["name"]["enum"] == NAMES


def test_the_shapes_are_served_with_their_fields_and_methods(client: TestClient) -> None:
    answer = client.get("/api/v1/shapes").json()
    assert answer["usual"] == "constant"
    by_name = {each["name"]: each for each in answer["shapes"]}
    assert list(by_name) == ["constant", "s_curve", "cosine", "drawn", "torque"]
    assert by_name["s_curve"]["label"] == "S-curve"
    assert by_name["s_curve"]["fields"] == ["jerk_steps_per_s3", "deceleration_jerk_steps_per_s3"]
    assert by_name["drawn"]["methods"] == ["exact", "ideal", "midpoint", "newton", "table"]
    assert by_name["constant"]["methods"] == [each["name"] for each in client.get("/api/v1/methods").json()["methods"]]
    assert [each["begins_alike"] for each in answer["shapes"]] == [True, False, False, True, True]
    page = client.get("/assets/shapes.js")
    assert json.loads(page.text.removeprefix("export default ").removesuffix(";\n")) == answer
