"""Finding a grbl at a port: one that starts anew on opening, one that doesn't, and what is none."""

from __future__ import annotations

import pytest

from controllers.grbl.bench import Bench, to
from controllers.grbl.emulator import GrblEmulator
from designs import design
from stepramp.controllers.contract import Activity
from stepramp.controllers.grbl import conversation
from stepramp.controllers.grbl.controller import GrblController
from stepramp.errors import DeviceLost, Refused
from stepramp.link import lines

KEEPS_RESTARTING = "started anew again while it was being connected.* keeps restarting: look at its power supply"
QUESTIONS = {"$$", "$N", "$I"}


def connected(bench: Bench) -> GrblController:
    bench.controller.connect()
    return bench.controller


def test_it_is_only_asked(bench: Bench) -> None:
    controller = connected(bench)
    assert set(bench.grbl.lines) == QUESTIONS
    assert (bench.grbl.eeprom.writes, bench.grbl.steps) == (0, 0)
    assert (controller.firmware_version, controller.most_axes) == ("1.1h", 3)
    assert (controller.clocks_hz, controller.timer_hz) == ((), None)
    status = controller.status()
    assert (status.activity, status.trouble, status.on_trial) == (Activity.READY, None, False)
    assert [axis.steps_per_mm for axis in status.axes] == [250, 250, 250]


def test_one_that_does_not_start_on_opening_is_found_where_it_is(bench: Bench) -> None:
    bench.grbl.starts_on_open = False
    bench.grbl.exchange(b"")
    bench.grbl.position, bench.grbl._mm = [500, 0, -250], [2.0, 0.0, -1.0]
    assert [axis.position_steps for axis in connected(bench).status().axes] == [500, 0, -250]


def test_the_beginning_of_a_line_that_is_left_there_is_not_carried_out(bench: Bench) -> None:
    bench.grbl.starts_on_open = False
    bench.grbl.exchange(b"$J=G53G21G90X50F10")
    connected(bench)
    bench.pass_time(3)
    assert bench.grbl.steps == 0


@pytest.mark.parametrize("setting", [(13, 1.0), (10, 0.0)])
def test_inches_and_workpieces_are_understood(bench: Bench, setting: tuple[int, float]) -> None:
    number, value = setting
    bench.grbl.starts_on_open = False
    bench.grbl.settings[number] = value
    bench.grbl.eeprom.offsets[1] = (3.0, -4.0, 0.5)
    bench.grbl.position, bench.grbl._mm = [254, 1000, 0], [1.016, 4.0, 0.0]
    assert [axis.position_steps for axis in connected(bench).status().axes] == [254, 1000, 0]


def test_echoes_and_halves_are_understood(bench: Bench) -> None:
    bench.grbl.echoes = True
    rest = bytearray()

    def in_pieces(said: bytes) -> bytes:
        rest.extend(said)
        piece = bytes(rest[:7])
        del rest[:7]
        return piece

    bench.grbl.on_the_way_out = in_pieces
    exchange = bench.grbl.exchange
    bench.grbl.exchange = lambda sent: exchange(sent) or in_pieces(b"")  # type: ignore[method-assign]
    controller = connected(bench)
    assert [axis.steps_per_mm for axis in controller.status().axes] == [250, 250, 250]


def test_one_that_is_homed_first_is_found_and_says_so(bench: Bench) -> None:
    bench.grbl.eeprom.settings[22] = 1.0
    bench.grbl.power_up()
    trouble = connected(bench).status().trouble
    assert trouble is not None
    assert "it is locked since it was started" in trouble


def test_grblhal_is_known_by_what_it_says(bench: Bench) -> None:
    bench.grbl.banner = "GrblHAL 1.1f ['$' or '$HELP' for help]"
    bench.grbl.version = ["[VER:1.1f.20231210:]", "[OPT:VNMGPHSL,35,1024,3,0]", "[FIRMWARE:grblHAL]"]
    assert connected(bench).firmware_version == "1.1f"


@pytest.mark.parametrize(
    ("code", "words"),
    [
        (11, "it has to be homed first (ALARM:11)"),
        (10, "its emergency stop is pressed (ALARM:10)"),
        (14, "ALARM:14"),
        (1, "a limit switch was hit, so its position may be lost (ALARM:1)"),
        (2, "a way would have led beyond its soft limits (ALARM:2)"),
    ],
)
def test_which_alarm_a_grblhal_is_in_is_known_though_it_was_connected_later(
    bench: Bench, code: int, words: str
) -> None:
    bench.grbl.starts_on_open = False
    bench.grbl.exchange(b"")
    bench.grbl.state, bench.grbl.alarm_told = "Alarm", code
    controller = connected(bench)
    assert words in (controller.status().trouble or "")
    bench.grbl.lines.clear()
    if code in (1, 2):
        with pytest.raises(Refused, match="Reset it at the machine"):
            controller.set_position([to(0)])
        with pytest.raises(Refused, match="in alarm since a limit was hit"):
            controller.prepare_push([design()], 0)()
        assert bench.grbl.lines == []
        return
    controller.set_position([to(0)])
    assert controller.status().trouble is None


