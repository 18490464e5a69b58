"""The ramp methods: each is a module here, and known by being here. `common/` has what several of them share."""

from stepramp.methods.common.method import RampMethod
from stepramp.numerics.registered import modules_in

_FOUND: dict[str, RampMethod] = {name: module.METHOD for name, module in modules_in(__name__, __path__).items()}

METHODS = dict(sorted(_FOUND.items(), key=lambda each: each[1].rank))
"""By name, which is that of the module, in the order in which people are shown them."""

REFERENCE = "exact"
"""The method that others are compared with, unless another is asked for, and that a design has that names none."""
