"""What a grbl's axes are told: jogs, where they lead, and what is refused."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from controllers.grbl.bench import Bench, at, by, to
from controllers.grbl.emulator import GrblEmulator
from stepramp.controllers.contract import Activity, AxisCommand
from stepramp.controllers.grbl.controller import GrblController
from stepramp.errors import Refused, Rejected


def only_rejection(ask: Callable[[], object]) -> tuple[str, object, str]:
    with pytest.raises(Rejected) as caught:
        ask()
    [rejection] = caught.value.rejections
    return rejection.field, rejection.value, rejection.allowed


def test_a_move_is_one_jog_in_machine_coordinates(bench: Bench, controller: GrblController) -> None:
    controller.move_by([by(-1001)])
    assert bench.grbl.lines == ["$$", "$J=G53G21G90X-4.0040000F500"]
    status = controller.status()
    assert (status.activity, status.motors_on) == (Activity.MOVING, True)
    assert [axis.activity for axis in status.axes] == [Activity.MOVING, Activity.READY, Activity.READY]
    assert status.axes[0].target_steps == -1001
    rested = bench.rest().axes[0]
    assert (rested.position_steps, rested.target_steps, rested.steps_made) == (-1001, -1001, 1001)
    assert bench.grbl.position == [-1001, 0, 0]


def test_axes_that_are_told_together_go_along_a_line(bench: Bench, controller: GrblController) -> None:
    controller.line([by(1000), by(-500, 1)])
    first, second, third = bench.ask_for(1.5).axes
    assert first.speed_steps_per_s == pytest.approx(2 * second.speed_steps_per_s, rel=0.01)
    assert (first.activity, second.activity, third.activity) == (Activity.MOVING, Activity.MOVING, Activity.READY)
    bench.rest()
    assert bench.grbl.position == [1000, -500, 0]
    with pytest.raises(Rejected, match="ramp_axis is 0; allowed: null: along a line grbl keeps to the limits"):
        controller.line([by(10)], 0)


def test_moving_on_from_the_target_on_the_way(bench: Bench, controller: GrblController) -> None:
    controller.move_by([by(3000)])
    bench.ask_for(0.9)
    controller.move_by([by(500)])
    assert bench.rest().axes[0].position_steps == bench.grbl.position[0] == 3500


def test_another_target_on_the_way(bench: Bench, controller: GrblController) -> None:
    controller.move_to([to(3000)])
    bench.ask_for(0.9)
    controller.move_to([to(-200)])
    assert bench.rest().axes[0].position_steps == bench.grbl.position[0] == -200


def test_others_are_not_moved_while_some_move(bench: Bench, controller: GrblController) -> None:
    controller.move_by([by(3000)])
    with pytest.raises(Refused, match="Axis 0 moves, and grbl moves all axes by one plan"):
        controller.move_by([by(3000, 1)])
    bench.rest()
    assert bench.grbl.position == [3000, 0, 0]


def test_a_run_goes_on_as_long_as_somebody_asks(bench: Bench, controller: GrblController) -> None:
    controller.run([at(-500)])
    axis = bench.ask_for(9).axes[0]
    assert axis.runs
    assert axis.speed_steps_per_s == pytest.approx(500, abs=5)
    bench.pass_time(30)
    # 1.5 s on, and what slowing down takes: 500² / (2 · 2500) = 50 steps.
    left = bench.controller.status().axes[0]
    assert left.activity is Activity.READY
    assert 500 * 9 < -left.position_steps < 500 * 12


@pytest.mark.parametrize(
    ("speeds", "rests_at"),
    [
        ((1000,), (1500, 0)),
        ((-1000,), (-200, 0)),
        # Along a line: as soon as one of both is there.
        ((1000, 100), (1500, 150)),
        ((200, 400), (50, 100)),
    ],
)
def test_a_run_leads_no_further_than_its_ends(
    bench: Bench, controller: GrblController, speeds: tuple[int, ...], rests_at: tuple[int, int]
) -> None:
    controller.set_position([to(100), to(-50, 1)])
    controller.keep_within({0: (-100, 1600), 1: (None, 50 if speeds[0] < 300 else 100)})
    controller.run([at(speed, axis) for axis, speed in enumerate(speeds)])
    bench.ask_for(6.0)
    assert controller.status().activity is Activity.READY
    assert tuple(bench.grbl.position[:2]) == rests_at


def test_a_run_of_several_axes_and_another_speed(bench: Bench, controller: GrblController) -> None:
    controller.run([at(400), at(-200, 1)])
    bench.ask_for(2.4)
    controller.run([at(0, 1)])
    before = list(bench.grbl.position)
    bench.ask_for(2.4)
    assert bench.grbl.position[0] > before[0] + 300
    assert bench.grbl.position[1] == before[1]
    controller.run([at(0)])
    rested = bench.rest()
    assert [axis.position_steps for axis in rested.axes] == bench.grbl.position


def test_speeds_beyond_what_it_can(controller: GrblController) -> None:
    field, value, allowed = only_rejection(lambda: controller.run([at(2100)]))
    assert (field, value) == ("speed_steps_per_s", 2100)
    # 500 mm/min at 250 steps/mm.
    assert allowed.startswith("from -2,083.333333 to 2,083.333333 steps/s, the highest rate of the axis")
    field, value, allowed = only_rejection(lambda: controller.run([at(-30)]))
    assert allowed.startswith("a number from 30.51757813 to 2,083.33333")


def test_a_move_by_steps_needs_to_know_where_it_rests(bench: Bench, controller: GrblController) -> None:
    controller.run([at(500)])
    bench.ask_for(0.6)
    with pytest.raises(Refused, match="isn't known yet where it comes to rest"):
        controller.move_by([by(10)])


@pytest.mark.parametrize(("per_mm", "furthest"), [(250.0, 2**24), (1.0, 2**24)])
def test_places_that_float32_cant_tell_are_refused_by_name(bench: Bench, per_mm: float, furthest: int) -> None:
    bench.grbl.eeprom.settings[100] = per_mm
    bench.controller.connect()
    bench.grbl.lines.clear()
    field, value, allowed = only_rejection(lambda: bench.controller.move_to([to(2 * furthest + 1)]))
    assert (field, value) == ("to_steps", 2 * furthest + 1)
    assert "eight digits of mm as float32" in allowed
    most = int(allowed.partition("up to ")[2].split(" ")[0].replace(",", ""))
    assert 0 < most <= 2 * furthest
    assert bench.grbl.lines == ["$$"]


def test_axes_that_are_not_there(controller: GrblController) -> None:
    two = [AxisCommand(0, 5, "axes.0.by_steps"), AxisCommand(3, 5, "axes.1.by_steps")]
    assert only_rejection(lambda: controller.move_by(two)) == ("axes.1.axis", 3, "an axis of this controller: 0 to 2")
    twice = [AxisCommand(1, 5, "axes.0.by_steps"), AxisCommand(1, 5, "axes.1.by_steps")]
    assert only_rejection(lambda: controller.move_by(twice)) == ("axes.1.axis", 1, "each axis once")


def test_positions_are_called_something_else_without_telling_it(bench: Bench, controller: GrblController) -> None:
    controller.move_by([by(500)])
    bench.rest()
    bench.grbl.lines.clear()
    controller.set_position([to(7), to(-3, 2)])
    assert [axis.position_steps for axis in controller.status().axes] == [7, 0, -3]
    assert (bench.grbl.lines, bench.grbl.eeprom.writes) == ([], 0)
    controller.move_to([to(-93)])
    bench.rest()
    assert bench.grbl.position == [400, 0, 0]


def test_fine_steps_are_known_though_it_tells_thousandths(bench: Bench) -> None:
    bench.grbl.eeprom.settings[100] = 3200.0
    bench.controller.connect()
    for steps in (1, 1, 1, 7, -3):
        bench.controller.move_by([by(steps)])
        bench.rest()
    assert bench.grbl.position[0] == bench.controller.status().axes[0].position_steps == 7


@pytest.mark.parametrize(
    ("state", "words"),
    [
        ("Hold", "it was put on hold at the machine"),
        ("Door", "its safety door is open"),
        ("Check", "it is in check mode"),
        ("Sleep", "it sleeps until it is reset"),
        ("Run", "a program that somebody else has started"),
        ("Home", "it is homing"),
        ("Alarm", "it is locked since it was started, or since an alarm"),
    ],
)
def test_what_keeps_it_from_moving_is_told(bench: Bench, controller: GrblController, state: str, words: str) -> None:
    bench.grbl.state = state
    for ask in (lambda: controller.move_by([by(5)]), lambda: controller.run([at(100)])):
        with pytest.raises(Refused, match="The controller can't move: ") as caught:
            ask()
        assert words in str(caught.value)
    assert bench.grbl.lines == []
    trouble = controller.status().trouble
    assert (trouble is None) == (state == "Run")
    bench.grbl.state = "Idle"
    assert controller.status().trouble is None


def test_its_own_soft_limits_are_told(bench: Bench, grbl: GrblEmulator, controller: GrblController) -> None:
    grbl.settings[20] = 1.0
    with pytest.raises(Refused, match=r"the way leads beyond its soft limits \(error:15\)"):
        controller.move_by([by(10)])
    bench.pass_time(1)
    assert grbl.steps == 0


MOTIONS: tuple[Callable[[GrblController], None], ...] = (
    lambda controller: controller.move_by([by(800)]),
    lambda controller: controller.move_to([to(800)]),
    lambda controller: controller.run([at(500)]),
)


@pytest.mark.parametrize("begin", MOTIONS)
def test_nothing_moves_by_steps_per_mm_that_the_controller_has_no_more(
    bench: Bench, grbl: GrblEmulator, controller: GrblController, begin: Callable[[GrblController], None]
) -> None:
    controller.move_by([by(500, 1)])
    bench.rest()
    steps, words = grbl.steps, r"\$101 has changed from 250 to 500, so Y may be at another place than is counted"
    grbl.settings[101] = grbl.eeprom.settings[101] = 500.0
    # Of any axis: an axis that a jog doesn't name is planned by its old steps per mm, and would set out, too.
    for _ in range(2):
        with pytest.raises(Refused, match=f"can't move: {words}. Set the position here"):
            begin(controller)
    bench.pass_time(3)
    assert grbl.steps == steps
    assert "$101 has changed from 250 to 500" in (controller.status().trouble or "")
    controller.set_position([to(0), to(0, 1)])
    begin(controller)
    bench.ask_for(0.9)
    controller.move_to([to(800), to(100, 1)])
    rested = bench.rest()
    assert rested.trouble is None
    assert [axis.steps_per_mm for axis in rested.axes] == [250, 500, 250]
    assert grbl.position == [800, 600, 0]


def told_of(controller: GrblController) -> list[tuple[int, float | None]]:
    return [(axis.position_steps, axis.steps_per_mm) for axis in controller.status().axes]


def test_steps_per_mm_that_others_set_at_rest_are_told_at_once(
    bench: Bench, grbl: GrblEmulator, controller: GrblController
) -> None:
    controller.move_by([by(500, 1)])
    bench.rest()
    grbl.lines.clear()
    bench.ask_for(3)
    assert grbl.lines == [], "what was begun here, and rests, takes no more questions"
    grbl.settings[101] = 500.0
    # It counts steps: they stay.
    assert told_of(controller) == [(0, 250), (500, 500), (0, 250)]
    assert "$101 has changed from 250 to 500, so Y may be at another place" in (controller.status().trouble or "")
    bench.ask_for(3)
    assert grbl.lines == ["$$", "$$", "$N"], "once for each change"
    with pytest.raises(Refused, match=r"\$101 has changed from 250 to 500"):
        controller.move_by([by(800)])
    grbl.lines.clear()
    grbl.run_program("G0 X5")
    bench.pass_time(30)
    assert told_of(controller)[0] == (1250, 250)
    bench.ask_for(3)
    assert grbl.lines == ["$$"], "others may have moved it: the scales are as they were"


def test_steps_per_mm_set_where_it_counts_from_are_told_once_others_have_moved_it(
    bench: Bench, grbl: GrblEmulator, controller: GrblController
) -> None:
    bench.ask_for(1)
    grbl.settings[100] = 500.0
    bench.ask_for(1)
    grbl.run_program("G0 X5")
    bench.pass_time(30)
    assert told_of(controller)[0] == (2500, 500)


def test_places_that_are_told_in_inches_from_now_on_are_the_same(
    bench: Bench, grbl: GrblEmulator, controller: GrblController
) -> None:
    controller.move_by([by(500)])
    bench.rest()
    grbl.settings[13] = 1.0
    assert told_of(controller)[0] == (500, 250)
    assert controller.status().trouble is None


def test_what_takes_no_line_is_asked_for_no_steps_per_mm(
    bench: Bench, grbl: GrblEmulator, controller: GrblController
) -> None:
    """After a limit switch was hit; nor what isn't at rest."""
    controller.move_by([by(500)])
    bench.rest()
    grbl.lines.clear()
    for state, alarm in (("Hold", None), ("Sleep", None), ("Alarm", 1)):
        grbl.state, grbl.alarm_told = state, alarm
        grbl.position[0] += 100
        bench.ask_for(1)
    assert grbl.lines == []
    grbl.state = "Idle"
    bench.ask_for(1)
    assert grbl.lines == ["$$"]


