"""Which modules there are, and how each numbers what an axis has: one table a module.

Numbers from the sections "Axis parameters" of the modules' TMCL firmware manuals.
"""

from dataclasses import dataclass

from stepramp.errors import Refused

CLOCK_HZ = 16_000_000
"""Of the chip that makes the ramps, on all of these modules."""


@dataclass(frozen=True)
class Parameters:
    """The numbers of axis parameters."""

    target_position: int = 0
    position: int = 1
    target_speed: int = 2
    speed: int = 3
    vmax: int = 4
    amax: int = 5
    a1: int = 15
    v1: int = 16
    dmax: int = 17
    d1: int = 18
    vstart: int = 19
    vstop: int = 20
    resolution: int = 140
    """Microsteps a full step, as a power of 2."""
    unit_mode: int = 255
    """In what units speeds and accelerations are: those of the chip, or microsteps."""
    settings: tuple[int, ...] = ()
    """All that are stored; no reading of them changes anything."""

    def of(self, name: str) -> int:
        """Return the number of a figure of a ramp, by its name."""
        number: int = getattr(self, name)
        return number


_STORED = (
    *(4, 5, 6, 7, 12, 13, 14, *range(15, 29), 31, 32, 33, 127, 140, *range(162, 175), 181, 182, 184, 186, 187, 188),
    *(190, 191, 192, 193, 194, 195, 202, 204, 210, 212, 214, 255),
)
"""Settings that all of these modules store, by number."""


def _parameters(*more: int) -> Parameters:
    """Return the table of a module that stores some settings more."""
    return Parameters(settings=tuple(sorted((*_STORED, *more))))


@dataclass(frozen=True)
class Module:
    """A kind of module."""

    number: int
    """What it tells of itself."""
    axes: int
    parameters: Parameters
    clock_hz: int = CLOCK_HZ

    @property
    def name(self) -> str:
        """What people call it."""
        return f"TMCM-{self.number}"


MODULES = {
    each.number: each
    for each in (
        Module(1240, 1, _parameters(160, 161, 178, 217, 218, 251, 254)),
        Module(1241, 1, _parameters(160, 161, 178, 217, 218, 251, 254)),
        Module(1260, 1, _parameters(160, 161, 178, 217, 218, 251, 254)),
        Module(1270, 1, _parameters(177, 179, 201)),
        Module(1276, 1, _parameters(177, 201)),
        Module(1278, 1, _parameters(177, 201)),
        Module(6212, 6, _parameters(201, 251)),
        Module(6214, 6, _parameters(40, 41, 42, 43, 177, 179, 201, 240, 251)),
    )
}
"""Modules with a chip of the TMC5160's kind, which has ramps of six points, by what they tell of themselves."""


def module_of(number: int, port_name: str) -> Module:
    """Return a module by its number; Refused for one without a table here."""
    if number not in MODULES:
        known = ", ".join(str(each) for each in MODULES)
        raise Refused(
            f"At {port_name} is a TMCM-{number}, whose parameters StepRamp doesn't know: nothing was sent to it. "
            f"It knows TMCM-{known}."
        )
    return MODULES[number]
