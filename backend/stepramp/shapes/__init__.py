"""The shapes of a ramp: how speed and time grow along it. Each is a module here, and known by being here."""

from stepramp.numerics.registered import modules_in
from stepramp.numerics.slope import Slope

SHAPES: dict[str, type[Slope]] = {name: module.SHAPE for name, module in modules_in(__name__, __path__).items()}
"""By name, which is that of the module."""

USUAL_SHAPE = "constant"
"""That of a design that names none."""