def test_steps_per_mm_that_were_heard_wrong_move_nothing(bench: Bench, grbl: GrblEmulator) -> None:
    grbl.starts_on_open = False
    grbl.exchange(b"")
    grbl.position, grbl._mm = [500, 0, 0], [2.0, 0.0, 0.0]
    grbl.on_the_way_out = lambda said: said.replace(b"$100=250.000", b"$100=25.000")
    bench.controller.connect()
    grbl.on_the_way_out = lambda said: said
    with pytest.raises(Refused, match=r"\$100 has changed from 25 to 250"):
        bench.controller.move_by([by(800)])
    # Heard wrong in between, they are asked for once more.
    bench.controller.set_position([to(0)])
    left = [b"$100=25.000"]
    grbl.on_the_way_out = lambda said: (
        said.replace(b"$100=250.000", left.pop()) if left and b"$100=250.000" in said else said
    )
    bench.controller.move_by([by(800)])
    assert (bench.rest().axes[0].position_steps, grbl.position[0], left) == (800, 1300, [])


@pytest.mark.parametrize("begin", MOTIONS)
def test_where_it_counts_from_a_motion_is_refused_once_that_was_asked_for_by_other_steps_per_mm(
    bench: Bench, grbl: GrblEmulator, controller: GrblController, begin: Callable[[GrblController], None]
) -> None:
    """It is where it counts, but whoever asked in mm has worked the steps out with the former."""
    grbl.settings[100] = grbl.eeprom.settings[100] = 500.0
    with pytest.raises(Refused, match=r"\$100 has changed from 250 to 500, so .* Nothing was moved: ask again\."):
        begin(controller)
    bench.pass_time(3)
    status = controller.status()
    assert (grbl.steps, status.trouble, status.axes[0].steps_per_mm) == (0, None, 500)
    begin(controller)
    bench.ask_for(0.9)
    controller.move_to([to(800)])
    assert (bench.rest().axes[0].position_steps, grbl.position) == (800, [800, 0, 0])


def test_where_a_reset_would_move_something_its_new_steps_per_mm_wait_for_it(bench: Bench, grbl: GrblEmulator) -> None:
    grbl.starts_on_open = False
    grbl.eeprom.startup[0] = "G0 X10"
    bench.controller.connect()
    bench.controller.move_by([by(250)])
    bench.rest()
    steps = grbl.steps
    grbl.settings[100] = 500.0
    with pytest.raises(Refused, match="has changed"):
        bench.controller.move_by([by(800)])
    with pytest.raises(Refused, match="has to be started anew before it moves, and can't be from here"):
        bench.controller.set_position([to(0)])
    bench.pass_time(3)
    assert grbl.steps == steps


def test_an_axis_whose_settings_make_no_sense_any_more(grbl: GrblEmulator, controller: GrblController) -> None:
    grbl.settings[101] = 0.0
    with pytest.raises(Rejected, match="an axis of this controller: 0 to 0"):
        controller.move_by([by(5, 1)])
