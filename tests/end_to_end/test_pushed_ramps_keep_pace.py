"""Ramps of several axes, compressed as a push compresses them: the real firmware prepares them in time."""

from collections.abc import Callable
from pathlib import Path

import pytest

from designs import design
from firmware.rig import BusyClient, Work, controller_in, move_by, play, until_made
from simulator.avr import SimulatedController, missing_tools
from stepramp.controllers.stepramp.push import plan_push
from stepramp.controllers.stepramp.settings import StepRampSettings
from stepramp.controllers.virtual.controller import HELLO
from stepramp.design import Design
from stepramp.examples import all_examples
from tools import require

STEEPEST = [(4, 10_000, 0.1), (4, 29_000, 0.1), (2, 60_000, 0.025), (1, 29_000, 0.01), (1, 140_000, 0.05)]
"""Axes, slew speed [steps/s], time to reach it [s]: about the steepest of which no warning is given."""


@pytest.fixture
def make(tmp_path: Path) -> Callable[..., SimulatedController]:
    require(*missing_tools())

    def controller(**options: object) -> SimulatedController:
        return controller_in(tmp_path / "controller", **options)

    return controller


@pytest.mark.parametrize(("axes", "speed", "seconds"), STEEPEST)
def test_no_motor_waits(make: Callable[..., SimulatedController], axes: int, speed: float, seconds: float) -> None:
    wanted = design(
        timer__frequency_hz=16_000_000,
        ramp__slew_speed_steps_per_s=speed,
        ramp__acceleration_steps_per_s2=speed / seconds,
    )
    plan = plan_push([wanted] * axes, HELLO, StepRampSettings())
    assert plan.keeps_pace
    steps = int(1.5 * speed * seconds)
    played = play(make, plan.image.encode(), move_by(*[steps] * axes), move_by(*[-steps] * axes))
    played.assert_nothing_lost()


SHORTEST = [(1, 149_000, 1e9, 20_000), (1, 149_000, 1e9, 80_000), (1, 149_000, 1e9, 120_000), (4, 29_000, 1e8, 5000)]
"""Axes, slew speed [steps/s], acceleration [steps/s²] and base speed of ramps of 2 to 5 segments."""


@pytest.mark.parametrize(("axes", "speed", "acceleration", "base"), SHORTEST)
def test_no_motor_waits_on_a_ramp_of_a_few_steps(
    make: Callable[..., SimulatedController], axes: int, speed: float, acceleration: float, base: float
) -> None:
    """In moves that are over at once, too."""
    wanted = design(
        timer__frequency_hz=16_000_000,
        ramp__slew_speed_steps_per_s=speed,
        ramp__acceleration_steps_per_s2=acceleration,
        ramp__base_speed_steps_per_s=base,
    )
    plan = plan_push([wanted] * axes, HELLO, StepRampSettings())
    assert plan.keeps_pace
    moves = (move_by(*[steps] * axes) for steps in (2, 7, 15, 20, 25, 40, 3000))
    play(make, plan.image.encode(), *moves).assert_nothing_lost()


def extended(axes: int, steps: int, at_step: int) -> Work:
    """Return work: a move that becomes a little longer at a step."""
    begin, extend = (move_by(*[by] * axes) for by in (steps, 20))

    def work(client: BusyClient) -> None:
        begin(client)
        until_made(client, at_step)
        extend(client)

    return work


EVEN = design(
    timer__frequency_hz=16_000_000,
    ramp__slew_speed_steps_per_s=20_000,
    ramp__acceleration_steps_per_s2=100_000,
)
LASER_TABLE = Design.checked(next(each["design"] for each in all_examples() if each["title"] == "Laser-table axis"))
LATE = [(2, EVEN, 4200, range(2300, 4150, 150)), (4, LASER_TABLE, 1200, range(700, 1190, 40))]
"""Axes, design, steps, and at which of them the move is made longer: on the ramp down, from its begin to its end."""


@pytest.mark.parametrize(("axes", "wanted", "steps", "at_steps"), LATE, ids=["two axes", "four axes"])
def test_no_motor_waits_when_a_move_is_extended_while_it_slows_down(
    make: Callable[..., SimulatedController], axes: int, wanted: Design, steps: int, at_steps: range
) -> None:
    image = plan_push([wanted] * axes, HELLO, StepRampSettings()).image
    played = play(make, image.encode(), *(extended(axes, steps, at_step) for at_step in at_steps))
    played.assert_nothing_lost()
    assert {status.position for status in played.statuses} == {len(at_steps) * (steps + 20)}
