"""The ramp methods: each is a module here, and known by being here. `common/` has what several of them share."""

from importlib import import_module
from pkgutil import iter_modules

from stepramp.methods.common.method import RampMethod


def _found() -> dict[str, RampMethod]:
    modules = [import_module(f"{__name__}.{each.name}") for each in iter_modules(__path__) if not each.ispkg]
    named: dict[str, RampMethod] = {module.__name__.rpartition(".")[2]: module.METHOD for module in modules}
    return dict(sorted(named.items(), key=lambda each: each[1].place))


METHODS = _found()
"""By name, which is that of the module, in the order in which people are shown them."""

REFERENCE = "exact"
"""The method that others are compared with, unless another is asked for, and that a design has that names none."""
