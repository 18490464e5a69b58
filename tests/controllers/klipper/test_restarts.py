"""Klipper starts anew for what a push or a restore has written."""

from __future__ import annotations

import pytest

from controllers.klipper.bench import SLOW, Bench, to
from controllers.klipper.printer import CONFIG
from stepramp.controllers.contract import Activity
from stepramp.controllers.klipper import conversation, memory
from stepramp.controllers.klipper.backup import Backup
from stepramp.controllers.klipper.controller import KlipperController
from stepramp.errors import DeviceLost, Refused


def test_a_klipper_that_does_not_start_with_it(
    bench: Bench, controller: KlipperController, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fails() -> None:
        bench.printer.state, bench.printer.message = "error", "Option 'max_accel' is not valid."

    monkeypatch.setattr(memory, "RESTART_S", 0.05)
    monkeypatch.setattr(bench.printer, "restart", fails)
    with pytest.raises(Refused, match=r"Klipper doesn't start: Option 'max_accel' is not valid. Restore a backup"):
        controller.prepare_push([SLOW], 0)()


def restart_in_steps(bench: Bench, monkeypatch: pytest.MonkeyPatch, *states: str) -> None:
    """Have a restart lead through states that last for a moment each; bench.interrupt is called in each of them."""
    restart, begun_s = bench.printer.restart, []

    def begin() -> None:
        restart()
        bench.printer.state = states[0]
        begun_s.append(bench.clock.now_s)

    def go_on() -> None:
        if begun_s and bench.printer.state != "shutdown":
            passed = int((bench.clock.now_s - begun_s[0]) / 0.2)
            bench.printer.state = [*states, "ready"][min(passed, len(states))]

    monkeypatch.setattr(bench.printer, "restart", begin)
    give_way = bench.controller._conversation._give_way
    monkeypatch.setattr(bench.controller._conversation, "_give_way", lambda pause_s: (go_on(), give_way(pause_s)))


@pytest.mark.parametrize("what", ["stop", "halt"])
def test_a_stop_while_it_starts_anew_is_answered_and_the_push_proven(
    bench: Bench, controller: KlipperController, monkeypatch: pytest.MonkeyPatch, what: str
) -> None:
    """At each instant: nothing moves then, and that it has started is no loss, since it was told to."""
    restart_in_steps(bench, monkeypatch, "startup", "disconnected", "startup")
    states: list[str] = []

    def interrupt() -> None:
        if bench.printer.restarts:
            monkeypatch.setattr(bench, "interrupt", lambda: None)
            getattr(controller, what)()
            states.append(bench.printer.state)
            monkeypatch.setattr(bench, "interrupt", interrupt)

    bench.interrupt = interrupt
    report = controller.prepare_push([SLOW], 0)()
    bench.interrupt = lambda: None
    assert {"startup", "disconnected", "ready"} <= set(states)
    assert (report.verified, report.kept) == (True, True)
    assert "printer.emergency_stop" not in bench.moonraker.methods
    assert controller.status().activity is Activity.READY


def test_a_halt_of_what_somebody_else_begins_as_it_has_started_is_told_by_the_push(
    bench: Bench, controller: KlipperController, monkeypatch: pytest.MonkeyPatch
) -> None:
    restart_in_steps(bench, monkeypatch, "startup")

    def interrupt() -> None:
        if bench.printer.restarts and bench.printer.state == "ready" and bench.printer.prints != "printing":
            bench.printer.prints = "printing"
            controller.halt()

    bench.interrupt = interrupt
    with pytest.raises(Refused, match="All is written, and Klipper was halted before it was seen to start with it"):
        controller.prepare_push([SLOW], 0)()
    assert bench.printer.state == "shutdown"


@pytest.mark.parametrize("what", ["stop", "halt"])
def test_a_stop_just_as_klipper_goes_for_a_restart_is_answered(
    bench: Bench, controller: KlipperController, monkeypatch: pytest.MonkeyPatch, what: str
) -> None:
    """Moonraker still calls it ready, and no longer reaches it."""
    restart = bench.printer.restart
    done: list[str] = []

    def gone() -> None:
        restart()
        bench.printer.state, bench.moonraker.is_cut_off_until_s = "startup", bench.clock.now_s + 0.5
        bench.moonraker.calls_it_ready_until_s = bench.clock.now_s + 0.3

    def interrupt() -> None:
        if bench.printer.restarts and not done:
            done.append(what)
            getattr(controller, what)()
        if bench.printer.restarts and bench.clock.now_s > bench.moonraker.is_cut_off_until_s:
            bench.printer.state = "ready"

    monkeypatch.setattr(bench.printer, "restart", gone)
    bench.interrupt = interrupt
    report = controller.prepare_push([SLOW], 0)()
    assert (done, report.verified, report.kept) == ([what], True, True)
    assert "printer.emergency_stop" not in bench.moonraker.methods


@pytest.mark.parametrize("unknown_s", [0.0, 0.1, 0.3, 0.6, 1.5])
def test_a_klipper_that_moonraker_calls_ready_as_it_goes_is_waited_for(
    bench: Bench, controller: KlipperController, monkeypatch: pytest.MonkeyPatch, unknown_s: float
) -> None:
    """So long Moonraker doesn't know that it has gone, and reaches it only once it is back."""
    for module in (conversation, memory):
        monkeypatch.setattr(module, "monotonic", bench.clock)
    monkeypatch.setattr(conversation, "AGAIN_S", 0.25)
    restart = bench.printer.restart

    def gone() -> None:
        restart()
        bench.printer.state, bench.moonraker.is_cut_off_until_s = "startup", bench.clock.now_s + 2.0
        bench.moonraker.calls_it_ready_until_s = bench.clock.now_s + unknown_s

    def interrupt() -> None:
        if bench.printer.restarts and bench.clock.now_s > bench.moonraker.is_cut_off_until_s:
            bench.printer.state = "ready"

    monkeypatch.setattr(bench.printer, "restart", gone)
    bench.interrupt = interrupt
    report = controller.prepare_push([SLOW], 0)()
    assert (report.verified, report.kept) == (True, True)


def test_a_klipper_that_is_ready_and_never_reached_is_told_with_what_was_written(
    bench: Bench, controller: KlipperController, monkeypatch: pytest.MonkeyPatch
) -> None:
    for module in (conversation, memory):
        monkeypatch.setattr(module, "monotonic", bench.clock)

    def gone() -> None:
        bench.moonraker.is_cut_off_until_s = bench.moonraker.calls_it_ready_until_s = bench.clock.now_s + 1000.0

    monkeypatch.setattr(bench.printer, "restart", gone)
    with pytest.raises(Refused, match=r"All is written, and Klipper wasn't seen to start with it.*Klippy Disconnected"):
        controller.prepare_push([SLOW], 0)()


def test_a_restart_by_somebody_else_is_noticed_also_where_it_is_not_restarted_from_here(
    bench: Bench, controller: KlipperController
) -> None:
    bench.printer.has_current = True

    def restarted() -> None:
        if bench.printer.files["printer.cfg"] != CONFIG:
            bench.interrupt = lambda: None
            bench.hear(['{"jsonrpc": "2.0", "method": "notify_klippy_disconnected"}'])

    bench.interrupt = restarted
    with pytest.raises(DeviceLost, match="was restarted: its position is no longer known"):
        controller.prepare_push([SLOW], 0)()


@pytest.mark.parametrize(
    ("old", "new", "is_kept"),
    [
        ("rotation_distance: 40", "rotation_distance: 20", False),
        ("position_max: 235", "position_endstop: 235\nposition_max: 235", False),
        ("max_velocity: 300", "max_velocity: 200", True),
    ],
)
def test_positions_are_counted_as_klipper_does_once_a_restore_has_changed_its_axes(
    bench: Bench, controller: KlipperController, old: str, new: str, is_kept: bool
) -> None:
    text = Backup("printer.cfg", {}, {**bench.printer.files, "printer.cfg": CONFIG.replace(old, new)}).text
    controller.set_position([to(0)])
    remarks = controller.use_backup(text)
    assert bench.printer.restarts == 1
    bench.printer.homed = "xyz"
    [x, *_] = controller.status().axes
    assert x.steps_per_mm is not None
    assert x.position_steps == (0 if is_kept else 100 * x.steps_per_mm)
    assert any("Positions are counted as Klipper does again" in each for each in remarks) is not is_kept
