"""What keeps a Tic from moving, and what it stops by itself for."""

from __future__ import annotations

import pytest

from controllers.bench import POLL_S, at, by, to
from controllers.tic.bench import TARGET_FAR_AWAY, Bench
from controllers.tic.emulator import DEENERGIZE, HALT_AND_HOLD, NORMAL, STARTING_UP, VELOCITY
from stepramp.controllers.contract import AxisCommand
from stepramp.controllers.tic.controller import TicController
from stepramp.errors import DeviceLost, Refused


@pytest.mark.parametrize(
    ("condition", "words"),
    [
        ("low_vin", "the supply of its motor is off or too low \\(low VIN\\)"),
        ("driver_fault", "its motor driver reports a fault"),
        ("kill_switch", "its kill switch is active"),
        ("err_line_high", "its ERR line is high"),
    ],
)
def test_what_keeps_a_tic_from_moving_is_told(
    bench: Bench, controller: TicController, condition: str, words: str
) -> None:
    bench.tic.press(condition)
    for ask in (lambda: controller.move_by(by(5)), lambda: controller.run(at(5)), lambda: controller.zero([0], 5)):
        with pytest.raises(Refused, match=f"^The Tic can't move: {words}"):
            ask()
    assert not {0xE0, 0xE3, 0x83, 0x85} & set(bench.told())
    assert controller.status().trouble is not None
    bench.tic.press(condition, False)
    assert controller.status().trouble is None
    controller.move_by(by(5))
    assert bench.rest().axes[0].position_steps == 5


@pytest.mark.parametrize("response", [DEENERGIZE, HALT_AND_HOLD, 2])
@pytest.mark.parametrize("condition", ["low_vin", "kill_switch", "err_line_high"])
@pytest.mark.parametrize("begin", ["move_by", "run"])
def test_what_an_error_cut_short_is_not_gone_on_with(
    bench: Bench, controller: TicController, response: int, condition: str, begin: str
) -> None:
    """Not even by a Tic whose own precautions are switched off."""
    tic = bench.tic
    tic.disable_safe_start, tic.command_timeout_ms, tic.soft_error_response = True, 0, response
    getattr(controller, begin)([AxisCommand(0, 1000, "value")])
    bench.pass_time(0.3)
    tic.press(condition)
    status = bench.rest()
    assert status.trouble is not None
    steps = tic.steps
    tic.press(condition, False)
    for _ in range(5):
        status = controller.status()
        bench.pass_time(POLL_S)
    assert tic.steps == steps
    assert status.trouble is not None
    assert status.trouble.startswith("The Tic has stopped by itself: ")


@pytest.mark.parametrize(
    ("forgotten", "cause"),
    [(False, "the supply of its motor was off or too low (low VIN)"), (True, "its driver was started anew")],
)
def test_what_a_failing_supply_cut_short_is_told_though_it_is_over(
    bench: Bench, controller: TicController, forgotten: bool, cause: str
) -> None:
    """Without safe start a Tic would go on by itself as soon as its driver is ready again.

    The Control Center has the Tic forget time and again which errors have occurred.
    """
    bench.tic.disable_safe_start, bench.lasts_s = True, 0.0
    controller.run(at(1000))
    bench.pass_time(0.3)
    bench.tic.press("low_vin")
    bench.tic.press("low_vin", False)
    assert bench.tic.state == STARTING_UP
    if forgotten:
        bench.tic.errors_occurred = 0
    bench.lasts_s = 0.002
    assert controller.status().trouble == (
        f"The Tic has stopped by itself: {cause}. It may be elsewhere than it counts."
    )
    bench.pass_time(1)
    assert bench.tic.velocity == 0


WAS = {
    "low_vin": "the supply of its motor was off or too low (low VIN). It may be elsewhere than it counts.",
    "driver_fault": "its motor driver reported a fault, such as too much current or heat (motor driver error). It may "
    "be elsewhere than it counts.",
    "kill_switch": "its kill switch was active.",
    "err_line_high": "its ERR line was high, since another device that is wired to it reported an error.",
}


@pytest.mark.parametrize("condition", WAS)
def test_what_has_ended_a_motion_is_told_as_past_once_it_is_over(
    bench: Bench, controller: TicController, condition: str
) -> None:
    controller.run(at(1000))
    bench.pass_time(0.3)
    bench.tic.press(condition)
    assert (bench.rest().trouble or "").startswith("The Tic can't move: ")
    bench.tic.press(condition, False)
    assert controller.status().trouble == f"The Tic has stopped by itself: {WAS[condition]}"
    controller.set_position(to(0))
    assert controller.status().trouble is None


@pytest.mark.parametrize("condition", WAS)
def test_what_came_and_went_at_rest_is_told_only_if_the_motor_was_let_go_of(
    bench: Bench, controller: TicController, condition: str
) -> None:
    controller.move_by(by(50))
    bench.rest()
    bench.tic.press(condition)
    assert (controller.status().trouble or "").startswith("The Tic can't move: ")
    bench.tic.press(condition, False)
    let_go = condition in ("low_vin", "driver_fault")
    told = f"The motor of the Tic has been without current: {WAS[condition]}" if let_go else None
    assert controller.status().trouble == told
    controller.move_by(by(50))
    assert bench.rest().trouble is None


def test_a_motion_that_came_to_its_end_before_was_not_cut_short(bench: Bench, controller: TicController) -> None:
    """Though nobody has looked in between."""
    controller.move_by(by(10))
    bench.pass_time(0.8)
    bench.tic.press("kill_switch")
    controller.status()
    bench.tic.press("kill_switch", False)
    assert controller.status().trouble is None


