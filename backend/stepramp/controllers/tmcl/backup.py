"""A backup of a module: its stored settings, as lines, and what of that makes sense again."""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from stepramp.controllers.tmcl.axis import Axis
from stepramp.controllers.tmcl.conversation import Denied
from stepramp.controllers.tmcl.modules import MODULES, Module
from stepramp.controllers.tmcl.ramp import TmclRamp
from stepramp.controllers.tmcl.units import UnitMode, Units
from stepramp.errors import Count, Rejected, Rejection

_MODULE = re.compile(r"module TMCM-(?P<number>\d{1,5})")
_SETTING = re.compile(r"axis (?P<axis>\d) parameter (?P<parameter>\d{1,3}) = (?P<value>-?\d{1,10})")
ALLOWED = "a backup of a TMCL module: a line 'module TMCM-…', and lines 'axis … parameter … = …'"


@dataclass(frozen=True)
class Backup:
    """The settings of a module, by axis and number."""

    module: Module
    settings: dict[int, dict[int, int]]
    twice: Mapping[str, str] = field(default_factory=dict)
    """What is told more than once, with different values, by what it is: the last is in settings."""

    @classmethod
    def of(cls, text: str) -> "Backup | None":
        """Return what a text tells; None for one that is no backup of a module that is known."""
        lines = [line.strip() for line in text.splitlines()]
        modules = [int(found["number"]) for found in map(_MODULE.fullmatch, lines) if found is not None]
        if len(modules) != 1 or modules[0] not in MODULES:
            return None
        module, settings = MODULES[modules[0]], dict[int, dict[int, int]]()
        told: dict[str, dict[int, None]] = {}
        for found in filter(None, map(_SETTING.fullmatch, lines)):
            axis, parameter, value = int(found["axis"]), int(found["parameter"]), int(found["value"])
            if axis < module.axes and parameter in module.parameters.settings and -(2**31) <= value < 2**31:
                settings.setdefault(axis, {})[parameter] = value
                told.setdefault(f"axis {axis} parameter {parameter}", {})[value] = None
        twice = {name: " and ".join(map(str, values)) for name, values in told.items() if len(values) > 1}
        return cls(module, settings, twice) if settings else None

    @classmethod
    def sound(cls, text: str, module: Module) -> "Backup":
        """Return what can be written to a module; Rejected for that of another one, and for ramps that never end."""
        backup = cls.of(text)
        if backup is None or backup.module != module:
            raise Rejected(
                [Rejection("text", Count(f"{len(text.splitlines())} lines"), f"{ALLOWED}, of a {module.name}")]
            )
        bad = [Rejection(name, Count(told), "each parameter once in a backup") for name, told in backup.twice.items()]
        for axis in backup.settings:
            if (lack := backup.lack(axis)) is not None:
                bad.append(Rejection(f"axis {axis}", lack, "a ramp that moves can be made with"))
        if bad:
            raise Rejected(bad)
        return backup

    def lack(self, axis: int) -> str | None:
        """Return what keeps an axis from being moved with these settings; None for nothing."""
        ramp, units = self.ramp(axis), self.units(axis)
        if ramp is None or units is None:
            return "no whole ramp, or none in units that are known"
        return ramp.lacks() or ("the acceleration of a halt" if ramp.is_of_a_halt(units) else None)

    def ramp(self, axis: int) -> TmclRamp | None:
        """Return the ramp of an axis; None where a figure of it is missing."""
        settings, number = self.settings[axis], self.module.parameters.of
        figures = {each.name: settings.get(number(each.name)) for each in TmclRamp.figures()}
        known = {name: value for name, value in figures.items() if value is not None}
        return TmclRamp(**known) if len(known) == len(figures) else None

    def units(self, axis: int) -> Units | None:
        """Return the units of an axis; None where they aren't told."""
        mode = self.settings[axis].get(self.module.parameters.unit_mode)
        return Units(UnitMode(mode), self.module.clock_hz) if mode in set(UnitMode) else None


def lines_of(module: Module, version: str, axes: Sequence[Axis]) -> Iterator[str]:
    """Ask for every setting that is stored, and yield what a backup says; what a firmware hasn't is left out."""
    yield f"module {module.name}"
    yield f"firmware {version}"
    for axis in axes:
        for parameter in module.parameters.settings:
            try:
                yield f"axis {axis.number} parameter {parameter} = {axis.get(parameter)}"
            except Denied:
                continue