@pytest.mark.parametrize(
    ("banner", "version", "words"),
    [
        ("Grbl 3.7 [FluidNC v3.7.8 (wifi) '$' for help]", "3.7.FluidNC v3.7.8", "FluidNC is at"),
        ("Grbl 0.9j ['$' for help]", "0.9j.20160303", "no grbl 1.1 but 0.9j"),
        ("Grbl 1.1h ['$' for help]", "2.0.20990101", "no grbl 1.1 but 2.0"),
    ],
)
def test_other_firmwares_are_refused(bench: Bench, banner: str, version: str, words: str) -> None:
    bench.grbl.banner, bench.grbl.version = banner, [f"[VER:{version}:]"]
    bench.grbl.opened()
    with pytest.raises(Refused, match=words):
        bench.controller.connect()
    assert bench.grbl.steps == 0


def test_one_that_moves_is_refused_once_it_could_be_stopped(bench: Bench) -> None:
    bench.grbl.starts_on_open = False
    bench.grbl.run_program("G1 X100 F300")
    bench.pass_time(1)
    greeted: list[bool] = []
    with pytest.raises(Refused, match="its state is 'Run'"):
        bench.controller.connect(lambda: greeted.append(True))
    assert greeted == [True]


class Talker:
    """Says something for ever, or never anything; its clock goes on while it is listened to [s]."""

    def __init__(self, says: bytes) -> None:
        self.name = "a talker"
        self.now_s = 0.0
        self._says = says

    def write(self, data: bytes) -> None:
        pass

    def read(self, timeout_s: float) -> bytes:
        self.now_s += min(timeout_s, 0.001) if self._says else timeout_s
        return self._says

    def pending(self) -> bytes:
        return self._says

    def close(self) -> None:
        pass


@pytest.mark.parametrize(
    ("says", "error", "words"),
    [
        (b"", DeviceLost, "Nothing answers .* as grbl does"),
        (b"\x00\xff\xa5nonsense", Refused, "Something talks .* but it is no grbl"),
        (b"start\necho:Marlin 2.1\n", Refused, "Something talks .* but it is no grbl"),
        (b"<Idle|MPos:0.000,0.000,0.000|FS:0,0>\r\n", DeviceLost, "does not answer"),
        (b"<Idle|MPos:0.000,0.000,0.000|FS:0,0>\r\nok\r\n", Refused, "of a version that it does not tell"),
        (b"Grbl 1.1h ['$' for help]\r\n", DeviceLost, KEEPS_RESTARTING),
        (b"Grbl 1.1h ['$' for help]\r\n<Idle|MPos:0.000,0.000,0.000|FS:0,0>\r\nok\r\n", DeviceLost, KEEPS_RESTARTING),
        (b"error:8\r\n<Idle|MPos:0,0,0|FS:0,0>\n", Refused, "refuses '[$]I'"),
    ],
)
def test_what_is_no_grbl_ends_in_words_within_5_s(
    monkeypatch: pytest.MonkeyPatch, says: bytes, error: type[Exception], words: str
) -> None:
    """By the clock of what is there."""
    talker = Talker(says)
    for module in (conversation, lines):
        monkeypatch.setattr(module, "monotonic", lambda: talker.now_s)
    with pytest.raises(error, match=words):
        GrblController(talker).connect()
    assert talker.now_s < 5


def test_a_board_whose_boot_loader_takes_its_time(bench: Bench) -> None:
    bench.lasts_s = 0.05
    bench.grbl.boot_s = 1.6
    bench.grbl.opened()
    assert connected(bench).status().activity is Activity.READY


def test_a_restart_in_between_is_noticed(bench: Bench, controller: GrblController) -> None:
    bench.grbl.power_up()
    with pytest.raises(DeviceLost, match="was restarted: its position is no longer known"):
        controller.status()


@pytest.mark.parametrize("question", [b"?", b"$I", b"$$", b"$N"])
def test_one_that_restarts_while_it_is_connected_is_told_what_to_look_at(bench: Bench, question: bytes) -> None:
    exchange, heard = bench.grbl.exchange, bytearray()

    def restart(sent: bytes) -> bytes:
        if b"?" in heard and question in sent:
            bench.grbl.power_up()
        heard.extend(sent)
        return exchange(sent)

    bench.grbl.exchange = restart  # type: ignore[method-assign]
    with pytest.raises(DeviceLost, match=KEEPS_RESTARTING):
        bench.controller.connect()
    bench.grbl.exchange = exchange  # type: ignore[method-assign]
    bench.port.close()
    bench.reopen()
    assert connected(bench).status().activity is Activity.READY


def test_one_that_says_no_more_is_lost(bench: Bench, controller: GrblController, grbl: GrblEmulator) -> None:
    grbl.is_on = False
    with pytest.raises(DeviceLost, match="does not answer"):
        controller.status()
    assert bench.grbl.steps == 0
