"""The import contract of the client names each module of the API that has routes."""

import tomllib
from pathlib import Path

PROJECT = Path(__file__).parents[2]


def test_the_contract_names_each_module_with_routes() -> None:
    contracts = tomllib.loads((PROJECT / "pyproject.toml").read_text("utf-8"))["tool"]["importlinter"]["contracts"]
    [contract] = [each for each in contracts if each.get("source_modules") == ["stepramp.client"]]
    folder = PROJECT / "backend/stepramp/http_api"
    routes = {each.stem for each in folder.glob("*.py") if "= APIRouter(" in each.read_text("utf-8")}
    assert len(routes) > 20
    assert {f"stepramp.http_api.{name}" for name in routes} <= set(contract["forbidden_modules"])
