from __future__ import annotations

from collections.abc import Callable

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from controllers.conftest import Clock
from controllers.klipper.bench import Bench, at, by, to
from controllers.klipper.printer import CONFIG, MACROS, Printer
from stepramp.controllers.contract import Activity
from stepramp.controllers.klipper.controller import KlipperController
from stepramp.controllers.klipper.route import script
from stepramp.errors import DeviceLost, Refused, Rejected

SLOW_MM_S = 20


@pytest.fixture
def slow(bench: Bench, controller: KlipperController) -> KlipperController:
    """Return a client of a printer with 20 mm/s and 100 mm/s²: 1600 steps/s in x."""
    bench.printer.velocity, bench.printer.accel = SLOW_MM_S, 100.0
    controller.status()
    return controller


def test_a_move_is_told_in_parts_and_leaves_the_state_of_its_gcode(bench: Bench, slow: KlipperController) -> None:
    bench.printer.gcode = {"absolute": True, "factor": 0.5, "feed": 1234.0}
    slow.move_by([by(8000)])
    status = bench.ask_for(1.0)
    assert (status.activity, status.axes[0].target_steps) == (Activity.MOVING, 16_000)
    assert status.axes[0].speed_steps_per_s == pytest.approx(1600, rel=0.01)
    assert status.axes[1].activity is Activity.READY
    bench.rest()
    assert bench.printer.position == pytest.approx([200, 100, 100], abs=1e-6)
    assert bench.printer.fastest == pytest.approx(SLOW_MM_S)
    assert len(bench.printer.scripts) > 5
    assert bench.printer.gcode == {"absolute": True, "factor": 0.5, "feed": 1234.0}
    assert slow.status().axes[0].position_steps == 16_000


def test_its_speed_never_drops_between_the_parts(bench: Bench, slow: KlipperController) -> None:
    slow.move_by([by(8000)])
    bench.ask_for(1.0)
    while bench.printer.position[0] < 190:
        assert bench.printer.speed == pytest.approx(SLOW_MM_S)
        slow.status()
        bench.pass_time(0.1)


def test_it_rests_by_itself_when_nobody_asks_any_more(bench: Bench, slow: KlipperController) -> None:
    slow.move_by([by(8000)])
    bench.ask_for(1.0)
    at_mm = bench.printer.position[0]
    bench.pass_time(10.0)
    assert bench.printer.queue == []
    # 2 s ahead, and v²/2a.
    assert bench.printer.position[0] - at_mm <= SLOW_MM_S * 2.25 + SLOW_MM_S**2 / 100
    bench.rest()
    assert bench.printer.position[0] == pytest.approx(200)


def test_positions_and_lines(bench: Bench, controller: KlipperController) -> None:
    controller.move_to([to(1000, 0), to(4000, 1)])
    bench.rest()
    assert bench.printer.position == pytest.approx([12.5, 25, 100])
    controller.line([by(80, 0), by(-160, 1), by(400, 2)])
    bench.rest()
    assert bench.printer.position == pytest.approx([13.5, 24, 101])
    assert bench.printer.speed == 0
    controller.move_by([by(0)])
    assert bench.rest().axes[0].position_steps == 1080
    with pytest.raises(Rejected, match="ramp_axis is 0; allowed: null: along a line Klipper keeps to the limits"):
        controller.line([by(80)], 0)


def test_called_positions_are_kept_here(bench: Bench, controller: KlipperController) -> None:
    controller.set_position([to(0)])
    assert controller.status().axes[0].position_steps == 0
    controller.move_to([to(-800)])
    assert bench.rest().axes[0].position_steps == -800
    assert bench.printer.position[0] == pytest.approx(90)


def test_another_target_on_the_way(bench: Bench, slow: KlipperController) -> None:
    slow.move_by([by(8000)])
    bench.ask_for(1.0)
    slow.move_by([by(800)])
    bench.rest()
    assert bench.printer.position[0] == pytest.approx(210)
    slow.move_to([to(16_000)])
    slow.move_to([to(8000)])
    bench.rest()
    assert bench.printer.position[0] == pytest.approx(100)
    slow.move_by([by(1600)])
    with pytest.raises(Refused, match="Axis 0 moves, and Klipper moves all axes by one plan"):
        slow.move_by([by(100, 1)])


@pytest.mark.parametrize("ratio", [0.0, 0.5])
def test_running_goes_on_as_long_as_somebody_asks(bench: Bench, slow: KlipperController, ratio: float) -> None:
    bench.printer.cruise = ratio
    slow.status()
    slow.run([at(800.0)])
    status = bench.ask_for(5.0)
    assert status.axes[0].runs
    assert status.axes[0].speed_steps_per_s == pytest.approx(800)
    speed_mm_s = bench.printer.fastest
    assert speed_mm_s == pytest.approx(10)
    slow.run([at(-1200.0)])
    bench.ask_for(1.0)
    assert bench.printer.fastest == pytest.approx(15)
    slow.run([at(0.0)])
    rest = bench.rest()
    assert rest.axes[0].activity is Activity.READY
    slow.run([at(80.0)])
    with pytest.raises(Refused, match="An axis runs"):
        slow.move_by([by(1)])


