"""Commands that ask a running server: what they print, what they refuse, and what they end with."""

from __future__ import annotations

import csv
import io
import json
import os
import re
import signal
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

import stepramp
from command_line.conftest import Ask, begun
from designs import design, document
from stepramp.client import Client
from stepramp.client.calls import Call
from stepramp.command_line.main import main
from stepramp.command_line.motion import Motion, stopping
from stepramp.command_line.pushing import backups
from stepramp.design import Design
from stepramp.errors import NoServer, Overloaded, Refused, TooOften, Unauthorized
from stepramp.http_api.backups_models import BackupAnswer, BackupsAnswer
from stepramp.methods import METHODS
from stepramp.ramp.profile import profile_of
from waiting import until

pytestmark = pytest.mark.usefixtures("server", "folder")
unix_only = pytest.mark.skipif(sys.platform == "win32", reason="signals and pseudo-terminals of Unix")


@pytest.fixture
def device(ask: Ask) -> str:
    """Connect the virtual controller, with a ramp."""
    assert ask("push design.json --port sim:// --yes").code == 0
    return "--port sim://"


def until_state(ask: Ask, device: str, state: str) -> None:
    until(lambda: json.loads(ask(f"status {device} --format json").out)["state"] == state)


def test_a_format_is_for_people_spreadsheets_or_programs(ask: Ask) -> None:
    own = profile_of(design())
    assert "peak speed" in ask("profile design.json").out
    answer = json.loads(ask("profile design.json --format json").out)
    assert answer["intervals_ticks"] == own.intervals_ticks.tolist()
    rows = list(csv.DictReader(io.StringIO(ask("profile design.json --format csv").out)))
    assert [int(row["intervals_ticks"]) for row in rows] == own.intervals_ticks.tolist()


def test_a_design_may_come_over_standard_input(ask: Ask, monkeypatch: pytest.MonkeyPatch) -> None:
    class Piped:
        buffer = io.BytesIO(json.dumps(document(move__steps=7)).encode())

    monkeypatch.setattr(sys, "stdin", Piped())
    assert len(ask("profile - --format csv").out.splitlines()) == 8


@pytest.mark.parametrize(
    ("words", "code", "told"),
    [
        ("profile design.json --points x", 2, "--points is 'x'; allowed: a whole number."),
        ("profile design.json --points 1", 2, "--points is 1; allowed: a whole number from 10 to"),
        ("profile absent.json", 2, "DESIGN is 'absent.json'; allowed: a file with a design document (No such file"),
        ("profile", 2, "DESIGN is missing; allowed: file with a design document"),
        ("profile design.json --format xml", 2, "--format is 'xml'; allowed: table, csv, json."),
        ("profile design.json --loud", 2, "--loud is no option of `stepramp profile`; allowed: --alone, --format"),
        ("errors design.json --method best", 2, "--method is 'best'; allowed: "),
        ("fit design.json", 2, "--rows is missing; allowed: exactly one of --rows, --error, --bytes"),
        ("fit design.json --error 2", 2, "--error is 2.0; allowed: a number from 1e-06 to 1"),
        ("play design.json --range 9 --target now", 2, "--target is 'now'; allowed: an instant [µs], a colon and"),
        ("run --speed 400 --for 0", 2, "--for is 0.0; allowed: a number from 0.05 to 86,400 s."),
        ("status --for 3", 2, "--for is 3.0; allowed: nothing without --watch."),
        ("status --device 99", 1, "There is no device '99'."),
        ("bogus", 2, "command is 'bogus'; allowed: serve, profile, "),
        ("profile design.json --server ftp://a", 2, "--server is 'ftp://a'; allowed: the address of a server"),
        ("profile design.json --server http://127.0.0.1:1", 3, "No server answers at http://127.0.0.1:1."),
        ("profile design.json --server http://a --alone", 2, "--server is 'http://a'; allowed: nothing, since --alone"),
        ("torque design.json", 2, "motor is missing; allowed: "),
        ("designs diff none 1 2", 1, "There is no design"),
        ("designs diff none 0 1", 2, "REVISION is '0'; allowed: "),
        ("designs diff none 1 0", 2, "OTHER is '0'; allowed: "),
        ("designs diff none x 1", 2, "REVISION is 'x'; allowed: a whole number."),
        ("designs save design.json --to ID --name other", 2, "--name is 'other'; allowed: nothing with --to"),
        ("designs save design.json --to ID --notes ''", 2, "--notes is ''; allowed: nothing with --to"),
        ("designs save design.json --to ID --tag a", 2, "--tag is "),
        ("designs describe ID", 2, "--name is missing; allowed: at least one of --name, --notes and --tag."),
        ("designs describe ID --name ' '", 2, "--name is ' '; allowed: a text that isn't empty."),
        ("designs duplicate ID --name ''", 2, "--name is ''; allowed: a text that isn't empty."),
        ("designs list Stage Copy", 2, "Copy is too much; allowed: [WORDS], in quotes where it has"),
        ("devices now", 2, "now is too much; allowed: options only."),
        ("schedule - -", 2, "DESIGN is '-'; allowed: standard input once only, files besides."),
        ("capture - --design -", 2, "--design is '-'; allowed: a file, since FILE is standard input."),
        ("play capture.csv --range 9 --target 0:5", 2, "TABLE is 'capture.csv'; allowed: a file with a lookup table"),
        ("--install-completion zsh", 2, "--install-completion is 'zsh'; allowed: nothing: it is for the shell"),
        ("--show-completion nosuch", 2, "--show-completion is 'nosuch'; allowed: nothing: it is for the shell"),
    ],
)
def test_a_refusal_names_the_option_or_field_and_what_is_allowed(
    ask: Ask, device: str, words: str, code: int, told: str
) -> None:
    del device
    came_to = ask(words)
    assert (came_to.code, came_to.out) == (code, "")
    assert came_to.err.startswith(f"stepramp: {told}"), came_to.err


