"""Finding a Marlin at a port: one that starts anew on opening, one that doesn't, and what is none."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from controllers.bench import by
from controllers.marlin.bench import QUESTIONS, Bench
from controllers.marlin.emulator import MarlinEmulator
from stepramp.controllers.contract import Activity
from stepramp.controllers.marlin import conversation
from stepramp.controllers.marlin.controller import MarlinController
from stepramp.errors import DeviceLost, Refused
from stepramp.link import lines


def connected(bench: Bench) -> MarlinController:
    bench.controller.connect()
    return bench.controller


def test_it_is_only_asked(bench: Bench) -> None:
    controller = connected(bench)
    assert set(bench.marlin.lines) <= QUESTIONS
    assert (bench.marlin.eeprom.writes, bench.marlin.steps, bench.marlin.resends) == (0, 0, 0)
    assert (controller.firmware_version, controller.most_axes) == ("2.1.2.5", 4)
    assert (controller.clocks_hz, controller.timer_hz) == ((), None)
    status = controller.status()
    assert (status.activity, status.trouble, status.on_trial) == (Activity.READY, None, False)
    assert [axis.steps_per_mm for axis in status.axes] == [80, 80, 400, 93]


def test_one_that_does_not_start_on_opening_is_found_where_it_is(bench: Bench) -> None:
    bench.marlin.starts_on_open = False
    bench.marlin.exchange(b"")
    bench.marlin.move_as_somebody_else(X=500, Z=-250, E=93)
    bench.pass_time(5)
    assert [axis.position_steps for axis in connected(bench).status().axes] == [500, 0, -250, 93]


def test_a_number_of_lines_that_somebody_else_has_sent_is_no_trouble(bench: Bench) -> None:
    bench.marlin.starts_on_open = False
    bench.marlin.exchange(b"N1 M114*36\nN2 M1")
    bench.pass_time(0.1)
    assert connected(bench).status().activity is Activity.READY


@pytest.mark.parametrize(("boot_s", "shows_s"), [(0.3, 0.0), (1.6, 0.0), (2.8, 0.0), (2.8, 4.0)])
def test_a_board_takes_its_time_for_its_boot_loader_and_its_picture(
    bench: Bench, boot_s: float, shows_s: float
) -> None:
    bench.marlin.boot_s, bench.marlin.shows_s = boot_s, shows_s
    bench.marlin.opened()
    assert connected(bench).status().activity is Activity.READY


def test_echoes_halves_and_temperatures_are_understood(bench: Bench) -> None:
    bench.marlin.echoes = bench.marlin.chats = True
    rest = bytearray()

    def in_pieces(said: bytes) -> bytes:
        rest.extend(said)
        piece = bytes(rest[:7])
        del rest[:7]
        return piece

    bench.marlin.on_the_way_out = in_pieces
    exchange = bench.marlin.exchange
    bench.marlin.exchange = lambda sent: exchange(sent) or in_pieces(b"")  # type: ignore[method-assign]
    bench.lasts_s = 0.001
    controller = connected(bench)
    bench.pass_time(3)
    assert [axis.steps_per_mm for axis in controller.status().axes] == [80, 80, 400, 93]


@pytest.mark.parametrize("firmware", ["Marlin 1.1.9 (Github)", "Marlin V1; Sprinter/grbl mashup for gen6", "Marlin"])
def test_older_ones_are_known(bench: Bench, firmware: str) -> None:
    bench.marlin.firmware = firmware
    assert connected(bench).firmware_version in ("1.1.9", None)


@pytest.mark.parametrize(
    "firmware", ["Prusa-Firmware 3.13.2 based on Marlin", "Smoothieware", "RepRapFirmware for Duet 2", "Klipper"]
)
def test_other_firmwares_are_refused_by_name(bench: Bench, firmware: str) -> None:
    bench.marlin.firmware = firmware
    with pytest.raises(Refused, match=f"is no Marlin but '{firmware}'"):
        bench.controller.connect()
    assert bench.marlin.steps == 0


def test_motors_that_are_no_axes_are_refused(bench: Bench) -> None:
    bench.marlin.on_the_way_out = lambda said: said.replace(b"Count X:0 Y:0", b"Count A:0 B:0")
    with pytest.raises(Refused, match="motors of a delta or a CoreXY move several axes"):
        bench.controller.connect()


def test_inches_are_refused(bench: Bench) -> None:
    bench.marlin.on_the_way_out = lambda said: said.replace(b"G21 ; (mm)", b"G20 ; (in)")
    with pytest.raises(Refused, match="counts in inches"):
        bench.controller.connect()


def test_one_that_moves_is_connected_and_can_be_stopped(bench: Bench) -> None:
    bench.marlin.starts_on_open = False
    bench.marlin.move_as_somebody_else(X=80_000)
    bench.pass_time(1)
    controller = connected(bench)
    with pytest.raises(Refused, match="Something moves that was not asked for here"):
        controller.set_position([])
    assert controller.status().activity is Activity.MOVING
    controller.stop()
    assert (controller.status().activity, bench.marlin.is_moving) == (Activity.READY, False)


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


MARLIN = b"FIRMWARE_NAME:Marlin 2.1.2 SOURCE_CODE_URL:x\n"


@pytest.mark.parametrize(
    ("says", "error", "words"),
    [
        (b"", DeviceLost, "Nothing answers .* as Marlin does"),
        (b"\x00\xff\xa5nonsense", Refused, "Something talks .* but it is no Marlin"),
        (b"ok\n", Refused, "Something talks .* but it is no Marlin"),
        (b"start\necho:busy: processing\n", Refused, "says that it is busy, as a Marlin does while it heats"),
        (b"\r\nGrbl 1.1h ['$' for help]\r\n", Refused, "Something talks .* but it is no Marlin"),
        (MARLIN, DeviceLost, "does not answer"),
        (MARLIN + b"ok\n", DeviceLost, "does not answer"),
        (MARLIN + b"echo:busy: processing\n", Refused, "says that it is busy, as a Marlin does while it heats"),
        (b"Marlin 2.1.2\r\n", Refused, "Something talks .* but it is no Marlin"),
        (b"start\r\nMarlin 2.1.2\r\n" * 20, Refused, "Something talks .* but it is no Marlin"),
        (MARLIN + b"Resend: 1\nok\n", DeviceLost, "does not answer"),
        (MARLIN + b"start\n", DeviceLost, "started anew again while .* keeps restarting: look at its power supply"),
    ],
)
def test_what_is_no_marlin_ends_in_words_within_5_s(
    monkeypatch: pytest.MonkeyPatch, says: bytes, error: type[Exception], words: str
) -> None:
    """By the clock of what is there."""
    talker = Talker(says)
    for module in (conversation, lines):
        monkeypatch.setattr(module, "monotonic", lambda: talker.now_s)
    with pytest.raises(error, match=words):
        MarlinController(talker).connect()
    assert talker.now_s < 5


@pytest.mark.parametrize("after", [b"", b"FIRMWARE_NAME", b"Count X", b"M92"])
def test_one_that_is_busy_without_end_is_refused_within_5_s(bench: Bench, after: bytes) -> None:
    """Whichever of its questions it answers no more; it says so every 2 s."""

    def busy_from_then_on(said: bytes) -> bytes:
        if after in said:
            bench.marlin.heats_until_s = 1e6
        return said

    bench.marlin.on_the_way_out = busy_from_then_on
    began_s = bench.clock.now_s
    with pytest.raises(Refused, match="says that it is busy, as a Marlin does while it heats: connect it once that is"):
        bench.controller.connect()
    assert bench.clock.now_s - began_s < 5
    # One that is connected is waited for as long as it takes.
    bench.marlin.heats_until_s = 0.0
    bench.marlin.on_the_way_out = lambda said: said
    bench.port.close()
    bench.reopen()
    bench.controller.connect()
    bench.marlin.heats_until_s = bench.clock.now_s + 30
    bench.controller._memory.learn()
    assert bench.clock.now_s > bench.marlin.heats_until_s


def test_a_restart_in_between_is_noticed(bench: Bench, controller: MarlinController) -> None:
    bench.marlin.power_up()
    bench.pass_time(0.1)
    with pytest.raises(DeviceLost, match="was restarted: its position is no longer known"):
        controller.status()


def test_one_that_has_halted_is_told_so(bench: Bench, controller: MarlinController) -> None:
    bench.marlin.exchange(b"M112\n")
    with pytest.raises(DeviceLost, match="has halted: reset it at the machine"):
        controller.status()


def test_one_that_says_no_more_is_lost(controller: MarlinController, marlin: MarlinEmulator) -> None:
    marlin.is_on = False
    with pytest.raises(DeviceLost, match="does not answer"):
        controller.status()


# Lines that arrive damaged, or not at all.


def damaged(nth: int, how: Callable[[bytes], bytes]) -> Callable[[bytes], bytes]:
    """Return what does something to the n-th of what is sent, and to each seventh after it."""
    sent = 0

    def change(data: bytes) -> bytes:
        nonlocal sent
        sent += 1
        return how(data) if sent >= nth and (sent - nth) % 7 == 0 else data

    return change


@pytest.mark.parametrize("says_ok", [True, False])
@pytest.mark.parametrize("nth", range(1, 8))
@pytest.mark.parametrize(
    "how",
    [
        lambda data: data[:2] + b"#" + data[3:],
        lambda data: data[: len(data) // 2],
        lambda data: data[:-1],
        lambda _: b"",
        lambda data: data + data,
    ],
    ids=["a byte is another", "only half of it", "no end of line", "nothing", "twice"],
)
def test_no_way_is_gone_twice_or_left_out_on_a_bad_line(
    bench: Bench, controller: MarlinController, nth: int, how: Callable[[bytes], bytes], says_ok: bool
) -> None:
    bench.marlin.says_ok_after_resend = says_ok
    bench.marlin.on_the_way_in = damaged(nth, how)
    for steps in (160, -80, 240):
        controller.move_by([*by(steps), *by(steps // 2, 1)])
        bench.rest()
    bench.marlin.on_the_way_in = lambda data: data
    assert bench.marlin.position[:2] == [320, 160]
    assert [axis.position_steps for axis in controller.status().axes][:2] == [320, 160]


@pytest.mark.parametrize("nth", range(1, 8))
def test_no_way_is_gone_twice_though_answers_are_lost(bench: Bench, controller: MarlinController, nth: int) -> None:
    for steps in (160, -80, 240):
        bench.marlin.on_the_way_out = damaged(nth, lambda _: b"")
        controller.move_by(by(steps))
        bench.marlin.on_the_way_out = lambda data: data
        bench.rest()
    assert bench.marlin.position[0] == controller.status().axes[0].position_steps == 320
    assert sum(line.startswith("G1") for line in bench.marlin.lines) == 3


@pytest.mark.parametrize("nth", range(1, 12))
def test_three_lines_without_an_end_are_not_taken_for_one(bench: Bench, controller: MarlinController, nth: int) -> None:
    """The exclusive or of three times the same is that of one."""
    sent = 0

    def without_ends(data: bytes) -> bytes:
        nonlocal sent
        sent += 1
        return data[:-1] if nth <= sent < nth + 3 else data

    bench.marlin.on_the_way_in = without_ends
    controller.move_by(by(800))
    assert bench.rest().axes[0].position_steps == bench.marlin.position[0] == 800
    assert not any("*" in line for line in bench.marlin.lines)