def test_running_ends_at_the_end_of_the_travel(bench: Bench, controller: KlipperController) -> None:
    controller.run([at(8000.0)])
    bench.rest()
    assert bench.printer.position[0] == pytest.approx(235)
    with pytest.raises(Refused, match="end of its travel"):
        controller.run([at(8000.0)])


@given(start=st.floats(0, 1000), end=st.sampled_from([-5.0, 0.0, 0.1, 210.5, 235.0, 305.3]) | st.floats(-1000, 1000))
def test_a_part_leads_no_further_than_to_its_end(start: float, end: float) -> None:
    """Klipper adds what it is told to where it is, and compares the sum with the travel: exactly, both in double."""
    lines, lengths = script({0: start}, {0: end}, 10.0)
    told = float(lines.split("G1 X")[1].split()[0])
    assert told == lengths[0]
    assert min(start, end) <= start + told <= max(start, end)
    assert start + told == pytest.approx(end, abs=1.6e-9)


@settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(start=st.floats(0, 235), speed=st.floats(8000, 24_000), is_up=st.booleans())
def test_from_any_place_to_the_ends_of_the_travel(start: float, speed: float, is_up: bool) -> None:
    end_mm = 235.0 if is_up else 0.0
    for act in (
        lambda it: it.move_to([to(18_800 if is_up else 0)]),
        lambda it: it.run([at(speed if is_up else -speed)]),
    ):
        bench = Bench(Clock())
        bench.printer.position[0] = bench.printer.target[0] = start
        controller = bench.connected()
        if abs(start - end_mm) > 0.01:
            act(controller)
        assert bench.rest().trouble is None
        assert bench.printer.position[0] == pytest.approx(end_mm, abs=0.01)


def test_steps_back_from_an_end_lead_there_again_however_they_are_rounded(clock: Clock) -> None:
    # 240 steps/mm: none of 9 decimals leads to a whole step.
    printer_cfg = CONFIG.replace(
        "rotation_distance: 40\nposition_max", "rotation_distance: 40\ngear_ratio: 3:1\nposition_max"
    )
    bench = Bench(clock, {"printer.cfg": printer_cfg, "macros/start.cfg": MACROS})
    controller = bench.connected()
    controller.move_to([to(56_400)])
    for steps in (-1, 1, -7, 3, 4, -56_400, 56_399, 1):
        bench.rest()
        controller.move_by([by(steps)])
    assert bench.rest().trouble is None
    assert bench.printer.position[0] == pytest.approx(235, abs=1.6e-9)


def test_running_ends_at_the_ends_that_are_told(bench: Bench, controller: KlipperController) -> None:
    [here, *_] = controller.status().axes
    controller.set_position([to(0)])
    controller.keep_within({0: (None, 1234), 1: (0, None)})
    controller.run([at(4000)])
    bench.ask_for(8.0)
    [axis, *_] = controller.status().axes
    assert (axis.activity, axis.position_steps) == (Activity.READY, 1234)
    # 80 steps/mm, from where it was homed.
    assert bench.printer.position[0] * 80 == pytest.approx(here.position_steps + 1234)


def test_two_axes_run_along_a_line(bench: Bench, controller: KlipperController) -> None:
    controller.run([at(800.0, 0), at(-1600.0, 1)])
    bench.ask_for(2.0)
    assert bench.printer.fastest == pytest.approx(10 * 2**0.5)
    x, y, _ = bench.printer.position
    assert x - 100 == pytest.approx(100 - y)


@pytest.mark.parametrize(
    ("act", "words"),
    [
        (lambda it: it.move_by([by(1, 3)]), "axis is 3; allowed: an axis of this controller: 0 to 2"),
        (lambda it: it.move_by([by(1), by(2)]), "each axis once"),
        (lambda it: it.move_to([to(18_801)]), r"to_steps is 18801; .*from 0 to 18,800 steps, the travel of axis x"),
        (lambda it: it.move_to([to(-801, 1)]), r"from -800 to 37,600 steps"),
        (lambda it: it.move_by([by(-8001)]), r"by_steps is -8001; .*from -8,000 to 10,800 steps"),
        (lambda it: it.run([at(24_001.0)]), "the highest speed of the axis"),
        (lambda it: it.run([at(-2001.0, 2)]), "the highest speed of the axis"),
        (lambda it: it.run([at(1e-6)]), "steps/s either way, or 0"),
    ],
)
def test_what_leads_too_far_or_too_fast(
    bench: Bench, controller: KlipperController, act: Callable[[KlipperController], None], words: str
) -> None:
    with pytest.raises(Rejected, match=words):
        act(controller)
    assert bench.printer.scripts == []


