"""What a controller with constant accelerations is given for a ramp whose acceleration falls with the speed.

A shape that limits its acceleration by the speed does so because the motor is weaker there: the largest acceleration
along it, held constant, would stall it. S-curve and cosine are gentler at their ends only, and keep their largest.
"""

import numpy as np
from numpy.typing import NDArray

from stepramp.design import Design, RampShape
from stepramp.errors import Rejected, Rejection
from stepramp.motor.limits import SUDDEN, greatest_acceleration
from stepramp.numerics.limit_text import highest
from stepramp.numerics.slope import Slope
from stepramp.ramp.slopes import full_slopes_of, playable_slopes_of
from stepramp.shapes.drawn import Drawn
from stepramp.shapes.torque import PLACES, TorqueShaped


def with_constant_rates(design: Design, path: str = "") -> Design:
    """Return a design with the largest constant accelerations that hold at every speed of its ramp; others as they are.

    Shaped by torque: that for which the margin of the torque does all along, up to the slew speed, and that may come at
    once. Drawn: the least from its largest on. path: what a rejection puts before the design's fields. Raises Rejected
    where there is none, as playable_slopes_of does.
    """
    if not isinstance(full_slopes_of(design)[0], TorqueShaped | Drawn):
        return design
    try:
        up, down = (_largest(design, slope) for slope in _whole_slopes(design))
    except Rejected as rejected:
        raise Rejected([each.within(path) for each in rejected.rejections], rejected.more) from None
    rates: dict[str, object] = {"acceleration_steps_per_s2": up, "shape": RampShape()}
    if design.ramp.deceleration_steps_per_s2 is not None:
        rates["deceleration_steps_per_s2"] = down
    return design.model_copy(update={"ramp": design.ramp.model_copy(update=rates)})


def _whole_slopes(design: Design) -> tuple[Slope, Slope]:
    """Return both slopes to the slew speed, whatever the move reaches. Raises Rejected as playable_slopes_of does."""
    any_move = design.move.model_copy(update={"plan": "any_move"})
    return playable_slopes_of(design.model_copy(update={"move": any_move}))


def _largest(design: Design, slope: Slope) -> float:
    speeds = np.linspace(slope.base_speed, slope.slew_speed, PLACES)
    if isinstance(slope, Drawn):
        drawn = slope.accelerations(_with_kinks(speeds, slope.kinks))
        return highest(float(drawn[drawn.argmax() :].min()))
    assert isinstance(slope, TorqueShaped)
    train = slope.parameters.drive_train
    assert train is not None  # a design without a motor has no such shape
    possible = float(slope.possible(_with_kinks(speeds, slope.kinks)).min())
    largest = min(possible, greatest_acceleration(train, SUDDEN), slope.acceleration)
    if largest <= 0:
        allowed = "a load that leaves torque for an acceleration that comes at once"
        raise Rejected([Rejection("load", design.load and design.load.model_dump(), allowed)])
    return highest(largest)


def _with_kinks(speeds: NDArray[np.float64], kinks: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return speeds along a slope with those between which it is smooth, increasing."""
    return np.unique(np.concatenate((speeds, np.clip(kinks, speeds[0], speeds[-1]))))
