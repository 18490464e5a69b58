"""A method or a shape is one new file in its folder below backend/stepramp: it is known everywhere by being there."""

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from designs import document

PACKAGE = Path(__file__).parents[2] / "backend" / "stepramp"

TRIAL, TRIAL_SHAPE = re.findall(
    r"```python\n(.*?)```", (PACKAGE.parents[1] / "docs/adding_a_method.md").read_text("utf-8"), re.DOTALL
)
"""The files of docs/adding_a_method.md."""

ASK = """
import json, sys
from starlette.testclient import TestClient
from stepramp.http_api.app import create_app

design = json.load(sys.stdin)
client = TestClient(create_app(), "http://127.0.0.1")
post = lambda path, **body: client.post(f"/api/v1/{path}", json={"design": design, **body})
schemas = client.get("/api/v1/openapi.json").json()["components"]["schemas"]
print(json.dumps({
    "enum": schemas["Method"]["properties"]["name"]["enum"],
    "served": [each for each in client.get("/api/v1/methods").json()["methods"] if each["name"] == "trial"],
    "curves": post("curves", methods=["trial", "newton"]).json(),
    "profile": post("profile").json(),
    "csv": post("export/csv").text.splitlines()[1],
    "svg": post("export/svg", methods=["exact"]).text,
    "shapes": schemas["RampShape"]["properties"]["name"]["enum"],
    "shaped": client.post("/api/v1/profile", json={
        "design": {**design, "schema": "stepramp/2", "method": {"name": "ideal"},
                   "ramp": {**design["ramp"], "shape": {"name": "at_once"}}}
    }).json(),
    "refused": client.post("/api/v1/profile", json={"design": {**design, "method": {"name": "none"}}}).json(),
}))
"""


@pytest.fixture(scope="module")
def answers(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """What a server answers whose folders have one file more each, asked with a design of the new method."""
    folder = tmp_path_factory.mktemp("with_trial")
    shutil.copytree(PACKAGE, folder / "stepramp")
    (folder / "stepramp" / "methods" / "trial.py").write_text(TRIAL, "utf-8")
    (folder / "stepramp" / "shapes" / "at_once.py").write_text(TRIAL_SHAPE, "utf-8")
    shutil.copytree(PACKAGE.parents[1] / "frontend", folder / "stepramp" / "frontend")
    design = document(method={"name": "trial"}, move__steps=500)
    ran = subprocess.run(
        [sys.executable, "-c", ASK],
        input=json.dumps(design), env=os.environ | {"PYTHONPATH": str(folder)},
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    return json.loads(ran.stdout)


def test_a_design_may_name_the_new_method_and_is_told_of_it(answers: Any) -> None:
    assert answers["enum"] == [
        "exact", "ideal", "midpoint", "first_order", "second_order", "compromise", "tuned", "trial", "newton",
        "austin", "table",
    ]  # fmt: skip
    [rejection] = answers["refused"]["errors"]
    assert rejection["allowed"] == ", ".join(answers["enum"])


def test_the_page_is_served_it(answers: Any) -> None:
    [served] = answers["served"]
    assert (served["label"], served["arithmetics"]) == ("Trial", ["float64", "float32"])
    assert served["style"] == {"light": "#123456", "dark": "#abcdef", "dash": None}
    assert served["code"] is None


def test_it_is_planned_drawn_and_exported(answers: Any) -> None:
    # 100 steps up and down, at 2000 ticks times two; 1000 steps/s of 2 MHz.
    assert answers["profile"]["intervals_ticks"] == [4000] * 100 + [2000] * 300 + [4000] * 100
    trial, newton = answers["curves"]["methods"]
    assert (trial["method"], newton["method"]) == ("trial", "newton")
    assert set(trial["intervals_ticks"]) == {2000, 4000}
    assert answers["csv"].startswith("1,4000,2000.0,0.0,1,")
    assert "#123456" in answers["svg"]


def test_a_ramp_may_have_the_new_shape(answers: Any) -> None:
    assert answers["shapes"] == ["constant", "s_curve", "cosine", "drawn", "torque", "at_once"]
    assert answers["shaped"]["intervals_ticks"] == [8000] + [2000] * 498 + [8000]
