"""A stop is final: what Klipper has by then is played to its end, at rest, and nothing is added to it any more."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress

import pytest

from controllers.conftest import Clock
from controllers.klipper.bench import SLOW, Bench, at, by, to
from designs import design
from stepramp.controllers.contract import Activity, AnswerUnknown
from stepramp.controllers.klipper import controller as klipper
from stepramp.controllers.klipper.controller import KlipperController
from stepramp.errors import DeviceLost, Refused

SPEED_MM_S, ACCELERATION_MM_S2 = 20.0, 100.0
AHEAD_S = 2.0
"""What is told ahead at most, by decision; what Klipper tells of its place is up to 0.25 s old, and it is asked 0.1 s
later still."""
MOTIONS: dict[str, Callable[[KlipperController], None]] = {
    "by": lambda it: it.move_by([by(8000)]),
    "to": lambda it: it.move_to([to(0), to(0, 1)]),
    "run": lambda it: it.run([at(-1600.0)]),
    "line": lambda it: it.line([by(4000), by(4000, 1), by(400, 2)]),
}


def slow(bench: Bench) -> KlipperController:
    controller = bench.connected()
    bench.printer.velocity, bench.printer.accel, bench.printer.cruise = SPEED_MM_S, ACCELERATION_MM_S2, 0.0
    controller.status()
    return controller


@pytest.mark.parametrize("motion", ["by", "to", "run"])
def test_a_stop_is_rest_after_what_was_told(bench: Bench, motion: str) -> None:
    controller = slow(bench)
    MOTIONS[motion](controller)
    bench.ask_for(1.5)
    controller.stop()
    told, place = len(bench.printer.scripts), list(bench.printer.position)
    status = controller.status()
    assert status.axes[0].activity is Activity.STOPPING
    target = status.axes[0].target_steps
    began_s = bench.clock.now_s
    rest = bench.rest()
    assert rest.axes[0].position_steps == target
    assert bench.clock.now_s - began_s < AHEAD_S + 1.0
    assert len(bench.printer.scripts) == told
    longest = SPEED_MM_S * (AHEAD_S + 0.35) + SPEED_MM_S**2 / (2 * ACCELERATION_MM_S2)
    gone = sum((end - at) ** 2 for end, at in zip(bench.printer.position, place, strict=True)) ** 0.5
    assert 0 < gone <= longest + 1
    assert gone * 80 <= controller.steps_to_rest(0, 1600) + 0.35 * 1600


def test_a_halt_is_the_emergency_stop(bench: Bench) -> None:
    controller = slow(bench)
    MOTIONS["by"](controller)
    bench.ask_for(1.5)
    controller.halt()
    place = list(bench.printer.position)
    assert bench.printer.state == "shutdown"
    status = bench.ask_for(2.0)
    assert bench.printer.position == place
    assert status.activity is Activity.READY
    assert status.trouble is not None
    assert "FIRMWARE_RESTART" in status.trouble
    with pytest.raises(Refused, match="FIRMWARE_RESTART"):
        controller.move_by([by(8)])


def test_a_halt_at_rest_shuts_nothing_down(bench: Bench, controller: KlipperController) -> None:
    controller.halt()
    assert "printer.emergency_stop" not in bench.moonraker.methods
    assert bench.printer.state == "ready"


def test_what_waits_its_turn_is_dropped_by_a_stop(bench: Bench) -> None:
    controller = slow(bench)
    bench.printer.is_held_up = True
    errors: list[Exception] = []

    def stop() -> None:
        bench.interrupt = lambda: None
        controller.stop()
        bench.hear(bench.moonraker.let_go())

    bench.interrupt = stop
    try:
        MOTIONS["by"](controller)
    except (AnswerUnknown, Refused) as error:
        errors.append(error)
    assert errors
    assert bench.printer.state == "shutdown"
    assert bench.printer.scripts == []
    assert bench.printer.position == [100, 100, 100]


def test_what_somebody_else_prints_is_only_halted(bench: Bench, controller: KlipperController) -> None:
    bench.printer.prints = "printing"
    with pytest.raises(Refused, match=r"told to Klipper by somebody else.*halt it here, which shuts Klipper down"):
        controller.stop()
    assert bench.printer.state == "ready"
    controller.halt()
    assert bench.printer.state == "shutdown"


def test_a_paused_print_that_rests_is_stopped_already(
    bench: Bench, controller: KlipperController, monkeypatch: pytest.MonkeyPatch
) -> None:
    bench.printer.prints = "paused"
    controller.stop()
    assert bench.printer.state == "ready"
    # It goes to where it waits.
    monkeypatch.setattr(klipper, "LEFT_S", 0.2)
    bench.printer.run("G91\nG1 X100 F60")
    bench.pass_time(1.0)
    with pytest.raises(Refused, match="told to Klipper by somebody else"):
        controller.stop()


def test_what_an_earlier_connection_has_left_comes_to_rest_by_itself(bench: Bench) -> None:
    MOTIONS["by"](slow(bench))
    bench.ask_for(0.5)
    bench.reopen()
    bench.controller.connect()
    assert bench.controller.status().activity is Activity.MOVING
    bench.controller.stop()
    assert bench.printer.queue == []
    assert bench.printer.state == "ready"


def test_what_somebody_else_moves_on_and_on_is_only_halted(bench: Bench, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(klipper, "LEFT_S", 0.2)
    controller = slow(bench)
    bench.printer.run("G91\nG1 X100 F60")
    bench.pass_time(1.0)
    with pytest.raises(Refused, match="told to Klipper by somebody else"):
        controller.stop()
    controller.halt()
    assert bench.printer.state == "shutdown"


def test_a_klipper_that_does_not_shut_down_is_lost(bench: Bench, monkeypatch: pytest.MonkeyPatch) -> None:
    controller = slow(bench)
    MOTIONS["by"](controller)
    monkeypatch.setattr(bench.printer, "emergency_stop", lambda: None)
    with pytest.raises(DeviceLost, match="doesn't shut down"):
        controller.halt()


class Interrupted:
    """A motion in the midst of which, at a place where it writes, waits or gives way, a stop comes."""

    def __init__(self, bench: Bench, place: int) -> None:
        self.bench, self.place, self.passed = bench, place, 0
        self.controller = slow(bench)
        self.told: int | None = None
        """How much G-code there was when the stop was answered; None while none came."""
        self._answer, self._read = bench.moonraker.message, bench.read
        bench.interrupt = bench.before_write = self._act
        bench.moonraker.message, bench.read = self._message, self._act_and_read  # type: ignore[method-assign]

    def _act(self) -> None:
        self.passed += 1
        if self.passed - 1 == self.place:
            self.controller.stop()
            self.told = len(self.bench.printer.scripts)

    def _act_and_read(self, timeout_s: float) -> bytes:
        self._act()
        return self._read(timeout_s)

    def _message(self, text: str) -> list[str]:
        said = self._answer(text)
        if self.told is not None or "gcode" not in text:
            return said
        # Its answer is on its way when the stop comes.
        self.bench.hear(said)
        self._act()
        return []


@pytest.mark.parametrize("motion", MOTIONS)
def test_a_stop_at_any_place_is_final(clock: Clock, motion: str) -> None:
    """Wherever a motion writes, waits or gives way: what comes to Klipper after the stop was answered moves nothing."""
    place = 0
    while True:
        bench = Bench(clock)
        interrupted = Interrupted(bench, place)
        with suppress(AnswerUnknown, Refused):
            MOTIONS[motion](interrupted.controller)
            bench.ask_for(3.0 if interrupted.told is None else 0.0)
        if interrupted.told is None:
            break
        bench.pass_time(5.0)
        bench.ask_for(0.3)
        assert len(bench.printer.scripts) == interrupted.told, place
        assert bench.printer.queue == []
        assert bench.moonraker.wrong == []
        place += 1 if place < 20 else 5
    assert place > 30


@pytest.mark.parametrize("motion", MOTIONS)
def test_a_stop_at_any_place_of_a_part_that_is_refused_leaves_the_state_of_its_gcode(clock: Clock, motion: str) -> None:
    """What is put back after the stop was answered moves nothing."""
    place = 0
    while True:
        bench = Bench(clock)
        interrupted = Interrupted(bench, place)
        bench.printer.refuses, before = "Move out of range", dict(bench.printer.gcode)
        with suppress(AnswerUnknown, Refused):
            MOTIONS[motion](interrupted.controller)
        if interrupted.told is None:
            break
        bench.ask_for(0.3)
        assert bench.printer.gcode == before
        assert not any("G1" in script for script in bench.printer.scripts[interrupted.told :])
        place += 1
    assert place > 6


def test_a_stop_in_the_midst_of_a_push_moves_nothing_and_the_push_goes_on(bench: Bench) -> None:
    controller = bench.connected()
    asked = design(ramp__slew_speed_steps_per_s=8000, ramp__acceleration_steps_per_s2=80_000)

    def stop() -> None:
        bench.interrupt = lambda: None
        controller.stop()
        bench.interrupt = stop

    bench.interrupt = stop
    assert controller.prepare_push([asked], 0)().verified
    assert not any("G1" in script for script in bench.printer.scripts)


@pytest.mark.parametrize("what", ["push", "restore"])
def test_a_stop_while_a_limit_waits_for_somebody_elses_macro_shuts_nothing_down(bench: Bench, what: str) -> None:
    """A limit moves nothing, whenever it has its turn."""
    controller, waited = bench.connected(), list[str]()
    backup = controller.backup()
    bench.printer.is_held_up = True

    def stop() -> None:
        if bench.moonraker.waiting and not waited:
            waited.append(bench.moonraker.waiting[0])
            controller.stop()
            bench.hear(bench.moonraker.let_go())

    bench.interrupt = stop
    if what == "push":
        assert controller.prepare_push([SLOW], 0, "try")().verified
    else:
        controller.use_backup(backup)
    assert "SET_VELOCITY_LIMIT" in waited[0]
    assert bench.printer.state == "ready"
    assert "printer.emergency_stop" not in bench.moonraker.methods


def test_what_may_not_be_sent_is_not_sent(bench: Bench, controller: KlipperController) -> None:
    controller.status()

    def refuse() -> None:
        raise Refused("A stop came first.")

    bench.before_write = refuse
    with pytest.raises(Refused, match="A stop came first"):
        controller.move_by([by(80)])
    bench.before_write = lambda: None
    assert bench.printer.scripts == []
    controller.stop()
    controller.move_by([by(80)])
    bench.rest()
    assert bench.printer.position[0] == pytest.approx(101)