@pytest.mark.parametrize(
    "words",
    [
        "profile design.json --points 0",
        "profile design.json --points 99999999999999999999999",
        "errors design.json --method newton --reference best",
        "fit design.json --rows 3 --bytes 9",
        "fit design.json --bytes 0",
        "play design.json --range 0 --target 0:5",
        "schedule design.json --spacing -1",
        "torque motor.json --speed -1",
        "simulate motor.json --points 0",
        "map motor.json --range 5",
        "map motor.json --range 9 --range 5",
        "map motor.json --cells 9",
        "move",
        "move --by 3 --to 4",
        "move --by 99999999999",
        "move --by 5 --no-wait --alone",
        "run --speed 5 --for 1 --axis 9",
        "home --fast 0 --slow 5",
        "home --fast 5 --slow 0 --back-off 0 --within 0",
        "designs list --most 0",
    ],
)
def test_a_refusal_names_nothing_but_what_a_command_takes(ask: Ask, words: str) -> None:
    told = ask(words)
    assert (told.code, told.out) == (2, "")
    for line in told.err.removeprefix("stepramp: ").splitlines():
        assert line.startswith("--"), line
        assert "null" not in line
        named = set(re.findall(r"[a-z]+_[a-z_]+", line))
        assert named <= set(METHODS), line


def test_a_push_needs_a_yes_where_nobody_can_be_asked(ask: Ask, device: str) -> None:
    del device
    told = ask("push other.json")
    assert told.code == 2
    assert "--yes is missing; allowed: --yes, since there is no terminal to ask at." in told.err


def test_a_push_tells_what_differs_and_what_was_read_back(ask: Ask, device: str) -> None:
    Path("slow.json").write_text(json.dumps(document(ramp__slew_speed_steps_per_s=500)))
    told = ask(f"push slow.json --try --yes {device}")
    assert told.code == 0, told.err
    assert "Slew interval" in told.err
    assert "read back as sent, on trial" in told.err
    assert "2,000" in told.out
    assert ask(f"push slow.json --try --yes {device}").err.count("nothing was sent") == 1
    assert ask(f"rollback {device}").code == 0
    refused = ask(f"rollback {device}")
    assert (refused.code, refused.err) == (
        1,
        "stepramp: Nothing is on trial: the stored ramps and settings are in use.\n",
    )


def test_a_move_says_what_it_is_about_to_do_and_where_it_ended(ask: Ask, device: str) -> None:
    before = json.loads(ask(f"status {device} --format json").out)["position_steps"]
    told = ask(f"move --by -30 --trace steps.csv {device} --format json")
    assert told.code == 0, told.err
    assert told.err == "stepramp: axis 0 of Virtual controller at sim:// moves by -30 steps; Ctrl+C stops it\n"
    assert json.loads(told.out)["position_steps"] == before - 30
    assert len(Path("steps.csv").read_text().splitlines()) == 31
    both = ask(f"move --by 3 --to 4 {device}")
    assert (both.code, "--to is 4; allowed: nothing, since " in both.err) == (2, True), both.err
    assert ask(f"move --by 400 --no-wait {device}").code == 0
    assert ask("stop").code == 0


