"""StepRamp: interactive designer for stepper-motor acceleration ramps."""

from importlib.metadata import version

from stepramp.design import Design
from stepramp.errors import Rejected, StepRampError

__version__ = version("stepramp")

__all__ = ["Design", "Rejected", "StepRampError", "__version__"]
