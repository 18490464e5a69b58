"""Steep ramps of several fast axes, compressed as a push compresses them: the real firmware prepares them in time."""

from collections.abc import Callable
from pathlib import Path

import pytest

from designs import design
from firmware.rig import controller_in, move_by, play
from simulator.avr import SimulatedController, missing_tools
from stepramp.controllers.push import plan_push
from stepramp.controllers.settings import Settings
from stepramp.controllers.virtual import HELLO
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
    plan = plan_push([wanted] * axes, HELLO, Settings())
    assert plan.keeps_pace
    steps = int(1.5 * speed * seconds)
    played = play(make, plan.image.encode(), move_by(*[steps] * axes), move_by(*[-steps] * axes))
    played.assert_nothing_lost()