def test_what_is_refused_is_not_told_to_move(ask: Ask, device: str) -> None:
    """The virtual controller has one axis with a ramp."""
    for words in ("move --by 10 --axis 3", "run --speed 400 --for 1 --axis 3", "home --fast=-400 --slow 50 --axis 3"):
        told = ask(f"{words} {device}")
        assert (told.code, "Ctrl+C stops it" in told.err) == (2, False), told.err


def test_another_family_is_pushed_to_and_restored(ask: Ask, grbl: str) -> None:
    device = f"--port {grbl} --family grbl"
    told = ask(f"push design.json {device} --yes")
    assert (told.code, "read back as sent" in told.err) == (0, True), told.err
    assert "warning: " in told.err
    both = ask("status")
    assert (both.code, "--device is missing; allowed: one of " in both.err) == (2, True), both.err
    saved = json.loads(ask(f"backups {device} --format json").out)["backups"][-1]["name"]
    restored = ask(f"restore {device} --backup '{saved}' --yes")
    assert restored.code == 0, restored.err
    assert ask(f"disconnect {device}").code == 0
    # With the machine away they are all there, and it takes them wherever it is plugged in next.
    every = json.loads(ask("backups --all --format json").out)["sources"]
    [source] = [one["name"] for one in every if saved in [each["name"] for each in one["backups"]]]
    assert f"{source},{saved}," in ask("backups --all --format csv").out
    restored = ask(f"restore {device} --backup '{saved}' --of {source} --yes")
    assert (restored.code, ask(f"disconnect {device}").code) == (0, 0), restored.err
    told = ask(f"restore {device} --of {source} --yes")
    assert (told.code, "--of is" in told.err) == (2, True), told.err


def test_a_watched_device_is_told_as_it_changes(ask: Ask, device: str) -> None:
    told = ask(f"status --watch --for 0.3 --format csv {device}")
    assert (told.code, told.out.splitlines()[0].split(",")[:3]) == (0, ["device", "axis", "state"])
    assert ask(f"status --watch --for 0.3 {device}").code == 0


def test_a_design_of_the_library_is_written_as_it_was_saved(ask: Ask) -> None:
    kept = json.loads(ask("designs save design.json --tag gauge --format json").out)["id"]
    assert ask(f"designs show {kept} --output again.json").code == 0
    assert Design.checked(json.loads(Path("again.json").read_text())) == design()
    assert ask(f"designs save motor.json --to {kept} --note quieter").code == 0
    differing = ask(f"designs diff {kept} 1 2").out
    assert "motor.rated_current_a" in differing or "motor" in differing
    assert ask("designs list --tag none").out.startswith("0 of 0 designs")


@unix_only
@pytest.mark.parametrize(
    ("words", "ending"), [("move --by 5000000", signal.SIGQUIT), ("run --speed 900 --for 3600", signal.SIGTERM)]
)
def test_a_motion_that_is_interrupted_is_stopped(ask: Ask, device: str, words: str, ending: signal.Signals) -> None:
    with begun(f"{words} {device}", stderr=subprocess.PIPE) as process:
        assert process.stderr is not None
        assert "Ctrl+C stops it" in process.stderr.readline()
        until_state(ask, device, "moving")
        process.send_signal(ending)
        assert re.search(
            r"stopping: sim://, axis 0 at .* and slows down|stopped: sim://, axis 0 ", process.stderr.read()
        )
    assert process.returncode == 130
    assert json.loads(ask(f"status {device} --format json").out)["state"] in ("stopping", "ready")


@unix_only
def test_a_run_that_was_paused_is_over(ask: Ask, device: str) -> None:
    with begun(f"run --speed 500 --for 60 {device}", stderr=subprocess.PIPE) as process:
        assert process.stderr is not None
        assert "Ctrl+C stops it" in process.stderr.readline()
        until_state(ask, device, "moving")
        process.send_signal(signal.SIGSTOP)
        until_state(ask, device, "ready")
        place = json.loads(ask(f"status {device} --format json").out)["position_steps"]
        process.send_signal(signal.SIGCONT)
        said = process.stderr.read()
        assert "The run was given up, since this program was silent for " in said
    assert process.returncode == 1
    assert json.loads(ask(f"status {device} --format json").out)["position_steps"] == place