def test_axes_that_are_not_homed(bench: Bench, controller: KlipperController) -> None:
    bench.printer.homed = "xy"
    assert controller.status().trouble == "Axis z isn't homed: Klipper doesn't move it before. Home it at the printer."
    assert [axis.position_told for axis in controller.status().axes] == [True, True, False]
    for act in (
        lambda: controller.move_by([by(1, 2)]),
        lambda: controller.run([at(10.0, 2)]),
        # Once it is homed it would be counted from elsewhere.
        lambda: controller.set_position([to(0), to(0, 2)]),
    ):
        with pytest.raises(Refused, match="Axis z isn't homed"):
            act()
    assert bench.printer.scripts == []
    controller.move_by([by(80)])
    bench.printer.homed = ""
    several = "Axes x, y and z aren't homed: Klipper doesn't move them before. Home them at the printer."
    assert controller.status().trouble == several


@pytest.mark.parametrize("prints", ["printing", "paused"])
def test_nothing_moves_while_it_prints(bench: Bench, controller: KlipperController, prints: str) -> None:
    bench.printer.prints = prints
    with pytest.raises(Refused, match="it prints, or has paused that"):
        controller.move_by([by(80)])
    with pytest.raises(Refused, match="it prints, or has paused that"):
        controller.run([at(80.0)])
    assert bench.printer.scripts == []


def test_nothing_moves_while_it_is_busy_with_what_somebody_else_has_told_it(
    bench: Bench, controller: KlipperController
) -> None:
    bench.printer.busy_until_s = 1e9
    with pytest.raises(Refused, match="busy with what somebody has told it"):
        controller.move_by([by(80)])
    assert bench.printer.scripts == []


def test_a_part_that_klipper_refuses_ends_the_motion(bench: Bench, slow: KlipperController) -> None:
    slow.move_by([by(8000)])
    bench.printer.refuses = "Printer is paused"
    bench.ask_for(1.0)
    bench.printer.refuses = None
    status = bench.rest()
    assert status.trouble is not None
    assert (
        "The last motion was cut short. Klipper at moonraker://printer:7125 says: Printer is paused." in status.trouble
    )
    assert bench.printer.position[0] < 200
    slow.move_by([by(8)])
    assert slow.status().trouble is None


def test_a_part_that_is_refused_leaves_the_state_of_its_gcode(bench: Bench, slow: KlipperController) -> None:
    before = {"absolute": True, "factor": 0.5, "feed": 1234.0}
    bench.printer.gcode = dict(before)
    bench.printer.refuses = "Move out of range"
    with pytest.raises(Refused, match="Move out of range"):
        slow.move_by([by(8000)])
    assert bench.printer.gcode == before
    bench.printer.refuses = None
    slow.run([at(800.0)])
    bench.ask_for(1.0)
    # Somebody switches the motors off, as at the printer's own page.
    bench.printer.homed = ""
    status = bench.ask_for(1.0)
    assert "cut short" in (status.trouble or "")
    assert bench.printer.gcode == before
    told = len(bench.printer.scripts)
    bench.ask_for(1.0)
    assert len(bench.printer.scripts) == told


def test_a_motion_whose_answer_never_comes_is_ended_at_once(bench: Bench, printer: Printer) -> None:
    controller = bench.connected()
    bench.moonraker.unanswered.append("printer.gcode.script")
    with pytest.raises(DeviceLost, match="does not answer"):
        controller.move_by([by(8000)])
    assert printer.state == "shutdown"


@pytest.mark.parametrize("notice", ["disconnected", "ready"])
def test_a_klipper_that_goes_in_the_midst_of_a_motion_is_lost(
    bench: Bench, slow: KlipperController, notice: str
) -> None:
    slow.move_by([by(8000)])
    bench.ask_for(1.0)
    bench.hear([f'{{"jsonrpc": "2.0", "method": "notify_klippy_{notice}"}}'])
    with pytest.raises(DeviceLost, match="was restarted: its position is no longer known"):
        slow.status()


def test_a_klipper_that_fails_in_the_midst_of_a_motion_says_why(bench: Bench, slow: KlipperController) -> None:
    slow.move_by([by(8000)])
    bench.ask_for(1.0)
    bench.printer.emergency_stop()
    bench.printer.message = "MCU 'mcu' shutdown: Timer too close"
    told = len(bench.printer.scripts)
    status = bench.rest()
    assert status.trouble is not None
    assert "Timer too close Say FIRMWARE_RESTART" in status.trouble
    assert len(bench.printer.scripts) == told


def test_slow_answers_delay_a_motion_and_do_not_end_it(bench: Bench, slow: KlipperController) -> None:
    bench.lasts_s = 0.2
    slow.move_by([by(4000)])
    bench.rest()
    assert bench.printer.position[0] == pytest.approx(150)
    assert bench.printer.fastest == pytest.approx(SLOW_MM_S)


def test_somebody_else_sends_the_tool_elsewhere(bench: Bench, slow: KlipperController) -> None:
    slow.move_by([by(1600)])
    bench.pass_time(10.0)
    bench.printer.position = bench.printer.target = [50.0, 50.0, 50.0]
    status = bench.rest()
    assert status.axes[0].position_steps == 4000
