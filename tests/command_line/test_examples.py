"""The example of each command's help is run, against a real server; and the documentation is that of the help."""

from __future__ import annotations

import importlib.util
import json
import urllib.request
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from command_line.conftest import Ask
from stepramp.command_line.app import program
from stepramp.command_line.commands import COMMANDS
from stepramp.command_line.server_commands import STOP_EXAMPLE

DOCS = Path(__file__).parents[2] / "docs"
LIMIT = {"inputs": [{"input": "A2", "role": "limit", "axis": 0, "end": "low"}]}
program()  # It is then known which commands there are.


def put(url: str, body: object) -> Any:
    request = urllib.request.Request(url, json.dumps(body).encode(), {"content-type": "application/json"}, method="PUT")
    with urllib.request.urlopen(request, timeout=60) as answer:
        return json.load(answer)


@pytest.fixture
def prepare(ask: Ask, server: str, folder: Path, grbl: str) -> Callable[[str], dict[str, str]]:
    """Return what prepares an example: it returns the words that its placeholders stand for."""
    del folder

    def prepared(name: str) -> dict[str, str]:
        if name in ("move", "run", "home", "trace", "rollback", "keep", "restore", "status", "disconnect", "push"):
            assert ask("push design.json --port sim:// --yes").code == 0
        if name == "restore":
            assert ask("push other.json --to-axis 1 --yes --port sim://").code == 0
        if name == "rollback":
            assert ask("push slow.json --port sim:// --try --yes").code == 0
        if name == "trace":
            assert ask("move --port sim:// --by 50 --trace -").code == 0
        if name == "home":
            device = json.loads(ask("status --port sim:// --format json").out)
            route = f"{server}/api/v1/devices/{device['id']}"
            put(f"{route}/settings", LIMIT)
            low = device["position_steps"] - 100
            put(f"{route}/surroundings", {"axes": [{"axis": 0, "low_steps": low, "high_steps": None}]})
        if name.startswith("designs ") and name not in ("designs list", "designs save"):
            kept = json.loads(ask("designs save design.json --format json").out)["id"]
            assert ask(f"designs save other.json --to {kept}").code == 0
            return {"ID": kept} | history(name, kept)
        return {}

    def history(name: str, kept: str) -> dict[str, str]:
        """Return the same of what a design has behind it."""
        Path("trace.json").write_text('{"step": [1, 2]}')
        if name == "designs record":
            record = json.loads(ask(f"designs keep {kept} trace.json --kind trace --format json").out)
            return {"RECORD": record["id"]}
        if name == "designs pushed":
            assert ask(f"push design.json --port {grbl} --family grbl --yes").code == 0
            return {"PUSH": json.loads(ask("designs pushes --most 1 --format json").out)["pushes"][0]["id"]}
        if name == "designs import":
            assert ask("designs export --output library.jsonl").code == 0
        return {}

    return prepared


@pytest.mark.parametrize("described", COMMANDS.values(), ids=lambda each: each.name)
def test_the_example_of_the_help_runs(
    ask: Ask, prepare: Callable[[str], dict[str, str]], grbl: str, described: Any
) -> None:
    stand_for = prepare(described.name) | {"/dev/ttyUSB0": grbl}
    words = " ".join(stand_for.get(word, word) for word in described.example.removeprefix("stepramp ").split(" "))
    told = ask(words)
    assert told.code == 0, told.err
    assert told.out or told.err or Path(words.split()[-1]).stat().st_size


def test_stop_s_example_stops_all_devices(ask: Ask, server: str, folder: Path) -> None:
    del server, folder
    assert ask("push design.json --port sim:// --yes").code == 0
    told = ask(STOP_EXAMPLE.removeprefix("stepramp "))
    assert (told.code, told.err, "Stopped: device " in told.out) == (0, "", True)


def test_each_command_has_its_help_and_an_example(ask: Ask) -> None:
    names = [each.name for each in COMMANDS.values()]
    assert len(names) > 25
    for each in (*names, "serve", "stop"):
        told = ask(f"{each} --help")
        assert (told.code, f"Example: stepramp {each.split()[0]}" in told.out) == (0, True), each


def test_the_documentation_is_that_of_the_help_texts() -> None:
    found = importlib.util.spec_from_file_location("make_command_line", DOCS / "make_command_line.py")
    assert found is not None
    assert found.loader is not None
    script = importlib.util.module_from_spec(found)
    found.loader.exec_module(script)
    written = (DOCS / "command_line.md").read_text("utf-8").split(script.MARK)[1]
    assert written == "\n" + script.commands(), "run: .venv/bin/python docs/make_command_line.py"
