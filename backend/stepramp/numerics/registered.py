"""Things that are registered by being there: the modules of a folder."""

from collections.abc import Iterable
from importlib import import_module
from pkgutil import iter_modules
from types import ModuleType


def modules_in(package: str, path: Iterable[str]) -> dict[str, ModuleType]:
    """Return the modules of a package by name; path: its `__path__`. Packages within it are left out."""
    names = [each.name for each in iter_modules(path) if not each.ispkg]
    return {name: import_module(f"{package}.{name}") for name in names}
