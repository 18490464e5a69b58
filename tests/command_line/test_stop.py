"""`stepramp stop`, which works while all else hangs."""

from __future__ import annotations

import json
import subprocess
import sys

import pytest

from client.test_urgent import HalfDeaf, half_deaf  # noqa: F401  # a fixture
from command_line.conftest import Ask
from controllers.grbl.emulator import GrblEmulator, GrblOnACable
from stepramp.command_line.main import main
from stepramp.command_line.server_commands import add_stop
from stepramp.command_line.stop import HALT, WITH_VALUE, Asked, asked_by, places_of
from waiting import until

SLOW = {
    "numpy",
    "numba",
    "pydantic",
    "httpx2",
    "typer",
    "rich",
    "fastapi",
    "asyncio",
    "serial",
    "platformdirs",
}


@pytest.mark.parametrize(
    ("words", "asked"),
    [
        ("", Asked()),
        ("--device 2 --axis 1 --axis=0", Asked("2", [1, 0])),
        ("--halt --server http://a", Asked(halt=True, server="http://a")),
        ("--port /dev/ttyACM0 --family grbl", Asked(port="/dev/ttyACM0", family="grbl")),
        ("--device 2 now", Asked(not_understood=["now"])),
        ("--device 2 --axis 9", Asked(not_understood=["--axis 9"])),
        ("--axis 1", Asked(not_understood=["--axis without --device"])),
        ("--device=", Asked(not_understood=["--device without a value"])),
        ("--device", Asked(not_understood=["--device"])),
    ],
)
def test_what_is_not_understood_stops_all(words: str, asked: Asked) -> None:
    assert asked_by(words.split()) == asked


def test_the_help_has_the_options_that_are_understood() -> None:
    import typer

    app = typer.Typer()
    add_stop(app)
    options = {name for each in typer.main.get_command(app).params for name in each.opts}
    assert options - {"--help", "--install-completion", "--show-completion"} == {*WITH_VALUE, HALT}


def test_it_is_asked_again_until_it_is_answered(half_deaf: HalfDeaf, ask: Ask) -> None:  # noqa: F811
    told = ask(f"stop --server {half_deaf.url}")
    assert (told.code, told.out) == (0, f"Stopped: the server at {half_deaf.url}, which has no device.\n")
    assert len(half_deaf.asked) == 3
    told = ask(f"stop --server {half_deaf.url} --devise 1")
    assert told.code == 2
    assert told.err.startswith("stepramp: --devise, 1 was not understood; allowed: --device, --axis, ")


def test_it_loads_nothing_that_takes_long(half_deaf: HalfDeaf) -> None:  # noqa: F811
    code = (
        "import sys; from stepramp.command_line.main import main\n"
        f"assert main(['stop', '--server', {half_deaf.url!r}]) == 0\n"
        f"print(sorted({SLOW} & set(sys.modules)))"
    )
    ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert ran.stdout.splitlines()[-1] == "[]"


@pytest.mark.parametrize(
    ("axes", "words"),
    [
        ([(0, 1200)], ", axis 0 at 1,200 steps"),
        ([(0, 1200), (1, 0)], ", axis 0 at 1,200, axis 1 at 0 steps"),
        ([(0, None), (1, -5)], ", axis 1 at -5 steps, axis 0 tells no position"),
        ([(0, None)], ", axis 0 tells no position"),
        ([], ""),
    ],
)
def test_no_place_is_made_up(axes: list[tuple[int, int | None]], words: str) -> None:
    """As of a Klipper that isn't homed, whose positions say nothing."""
    assert places_of(axes) == words


def test_a_server_tells_which_axes_tell_no_position(half_deaf: HalfDeaf, ask: Ask) -> None:  # noqa: F811
    half_deaf.devices = [
        {
            "id": "7",
            "port": "moonraker://printer",
            "state": "ready",
            "axes": [
                {"axis": 0, "position_steps": 0, "position_told": False},
                # A server of an older version doesn't say so.
                {"axis": 1, "position_steps": 40},
            ],
        }
    ]
    places = "axis 1 at 40 steps, axis 0 tells no position"
    assert ask(f"stop --server {half_deaf.url}").out == f"Stopped: device 7 at moonraker://printer, ready, {places}.\n"


def test_of_all_those_that_refuse_are_told(half_deaf: HalfDeaf, ask: Ask) -> None:  # noqa: F811
    """As a Klipper that prints."""
    axes = [{"axis": 0, "position_steps": 40, "position_told": True}]
    half_deaf.devices = [{"id": "7", "port": "moonraker://printer", "state": "moving", "axes": axes}]
    half_deaf.errors = [{"message": "Somebody prints."}]
    told = ask(f"stop --server {half_deaf.url}")
    assert (told.code, told.err) == (1, "stepramp: Somebody prints.\n")
    assert told.out == "Asked to stop: device 7 at moonraker://printer, moving, axis 0 at 40 steps.\n"


@pytest.mark.usefixtures("alone")
@pytest.mark.skipif(sys.platform == "win32", reason="pseudo-terminals of Unix")
def test_at_a_port_no_place_is_made_up(ask: Ask) -> None:
    grbl = GrblEmulator()
    grbl.eeprom.settings[100] = 0.0
    grbl.power_up()
    with GrblOnACable(grbl) as cable:
        told = ask(f"stop --port {cable.port} --family grbl")
        assert (told.code, told.out) == (0, f"Stopped: {cable.port}, axis 0 tells no position.\n"), told.err


@pytest.mark.usefixtures("alone")
def test_without_a_server_it_says_so(ask: Ask) -> None:
    told = ask("stop")
    assert (told.code, told.out) == (3, "")
    assert "No server of this machine runs." in told.err
    wrong = ask("stop --server nowhere")
    assert wrong.code == 3
    refused = ask("stop --server http://127.0.0.1:1")
    assert (refused.code, refused.err) == (3, "stepramp: No server answers at http://127.0.0.1:1.\n")


@pytest.mark.usefixtures("server", "folder")
def test_it_stops_and_halts_one_device_or_all(ask: Ask) -> None:
    for words in ("", "--halt", "--device {id} --axis 0"):
        assert ask("push design.json --port sim:// --yes").code == 0
        assert ask("move --port sim:// --by 1000000 --no-wait").code == 0
        [device] = json.loads(ask("devices --format json").out)["devices"]
        told = ask(f"stop {words.format(id=device['id'])}")
        assert (told.code, told.err, told.out.startswith("Stopped: device ")) == (0, "", True), told
        until(lambda: json.loads(ask("devices --format json").out)["devices"][0]["state"] == "ready")
    assert ask("stop --device 99").code == 1


def test_main_is_what_the_program_begins_with() -> None:
    assert main(["stop", "--help"]) == 0
