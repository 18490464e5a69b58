"""Targets and speeds that change in flight: what POST /retarget says, and what the real firmware's pins do."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from designs import design
from firmware.checker import CYCLES_PER_S
from firmware.protocol import MOVE_TO, RUN, for_axes
from firmware.rig import BusyClient, Work, controller_in, play, until_made
from simulator.avr import SimulatedController, missing_tools
from stepramp.controllers.stepramp.push import plan_push
from stepramp.controllers.stepramp.settings import StepRampSettings
from stepramp.controllers.virtual.controller import HELLO
from stepramp.design import Design
from stepramp.ramp.retarget import Command, PlayedSteps, played_towards
from tools import require

TOLERANCE_S = 2e-6
HZ = 2_000_000
SETTINGS = StepRampSettings()
LOOKED_BACK = 40
"""Steps. What was queued 8 ms ahead is made first, and what comes of a command may show only later."""
LONGEST_TURN_S = 0.005
SHAPES: dict[str, dict[str, Any]] = {
    "constant": {"name": "constant"},
    "S-curve": {"name": "s_curve", "jerk_steps_per_s3": 200_000, "deceleration_jerk_steps_per_s3": 500_000},
    "drawn": {"name": "drawn", "points": [[0, 0.6], [1000, 1], [4000, 0.2]]},
}

Told = tuple[int, str, int]
"""After how many steps at least, and a target [steps], or a speed by its interval [ticks], negative backwards."""
FLIGHTS: dict[str, list[Told]] = {
    "farther, then nearer": [(0, "to", 1500), (300, "to", 3000), (1200, "to", 2500)],
    "on the ramp up, too close": [(0, "to", 2500), (20, "to", 30)],
    "back while it slows down": [(0, "to", 1200), (1160, "to", -700)],
    "slower, faster, the other way, home": [
        (0, "at", 1600),
        (150, "at", 4000),
        (400, "at", 1000),
        (1200, "at", -1800),
        (2000, "to", 0),
    ],
}


@pytest.fixture
def make(tmp_path: Path) -> Callable[..., SimulatedController]:
    require(*missing_tools())
    return lambda **options: controller_in(tmp_path / "controller", **options)


def told(flight: list[Told]) -> Work:
    """Return work: tell the motor one thing after another while it moves."""

    def work(client: BusyClient) -> None:
        for steps, what, value in flight:
            if steps:
                until_made(client, steps)
            client.expect_ok(MOVE_TO if what == "to" else RUN, for_axes({0: value}))

    return work


def command(at_s: float, what: str, value: int) -> Command:
    return Command(at_s, value) if what == "to" else Command(at_s, speed_steps_per_s=HZ / value)


def predicted(asked: Design, commands: list[Command]) -> PlayedSteps:
    """Return what is played of commands; of a run, until it is ended much later."""
    is_run = commands[-1].speed_steps_per_s
    end = [Command(commands[-1].at_s + 5, speed_steps_per_s=0)] if is_run else []
    return played_towards(asked, [*commands, *end], SETTINGS.direction_setup_us)


def agreeing(made: NDArray[np.float64], played: PlayedSteps) -> int:
    """Return how many intervals are as predicted, from the first on [s].

    At a turn the firmware sets the direction once its queue has run empty, which it looks for every millisecond: such
    an interval is as long as the predicted one, or longer.
    """
    expected = np.diff(played.at_ticks)[: made.size] / HZ
    late = made[: expected.size] - expected
    turns = np.diff(played.direction)[: expected.size] != 0
    right = np.where(turns, (late >= -TOLERANCE_S) & (late < LONGEST_TURN_S), np.abs(late) <= TOLERANCE_S)
    return int(right.size if right.all() else (~right).argmax())


def explained(asked: Design, made: NDArray[np.float64], flight: list[Told]) -> PlayedSteps:
    """Return the prediction that agrees the longest: after which pulse the firmware took each command isn't known."""
    commands = [command(0, *flight[0][1:])]
    played = predicted(asked, commands)
    for steps, what, value in flight[1:]:
        first = agreeing(made, played)
        pulses = played.at_ticks[max(steps - 1, first - LOOKED_BACK) : first + 2]
        candidates = [[*commands, command(float(at) / HZ, what, value)] for at in pulses]
        commands = max(candidates, key=lambda each: agreeing(made, predicted(asked, each)))
        played = predicted(asked, commands)
    return played


@pytest.mark.parametrize("flight", FLIGHTS.values(), ids=FLIGHTS)
@pytest.mark.parametrize("shape", SHAPES.values(), ids=SHAPES)
def test_every_edge_comes_when_the_prediction_says(
    make: Callable[..., SimulatedController], shape: dict[str, Any], flight: list[Told], record_property: Any
) -> None:
    asked = design(
        schema="stepramp/2",
        timer__frequency_hz=HZ,
        ramp__slew_speed_steps_per_s=2000,
        ramp__acceleration_steps_per_s2=20_000,
        ramp__deceleration_steps_per_s2=30_000,
        ramp__shape=shape,
        move={"steps": 6000, "plan": "any_move"},
    )
    pushed = plan_push([asked], HELLO, SETTINGS)
    # Compressed with a change of its intervals, the ramp would be gone on with a step earlier or later, now and then.
    assert pushed.bounds_ticks == (0,)
    played = play(make, pushed.image.encode(), told(flight))
    played.assert_nothing_lost()
    assert played.statuses[0].position == flight[-1][2]
    edges = played.axis()
    made = np.diff(edges.steps) / CYCLES_PER_S
    prediction = explained(asked, made, flight)
    assert prediction.at_ticks.size == edges.steps.size
    assert np.array_equal(prediction.direction > 0, edges.forward)
    assert agreeing(made, prediction) == made.size
    straight = np.diff(prediction.direction) == 0
    largest = np.abs(made - np.diff(prediction.at_ticks) / HZ)[straight].max()
    record_property("largest_deviation_us", float(largest) * 1e6)
    print(f"\n{shape['name']}: the largest deviation of an interval is {largest * 1e6:.3f} µs")
