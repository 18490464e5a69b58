"""Compiling before it is needed: the numerics are compiled when they first run, and kept for the next start."""

import time
from functools import cache

import numpy as np

from stepramp.design import Design
from stepramp.methods import METHODS, REFERENCE
from stepramp.ramp.error_curves import error_curves
from stepramp.ramp.motion import motion_of
from stepramp.ramp.profile import profile_of
from stepramp.ramp.segments import compress
from stepramp.ramp.thinning import kept_steps

TURN_S = 0.02

OTHER_SHAPES: tuple[dict[str, object], ...] = (
    {"name": "s_curve", "jerk_steps_per_s3": 10_000},
    {"name": "cosine"},
    {"name": "drawn", "points": [[0, 1], [200, 0.5]]},
)


@cache
def warm_up() -> None:
    """Run each method once in each of its arithmetics, the usual ones first, and the compression, on a small ramp.

    Then the shapes besides the usual one. All of it once a process.
    """
    small = _small()
    usual = [(name, method.arithmetics[0]) for name, method in METHODS.items()]
    rest = [(name, arithmetic) for name, method in METHODS.items() for arithmetic in method.arithmetics[1:]]
    for name, arithmetic in usual + rest:
        judged = error_curves(small.with_method(name, arithmetic), name, REFERENCE)
        _ = judged.relative_error, judged.peak_ramp_acceleration
        # One thing is compiled at a time: what a request needs goes before the next of these.
        time.sleep(TURN_S)
    for rounding in ("nearest", "carry"):
        cut = profile_of(_small(method={"rounding": rounding}, move={"steps": 30, "plan": "any_move"}))
        for most in (30, 10):
            kept_steps(cut.intervals_ticks, cut.phases, most)
    compress(np.array([2, 1]), 1)
    motion_of(np.array([2.0, 1.0]), 1.0, 0.0)
    for shape in OTHER_SHAPES:
        for name, arithmetic in usual + rest:
            if METHODS[name].shape is None and arithmetic != "fixed":
                _ = error_curves(_small(ramp={"shape": shape}).with_method(name, arithmetic), name, REFERENCE)
                time.sleep(TURN_S)


def _small(**own: dict[str, object]) -> Design:
    """Return a design of a small ramp, with fields of its parts that are its own."""
    ramp, move = own.get("ramp", {}), own.get("move", {})
    return Design.checked(
        {
            "schema": "stepramp/2",
            "timer": {"frequency_hz": 1_000_000},
            "ramp": {"slew_speed_steps_per_s": 200, "acceleration_steps_per_s2": 1000} | ramp,
            "table": {"rows": [[10, 5000]]},
            "move": {"steps": 100} | move,
            "method": own.get("method", {}),
        }
    )
