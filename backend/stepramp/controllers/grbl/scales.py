"""Steps per mm that a push was made with, and those that a controller has: others may set them in between."""

from collections.abc import Mapping

import numpy as np

from stepramp.controllers.grbl.settings import Known
from stepramp.errors import Refused


def other_scales(planned: Mapping[int, np.float32], present: Known) -> list[str]:
    """Return which steps per mm of axes are others than planned, in words."""
    found = []
    for axis, planned_per_mm in planned.items():
        there = present.axis(axis)
        if there is None:
            found.append(f"{present.scale_name(axis)} was {float(planned_per_mm):,.7g} and makes no sense now")
        elif there.steps_per_mm != planned_per_mm:
            figures = f"was {float(planned_per_mm):,.7g} and is {float(there.steps_per_mm):,.7g} now"
            found.append(f"{present.scale_name(axis)} {figures}")
    return found


def unlike_words(others: list[str]) -> list[str]:
    """Return what comes of it when there are any once all was written, as sentences."""
    return [f"{', '.join(others)}: what was sent was worked out with the former."] if others else []


def refuse_others(others: list[str]) -> None:
    """Refused where there are any, before anything is written: speeds would be others than asked for."""
    if others:
        raise Refused(
            f"{', '.join(others)}: what was to be sent was worked out with the former. Nothing was written: push again."
        )
