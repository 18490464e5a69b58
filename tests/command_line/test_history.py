"""What became of the library's designs, at the command line: records, pushes, and all of it as a file."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from command_line.conftest import Ask
from designs import document
from stepramp.data_folder import FOLDER_VARIABLE

TRACE = {"step": [1, 2], "traced_axis": 0}


def told(ask: Ask, words: str) -> Any:
    """Return what a command has told as JSON."""
    came_to = ask(f"{words} --format json")
    assert came_to.code == 0, came_to.err
    return json.loads(came_to.out)


@pytest.fixture
def kept(ask: Ask, server: str, folder: Path) -> str:
    """Return a design of the server's library, with two revisions."""
    del server, folder
    design_id = str(told(ask, "designs save design.json --name Stage --tag gauge")["id"])
    assert ask(f"designs save other.json --to {design_id}").code == 0
    Path("trace.json").write_text(json.dumps(TRACE))
    return design_id


def test_a_record_is_kept_and_comes_back_as_it_was(ask: Ask, kept: str) -> None:
    first = told(ask, f"designs keep {kept} trace.json --kind trace --revision 1 --note 'old drive'")
    newest = told(ask, f"designs keep {kept} trace.json --kind capture")
    assert (first["revision"], first["note"], newest["revision"]) == (1, "old drive", 2)
    listed = ask(f"designs records {kept} --format csv").out.splitlines()
    assert [line.split(",")[:3] for line in listed[1:]] == [
        [newest["id"], "capture", "2"],
        [first["id"], "trace", "1"],
    ]
    assert ask(f"designs record {kept} {first['id']} --output again.json").code == 0
    assert json.loads(Path("again.json").read_text()) == TRACE


def test_of_a_long_trace_as_much_is_kept_as_a_record_has_and_that_is_told(ask: Ask, kept: str) -> None:
    steps = list(range(1, 120_001))
    ticks = [step * 1000.5 for step in steps]
    long = {"traced_axis": 0, "timer_hz": 2e6, "step": steps, "measured_ticks": ticks, "none": []}
    Path("long.json").write_text(json.dumps(long))
    came_to = ask(f"designs keep {kept} long.json --kind trace --format json")
    assert (came_to.code, came_to.err) == (
        0,
        "stepramp: the trace has 120,000 steps: 5,000 of them, evenly apart, are kept\n",
    )
    record = json.loads(came_to.out)["id"]
    back = json.loads(ask(f"designs record {kept} {record}").out)
    assert (len(back["step"]), back["step"][0], back["step"][-1]) == (5000, 1, 120_000)
    assert back["measured_ticks"] == [step * 1000.5 for step in back["step"]]
    assert (back["timer_hz"], back["none"]) == (2e6, [])


def test_a_push_is_told_with_its_revision_and_its_design_comes_back(ask: Ask, kept: str, grbl: str) -> None:
    assert ask(f"push other.json --port {grbl} --family grbl --yes").code == 0
    answer = told(ask, f"designs pushes --design {kept} --most 1")
    [push] = answer["pushes"]
    assert push["verified"]
    [seen] = [each for each in told(ask, "designs devices")["devices"] if each["id"] == push["device_id"]]
    assert (seen["family"], seen["port"]) == ("grbl", grbl)
    assert told(ask, f"designs pushes --device {seen['id']}")["pushes"][0]["id"] == push["id"]
    table = ask("designs pushes --most 1").out
    assert "read back as sent" in table
    assert f"axis 0: Other (revision 2 of {kept})" in table
    came_to = ask(f"designs pushed {push['id']}")
    assert json.loads(came_to.out)["name"] == "Other"
    assert f"to {push['device']}: read back as sent" in came_to.err


def test_a_whole_library_goes_to_another_folder_and_back(
    ask: Ask, kept: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert ask("designs export --output library.jsonl").code == 0
    monkeypatch.setenv(FOLDER_VARIABLE, str(tmp_path / "elsewhere"))
    first = told(ask, "designs import library.jsonl --alone")
    assert first["designs"] == told(ask, "designs list --alone")["count"] > 0
    assert told(ask, f"designs revisions {kept} --alone")["revisions"] == 2
    again = ask("designs import library.jsonl --alone")
    assert again.out.splitlines()[1].split() == ["designs", "0"]
    Path("changed.json").write_text(json.dumps(document(move__steps=7)))
    assert ask(f"designs save changed.json --to {kept} --alone").code == 0
    assert ask("designs export --output back.jsonl --alone").code == 0
    assert told(ask, "designs import back.jsonl")["revisions"] == 1


@pytest.mark.parametrize(
    ("words", "code", "why"),
    [
        ("designs keep ID absent.json --kind trace", 2, "FILE is 'absent.json'; allowed: a file with what was told as"),
        ("designs keep ID list.json --kind trace", 2, "FILE is 'list.json'; allowed: a file with a JSON object."),
        ("designs keep ID trace.json --kind photo", 2, "--kind is 'photo'; allowed: trace, capture, stall_map."),
        ("designs keep ID trace.json", 2, "--kind is missing; allowed: what it is: trace, capture or stall_map."),
        ("designs keep ID trace.json --kind trace --revision 3", 1, "The design has no revision 3."),
        ("designs record ID none", 1, "There is no "),
        ("designs pushed none", 1, "There is no push"),
        ("designs pushes --most 0", 2, "--most is 0; allowed: a whole number from 1 to 500."),
        ("designs import list.json", 2, "FILE is '[]'; allowed: a library that StepRamp has saved as a file."),
    ],
)  # fmt: skip
def test_what_can_t_be_is_refused_in_the_words_of_the_command_line(
    ask: Ask, kept: str, words: str, code: int, why: str
) -> None:
    Path("list.json").write_text("[]")
    came_to = ask(words.replace("ID", kept))
    assert (came_to.code, came_to.out) == (code, "")
    assert came_to.err.startswith(f"stepramp: {why}"), came_to.err


def test_which_axis_was_pushed_is_asked_for_where_it_was_several(ask: Ask, kept: str, grbl: str) -> None:
    del kept
    assert ask(f"push design.json other.json --port {grbl} --family grbl --yes").code == 0
    [push] = told(ask, "designs pushes --most 1")["pushes"]
    came_to = ask(f"designs pushed {push['id']}")
    assert (came_to.code, came_to.err) == (2, "stepramp: --axis is missing; allowed: one of 0, 1.\n")
    assert json.loads(ask(f"designs pushed {push['id']} --axis 1").out)["name"] == "Other"
