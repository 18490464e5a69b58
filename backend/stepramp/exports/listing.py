"""A move as CSV, a design as JSON."""

import json

import numpy as np

from stepramp.design import Design
from stepramp.errors import Rejected, Rejection
from stepramp.ramp.profile import profile_of
from stepramp.units import us_from_ticks

COLUMNS = ("step", "interval_ticks", "interval_us", "time_s", "position_steps", "speed_steps_per_s")
MOST_LINES = 1_000_000
"""What spreadsheets still open; longer moves come from POST /profile."""


def csv(design: Design) -> str:
    """Return every step of the design's move, a line each; its numbers read back as those of the profile.

    Raises Rejected as profile_of does, and for moves of more than 1,000,000 steps.
    """
    steps = design.move.steps
    if abs(steps) > MOST_LINES:
        raise Rejected([Rejection("move.steps", steps, f"up to {MOST_LINES:,} steps in a CSV file")])
    profile = profile_of(design)
    columns = (
        np.arange(1, abs(steps) + 1),
        profile.intervals_ticks,
        us_from_ticks(1, profile.timer_hz) * profile.intervals_ticks,
        profile.time_s,
        profile.position_steps,
        profile.speed_steps_per_s,
    )
    lines = zip(*(column.tolist() for column in columns), strict=True)
    return "\n".join((",".join(COLUMNS), *(",".join(map(repr, line)) for line in lines), ""))


def document(design: Design) -> str:
    """Return the design as a JSON document."""
    return json.dumps(design.model_dump(mode="json", by_alias=True), indent=2, ensure_ascii=False) + "\n"
