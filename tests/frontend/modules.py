"""The page's modules that know no page, run by Node, without a browser."""

from __future__ import annotations

import json
import math
import shutil
import subprocess
from pathlib import Path
from typing import Any, Self

from starlette.testclient import TestClient

from stepramp.http_api.app import create_app

FRONTEND = Path(__file__).parents[2] / "frontend"
HARNESS = Path(__file__).with_name("modules.mjs")


class Modules:
    """A process that has the modules at hand; `evaluate` is that of Playwright's pages."""

    def __init__(self, folder: Path) -> None:
        copy = folder / "frontend"
        shutil.copytree(FRONTEND, copy)
        (copy / "assets").mkdir()
        server = TestClient(create_app(), "http://127.0.0.1")
        for name in ("methods.js", "shapes.js", "motors.js", "design_fields.js", "device_fields.js"):
            (copy / "assets" / name).write_bytes(server.get(f"/assets/{name}").content)
        # What the server tells browsers by its media type, Node wants to read here.
        (copy / "package.json").write_text('{"type": "module"}')
        command = ["node", str(HARNESS), f"{copy.as_uri()}/"]
        self._process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)

    def evaluate(self, script: str, value: object = None) -> Any:
        """Return what a function of JavaScript makes of a value, or what an expression is."""
        assert self._process.stdin
        assert self._process.stdout
        self._process.stdin.write(json.dumps({"script": script, "value": _packed(value)}) + "\n")
        self._process.stdin.flush()
        answer = json.loads(self._process.stdout.readline(), object_hook=_unpacked)
        assert "error" not in answer, answer["error"]
        return answer.get("value")

    def call(self, module: str, function: str, *arguments: object) -> Any:
        """Call a function of one of the modules."""
        script = "async ([module, name, values]) => (await import(`/${module}`))[name](...values)"
        return self.evaluate(script, [module, function, list(arguments)])

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._process.communicate(timeout=10)


def _packed(value: object) -> object:
    if isinstance(value, float) and not math.isfinite(value):
        return {"$number": "NaN" if math.isnan(value) else "Infinity" if value > 0 else "-Infinity"}
    if isinstance(value, dict):
        return {name: _packed(each) for name, each in value.items()}
    return [_packed(each) for each in value] if isinstance(value, list | tuple) else value


def _unpacked(found: dict[str, Any]) -> Any:
    return float(found["$number"].replace("Infinity", "inf")) if "$number" in found else found
