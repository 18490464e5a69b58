"""What a ramp asks of its motor, at a glance: from its slopes at a few places, without planning the move."""

import numpy as np

from stepramp.design import Design
from stepramp.motor.limits import required_nm
from stepramp.motor.torque import drive_train
from stepramp.numerics.slope import Slope
from stepramp.ramp.slopes import playable_slopes_of

PLACES = 48
"""So many of a slope are looked at, evenly in time of constant acceleration."""


def reached_speed(slopes: tuple[Slope, Slope], steps: int) -> float:
    """Return the fastest that a move gets along slopes up and down [steps/s].

    Of a move that is cut each takes its part of the steps: exact where both have constant acceleration, or are alike.
    """
    up, down = slopes
    whole = up.length + down.length
    if whole <= steps:
        return up.slew_speed
    return min(up.slew_speed, float(up.speeds((steps + 1) * up.length / whole, 1, np.float64)[0]))


def share_asked(design: Design) -> float:
    """Return about the largest part of the pull-out torque that a design's ramp asks for; infinite: there is none.

    Raises Rejected as playable_slopes_of does, and without a motor.
    """
    train, slopes = drive_train(design), playable_slopes_of(design)
    reached = reached_speed(slopes, abs(design.move.steps))
    speeds, accelerations = [np.array([reached])], [np.zeros(1)]
    for slope, sign in zip(slopes, (1, -1), strict=True):
        last = slope.steps - 1
        if last < 0:
            continue
        places = np.unique(np.floor(last * np.linspace(0, 1, PLACES) ** 2))
        pairs = np.array([slope.speeds(place, 2, np.float64) for place in places])
        is_played = pairs[:, 1] <= reached
        speeds.append(pairs[is_played].mean(axis=1))
        accelerations.append(sign * (pairs[is_played, 1] ** 2 - pairs[is_played, 0] ** 2) / 2)
    at = np.concatenate(speeds)
    available = train.pull_out_nm(at * train.radians_per_step)
    asked = required_nm(train, np.concatenate(accelerations))
    shares = np.divide(asked, available, out=np.full(at.shape, np.inf), where=available > 0)
    return float(shares.max())
