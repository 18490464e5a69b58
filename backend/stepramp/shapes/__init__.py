"""The shapes of a ramp: how speed and time grow along it. Each is a module here, and known by being here.

`common/` has what several of them share.
"""

from stepramp.numerics.registered import modules_in
from stepramp.numerics.slope import Slope

_FOUND: dict[str, type[Slope]] = {name: module.SHAPE for name, module in modules_in(__name__, __path__).items()}

SHAPES = dict(sorted(_FOUND.items(), key=lambda each: each[1].rank))
"""By name, which is that of the module, in the order in which people are shown them."""

USUAL_SHAPE = "constant"
"""That of a design that names none."""