@unix_only
def test_an_output_that_can_t_be_written_is_told_in_a_line(ask: Ask, device: str) -> None:
    before = json.loads(ask(f"status {device} --format json").out)["position_steps"]
    closed = "import os, sys; os.close(1); os.execv(sys.executable, [sys.executable, '-m', 'stepramp', *sys.argv[1:]])"
    words = [sys.executable, "-c", closed, *f"move --by 50 {device}".split()]
    path = str(Path(stepramp.__file__).parents[1])
    done = subprocess.run(words, check=False, env={**os.environ, "PYTHONPATH": path}, stderr=subprocess.PIPE, text=True)
    told = "stepramp: standard output is 'closed'; allowed: one that can be written.\n"
    assert (done.returncode, done.stderr) == (2, told)
    assert json.loads(ask(f"status {device} --format json").out)["position_steps"] == before
    with Path("/dev/full").open("w") as full:
        with begun("profile design.json --format csv", stdout=full.fileno(), stderr=subprocess.PIPE) as process:
            assert process.stderr is not None
            assert process.stderr.read() == ("stepramp: Standard output can't be written: No space left on device.\n")
        assert process.returncode == 1
        with begun("stop", stdout=full.fileno(), stderr=subprocess.PIPE) as process:
            assert process.stderr is not None
            assert process.stderr.read() == ""
        assert process.returncode == 0


@unix_only
def test_a_trace_that_can_t_be_written_does_not_undo_the_move(ask: Ask, device: str) -> None:
    before = json.loads(ask(f"status {device} --format json").out)["position_steps"]
    told = ask(f"move --by 20 --trace /dev/full {device} --format json")
    assert (told.code, json.loads(told.out)["position_steps"]) == (1, before + 20)
    assert "The move was made, its trace wasn't written: --trace is '/dev/full'; allowed: " in told.err


@unix_only
def test_a_move_that_another_came_after_says_so_and_keeps_its_trace(ask: Ask, device: str) -> None:
    with begun(f"move --by 200000 --trace first.csv {device}", stderr=subprocess.PIPE) as process:
        assert process.stderr is not None
        assert "Ctrl+C stops it" in process.stderr.readline()
        # It lasts for as long as it may take to begin the other one.
        until_state(ask, device, "moving")
        assert ask(f"move --to 0 {device}").code == 0
        assert "Another motion came after this move: the axis rests at " in process.stderr.read()
    assert process.returncode == 1
    assert Path("first.csv").exists()


def test_who_loses_the_server_is_told_at_once_what_to_do(capsys: pytest.CaptureFixture[str]) -> None:
    told: list[str] = []

    def stop(_: str) -> None:
        told.append(capsys.readouterr().err)
        raise NoServer("No server answers at http://a.")

    where: Any = SimpleNamespace(client=SimpleNamespace(stop=stop))
    there: Any = SimpleNamespace(id="1", port="/dev/tty A", family="grbl")
    with pytest.raises(NoServer), stopping(where, there):
        raise NoServer("The server at http://a has not answered, or not to the end.")
    assert "The motor may still move: the stop is asked for" in told[0]
    assert "stepramp stop --port '/dev/tty A' --family grbl" in told[0]
    assert "THE STOP WAS NOT CONFIRMED" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("is_granted", "error", "stopped"),
    [
        (False, TooOften("Too often."), []),
        (True, TooOften("Too often."), ["1"]),
        (True, Unauthorized("The token is unknown."), ["1"]),
        (True, Refused("Another motion came."), []),
    ],
)
def test_what_was_granted_is_stopped_whatever_error_comes_and_what_was_refused_is_not(
    capsys: pytest.CaptureFixture[str], is_granted: bool, error: Exception, stopped: list[str]
) -> None:
    asked: list[str] = []

    def stop(device: str) -> SimpleNamespace:
        asked.append(device)
        axes = [SimpleNamespace(axis=0, position_steps=7, position_told=True)]
        return SimpleNamespace(axes=axes, state="moving")

    def fail(motion: Motion) -> None:
        motion.is_granted = is_granted
        raise error

    where: Any = SimpleNamespace(client=SimpleNamespace(stop=stop))
    there: Any = SimpleNamespace(id="1", port="sim://", family="stepramp")
    with pytest.raises(type(error)), stopping(where, there) as motion:
        fail(motion)
    assert asked == stopped
    assert ("stopping: sim://, axis 0 at 7 steps, and slows down" in capsys.readouterr().err) == bool(stopped)


