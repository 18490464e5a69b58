"""StepRamp: interactive designer for stepper-motor acceleration ramps.

>>> import stepramp
>>> design = stepramp.Design(
...     timer={"frequency_hz": 2_000_000},
...     ramp={"slew_speed_steps_per_s": 1000, "acceleration_steps_per_s2": 5000},
...     move={"steps": 500},
... )
>>> profile = design.profile()
>>> profile.intervals_ticks[:3]
array([20000, 14142, 11547])
>>> profile.duration_s
0.671791
"""

from typing import TYPE_CHECKING, Any

from stepramp.errors import Rejected, StepRampError

if TYPE_CHECKING:
    from stepramp.notebook import MOTORS, Design, PlannedMove, PlayedMove
    from stepramp.version import __version__

__all__ = ["MOTORS", "Design", "PlannedMove", "PlayedMove", "Rejected", "StepRampError", "__version__"]


def __getattr__(name: str) -> Any:
    """Load the numerics, and even the version, when they are first asked for: a stop does without them."""
    if name == "__version__":
        from stepramp import version  # noqa: PLC0415  # loading it here is the purpose

        return version.__version__
    if name in ("MOTORS", "Design", "PlannedMove", "PlayedMove"):
        from stepramp import notebook  # noqa: PLC0415  # loading it here is the purpose

        return getattr(notebook, name)
    raise AttributeError(f"module 'stepramp' has no attribute {name!r}")
