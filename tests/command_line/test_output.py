from __future__ import annotations

import io
import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from rich.console import Console

import stepramp
from stepramp.command_line.output import Rows, as_table, figure, show, tell, write_csv
from stepramp.http_api.library_models import KeptAnswer

ROWS = Rows(
    ("device", "state", "position [steps]", "limits [steps]"), [("1", "stopping", -2_000_000, "-100000…1000000")], "One"
)


@pytest.mark.parametrize("width", [24, 80, 400])
def test_no_value_is_cut_however_narrow_the_terminal(width: int) -> None:
    written = io.StringIO()
    Console(file=written, width=width).print(as_table(ROWS))
    shown = "".join(written.getvalue().split())
    if width >= 80:
        assert all(each in written.getvalue() for each in ("stopping", "-2,000,000", "-100000…1000000", "[steps]"))
    assert shown.count("…") == 1, "only the one that is in a value"


def test_csv_has_numbers_as_they_are_and_nothing_for_what_isn_t_there(capsys: pytest.CaptureFixture[str]) -> None:
    write_csv(Rows(("a", "b"), [(1234567, None), (0.1, "x,y")]))
    assert capsys.readouterr().out == 'a,b\n1234567,\n0.1,"x,y"\n'


@pytest.mark.parametrize(
    ("value", "text"), [(None, "–"), (True, "yes"), (1234567, "1,234,567"), (0.000012345678, "1.23457e-05"), ("a", "a")]
)
def test_figures_are_as_people_read_them(value: object, text: str) -> None:
    assert figure(value) == text


STEERING = "a\x1b[31m\x9b2J\a\u202eb\n\t\U000e0041 é 日 \N{WAVING WHITE FLAG}\u200d\N{RAINBOW}"
"""Colours, clears the screen, rings, and turns the order of letters; the rest is text."""
SHOWN = "a\\x1b[31m\\x9b2J\\x07\\u202eb\n\t\\U000e0041 é 日 \N{WAVING WHITE FLAG}\u200d\N{RAINBOW}"


def test_text_of_others_steers_no_terminal(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    rows = Rows(("a",), [(STEERING,)], title=STEERING)
    written = io.StringIO()
    Console(file=written, width=400).print(as_table(rows))
    tell(STEERING)
    monkeypatch.setattr(sys.stdout, "isatty", lambda: True)
    write_csv(rows)
    told = capsys.readouterr()
    answer = KeptAnswer.model_construct(name=STEERING)
    show("json", answer)
    as_json = capsys.readouterr().out
    for text in (written.getvalue(), told.err, told.out, as_json):
        assert not {"\x1b", "\x9b", "\a", "\u202e", "\U000e0041"} & set(text)
    assert told.err == f"stepramp: {SHOWN}\n"
    assert told.out == f'a\n"{SHOWN}"\n'
    assert json.loads(as_json)["name"] == STEERING


def test_a_program_is_given_text_as_it_is(capsys: pytest.CaptureFixture[str]) -> None:
    write_csv(Rows(("a",), [("\x1b\u202e",)]))
    assert capsys.readouterr().out == "a\n\x1b\u202e\n"


@pytest.mark.skipif(sys.platform == "win32", reason="has no limit of a file's size")
@pytest.mark.parametrize("unbuffered", ["", "1"])
def test_an_output_that_has_no_room_for_all_is_told(folder: Path, unbuffered: str) -> None:
    limit = "import resource, signal; signal.signal(25, signal.SIG_IGN); resource.setrlimit(1, (5000, 5000)); "
    for words in ("['profile', 'design.json', '--alone', '--format', 'json']", "['export', 'csv', 'design.json', '-']"):
        script = f"{limit}import sys; from stepramp.command_line.main import main; sys.exit(main({words}))"
        environment = {
            **os.environ,
            "PYTHONPATH": str(Path(stepramp.__file__).parents[1]),
            "PYTHONUNBUFFERED": unbuffered,
        }
        with (folder / "out").open("w") as out:
            words_given = [sys.executable, "-c", script]
            told = subprocess.run(words_given, stdout=out, stderr=subprocess.PIPE, env=environment, check=False)
        assert (told.returncode in (1, 2), b"File too large" in told.stderr) == (True, True), (told, words)