def test_a_move_is_waited_for_though_the_server_is_asked_too_much(
    ask: Ask, device: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    usual, refusals = Client.send, iter([TooOften("Too often."), Overloaded("Too much.")])

    def send(client: Client, call: Call[Any]) -> Any:
        refusal = next(refusals, None) if is_begun and call.method == "GET" else None
        if refusal is not None:
            raise refusal
        is_begun.extend([call] if call.path.endswith("/move") else [])
        return usual(client, call)

    is_begun: list[Call[Any]] = []
    monkeypatch.setattr(Client, "send", send)
    before = json.loads(ask(f"status {device} --format json").out)["position_steps"]
    told = ask(f"move --by 20 --trace steps.csv {device} --format json")
    assert (told.code, next(refusals, None)) == (0, None), told.err
    assert json.loads(told.out)["position_steps"] == before + 20


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ("run --speed 0 --for 1", "--speed is 0.0; allowed: a number of steps/s, but not 0."),
        ("run --speed 1e9 --for 1", "--speed is 1000000000.0; allowed: a number from -1,000,000"),
        ("status --watch --for -1", "--for is -1.0; allowed: a number from 0 to 86,400 s."),
    ],
)
def test_what_can_be_known_is_refused_before_a_port_is_opened(ask: Ask, words: str, told: str) -> None:
    came_to = ask(f"{words} --port /dev/absent")
    assert (came_to.code, came_to.out) == (2, "")
    assert told in came_to.err


@unix_only
def test_who_reads_may_have_read_enough() -> None:
    with begun("profile design.json --format csv", stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        assert process.stdout is not None
        assert process.stderr is not None
        process.stdout.close()
        assert process.stderr.read() == ""
    assert process.returncode == 0


def test_the_shell_completes_commands_and_choices(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("_STEPRAMP_COMPLETE", "complete_bash")
    for words, number, completed in (
        ("stepramp pus", "1", "push"),
        ("stepramp fit --kind l", "3", "linear"),
        ("stepramp serve --log-level w", "3", "warning"),
        ("stepramp errors --method ne", "3", "newton"),
        ("stepramp export c_n", "2", "c_newton"),
        ("stepramp export --axis-letter Y", "3", "Y"),
        ("stepramp map --cells 1", "3", "16 128"),
        ("stepramp status --family kl", "3", "klipper"),
    ):
        monkeypatch.setenv("COMP_WORDS", words)
        monkeypatch.setenv("COMP_CWORD", number)
        with pytest.raises(SystemExit):
            main([])
        assert capsys.readouterr().out.split() == completed.split()
    monkeypatch.delenv("COMP_WORDS")
    assert main([]) == 2
    assert (
        capsys.readouterr().err
        == "stepramp: COMP_WORDS is missing; allowed: what bash sets while it completes a word.\n"
    )


@unix_only
@pytest.mark.parametrize(("answer", "code", "last"), [("n", 1, "nothing was sent"), ("y", 0, "read back as sent")])
def test_at_a_terminal_a_push_is_asked_about(device: str, answer: str, code: int, last: str) -> None:
    Path("asked.json").write_text(json.dumps(document(ramp__slew_speed_steps_per_s=700 if answer == "y" else 600)))
    ours, theirs = os.openpty()
    with begun(f"push asked.json {device}", stdin=theirs, stdout=subprocess.DEVNULL, stderr=theirs) as process:
        os.close(theirs)
        said = ""
        while "[y/N]" not in said:
            said += os.read(ours, 4096).decode()
        assert "Slew interval" in said
        os.write(ours, f"{answer}\n".encode())
        said = ""
        while True:
            try:
                said += os.read(ours, 4096).decode()
            except OSError:  # It has ended.
                break
    os.close(ours)
    assert (process.returncode, last in said) == (code, True), said


def test_folders_of_backups_that_cant_be_listed_are_told_besides(capsys: pytest.CaptureFixture[str]) -> None:
    found = BackupsAnswer(backups=[BackupAnswer(name="2026-01-01", bytes=7)], unreadable=["One can't be listed."])
    where = SimpleNamespace(client=SimpleNamespace(backups=lambda _: found))
    backups(where, lambda: SimpleNamespace(id="1"))  # type: ignore[arg-type, return-value]
    told = capsys.readouterr()
    assert "2026-01-01" in told.out
    assert told.err == "stepramp: warning: One can't be listed.\n"