def test_the_last_trouble_is_told_not_one_before(bench: Bench, controller: TicController) -> None:
    controller.run(at(1000))
    bench.pass_time(0.3)
    for condition in ("kill_switch", "low_vin"):
        bench.tic.press(condition)
        bench.rest()
        bench.tic.press(condition, False)
        trouble = controller.status().trouble
    assert trouble == f"The motor of the Tic has been without current: {WAS['low_vin']}"


@pytest.mark.parametrize("condition", WAS)
@pytest.mark.parametrize("begin", ["move_by", "run"])
def test_what_ended_a_motion_between_two_looks_is_not_gone_on_with(
    bench: Bench, controller: TicController, begin: str, condition: str
) -> None:
    """Without safe start a Tic would do so by itself once it is over."""
    tic = bench.tic
    tic.disable_safe_start = True
    getattr(controller, begin)([AxisCommand(0, 1000, "value")])
    bench.pass_time(0.3)
    controller.status()
    tic.press(condition)
    bench.pass_time(0.05)
    tic.press(condition, False)
    bench.pass_time(0.05)
    assert (tic.state, tic.errors, tic.velocity > 0) == (NORMAL, 0, True)
    status = bench.rest()
    assert tic.told == (VELOCITY, 0)
    assert tic.position < 1000
    assert status.trouble == f"The Tic has stopped by itself: {WAS[condition]}"


@pytest.mark.parametrize("asked_after_s", [0.1 * tenths for tenths in range(1, 12)])
def test_a_motion_that_timed_out_while_it_was_asked_is_not_gone_on_with(
    bench: Bench, controller: TicController, asked_after_s: float
) -> None:
    """On a line so bad that each question takes a third of the timeout; without safe start."""
    tic = bench.tic
    tic.disable_safe_start = True
    controller.run(at(1000))
    bench.pass_time(asked_after_s)
    bench.lasts_s = 0.35
    for _ in range(4):
        status = controller.status()
    assert tic.told == (VELOCITY, 0)
    assert tic.velocity == 0
    assert status.trouble == ("The Tic has stopped by itself: it heard no command for longer than its command timeout.")


def test_errors_from_before_a_motion_have_not_ended_it(bench: Bench, controller: TicController) -> None:
    for condition in WAS:
        bench.tic.press(condition)
        bench.pass_time(0.05)
        bench.tic.press(condition, False)
    bench.pass_time(2)
    controller.move_by(by(1000))
    status = bench.rest()
    assert (bench.tic.position, status.trouble) == (1000, None)


@pytest.mark.parametrize("timeout_ms", [1, 999])
def test_a_command_timeout_too_short_to_be_kept_up_is_told(bench: Bench, timeout_ms: int) -> None:
    bench.tic.command_timeout_ms = timeout_ms
    bench.controller.connect()
    told = (
        f"The Tic can't move: its command timeout is {timeout_ms} ms, so it would stop before StepRamp speaks to it "
        "again; set it to at least 1,000 ms in the Tic Control Center."
    )
    assert bench.controller.status().trouble == told
    with pytest.raises(Refused, match=f"^{told}$"):
        bench.controller.move_by(by(5))
    assert bench.told() == []
    bench.tic.command_timeout_ms = 1000
    assert bench.controller.status().trouble is None
    bench.controller.move_by(by(5))
    assert bench.rest().axes[0].position_steps == 5


def test_a_motor_that_was_switched_off_on_purpose_is_switched_on_by_a_move_alone(
    bench: Bench, controller: TicController
) -> None:
    bench.tic.exchange(bytes([0x86]))
    controller.status()
    controller.stop()
    controller.set_position(to(7))
    assert not bench.tic.energized
    controller.move_to(to(9))
    assert bench.told()[-3:] == [0xE0, 0x85, 0x83]
    assert bench.rest().axes[0].position_steps == 9


@pytest.mark.parametrize("guarded", [True, False])
def test_an_old_target_is_never_set_out_for(bench: Bench, controller: TicController, guarded: bool) -> None:
    """Switched on, or out of safe start, a Tic heads for what it was told last: that must be the new target."""
    bench.lasts_s = 0.02
    bench.tic.exchange(TARGET_FAR_AWAY)
    bench.tic.exchange(bytes([0x86]))
    bench.tic.disable_safe_start = not guarded
    controller.move_to(to(-50))
    assert bench.rest().axes[0].position_steps == -50
    assert max(bench.way) == 0


def test_a_tic_that_stays_in_error_is_left_without_a_target(bench: Bench, controller: TicController) -> None:
    bench.tic.on_the_way_in = lambda data: b"" if data[:1] == b"\x83" else data
    with pytest.raises(Refused, match=r"^The Tic can't move: it stays in safe start\.$"):
        controller.move_by(by(500))
    bench.tic.on_the_way_in = lambda data: data
    assert bench.tic.told == (VELOCITY, 0)


def test_a_byte_without_a_stop_bit_ends_a_motion_and_is_told(bench: Bench, controller: TicController) -> None:
    controller.run(at(1000))
    bench.pass_time(0.3)
    bench.tic.frame_badly()
    trouble = bench.rest().trouble
    assert trouble == "The Tic has stopped by itself: bytes on its serial line were damaged or lost (serial error)."


def test_a_tic_that_was_restarted_is_lost(bench: Bench, controller: TicController) -> None:
    controller.move_by(by(100))
    bench.rest()
    bench.pass_time(1)
    bench.tic.power_up()
    with pytest.raises(DeviceLost, match="was restarted: its position is no longer known"):
        controller.status()


def test_a_tic_that_has_been_up_for_seven_weeks_is_not_lost(bench: Bench) -> None:
    bench.tic.has_been_up(2**32 / 1000 - 2)
    bench.controller.connect()
    for _ in range(20):
        bench.controller.status()
        bench.pass_time(POLL_S)
