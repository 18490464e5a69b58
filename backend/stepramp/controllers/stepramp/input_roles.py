"""What the inputs of a StepRamp controller are for: one byte each among its settings."""

from collections.abc import Iterable
from typing import Literal, Self

from pydantic import Field, StrictBool, model_validator

from stepramp.controllers.axes import MOST_AXES, AxisNumber
from stepramp.controllers.inputs import End, InputStatus, Level, LimitStop, RoleName
from stepramp.errors import Rejected, Rejection
from stepramp.validation import Document, refuse

InputName = Literal["A0", "A1", "A2", "A3", "A4", "A5", "D9", "D10", "D11"]
INPUTS: tuple[InputName, ...] = ("A0", "A1", "A2", "A3", "A4", "A5", "D9", "D10", "D11")
"""By their numbers."""
EMERGENCY_INPUTS, GAUGE_INPUTS = INPUTS[:6], INPUTS[6:]
"""Those that can be an emergency stop, and those whose pins are a gauge's with gauge outputs."""
_ROLE_BITS, _AT_ONCE, _ACTIVE_HIGH, _WITHOUT_PULL_UP = 0x1F, 0x20, 0x40, 0x80
_ALONE: dict[int, RoleName] = {1: "emergency_stop", 2: "driver_fault"}
_LOW_LIMIT, _HIGH_LIMIT = 8, 12


class InputRole(Document):
    """What one input is for."""

    input: InputName = Field(description="Which, as it is named on the board; one that is not named here is left alone")
    role: RoleName = Field(
        description="emergency_stop: all axes halt at once, and nothing moves until that is acknowledged; only at A0 "
        "to A5. driver_fault: the same, a little later. limit: the switch at an end of an axis, which stops it there"
    )
    active: Level = Field(
        "low", description="Level at which it is active. high, for switches that open, also stops when a wire breaks"
    )
    pull_up: StrictBool = Field(True, description="Whether the controller's own pull-up is on")
    axis: AxisNumber | None = Field(None, description="Of a limit: which axis, from 0; null for other roles")
    end: End | None = Field(
        None, description="Of a limit: at which end, low stops it while it moves backwards; null for other roles"
    )
    stops: LimitStop | None = Field(
        None, description="Of a limit: how it stops, with the ramp, also when null, or at once; null for other roles"
    )

    @model_validator(mode="before")
    @classmethod
    def _with_the_ramp(cls, document: object) -> object:
        """Let a limit stop with the ramp when nothing else is said."""
        is_usual = isinstance(document, dict) and document.get("role") == "limit" and document.get("stops") is None
        return {**document, "stops": "ramp"} if is_usual and isinstance(document, dict) else document

    @model_validator(mode="after")
    def _fits(self) -> Self:
        if self.role == "emergency_stop" and self.input not in EMERGENCY_INPUTS:
            refuse("input", self.input, f"for an emergency stop one of {', '.join(EMERGENCY_INPUTS)}")
        if self.role != "limit":
            for name in ("axis", "end", "stops"):
                if getattr(self, name) is not None:
                    refuse(name, getattr(self, name), f"null, since {self.role} stops all axes, and at once")
        elif self.axis is None:
            refuse("axis", None, f"of a limit, a whole number from 0 to {MOST_AXES - 1}")
        elif self.end is None:
            refuse("end", None, "of a limit, low or high")
        return self

    def pack(self) -> int:
        """Return the role as its byte."""
        number = next((number for number, name in _ALONE.items() if name == self.role), 0)
        if self.axis is not None:
            number = (_LOW_LIMIT if self.end == "low" else _HIGH_LIMIT) + self.axis
        at_once = _AT_ONCE if self.stops == "at_once" else 0
        active_high = _ACTIVE_HIGH if self.active == "high" else 0
        return number | at_once | active_high | (0 if self.pull_up else _WITHOUT_PULL_UP)

    def status(self, *, is_active: bool) -> InputStatus:
        """Return what a status says of it."""
        return InputStatus(self.input, self.role, is_active, self.active, self.pull_up, self.axis, self.end, self.stops)


def unpacked_roles(packed: bytes) -> tuple[InputRole, ...]:
    """Return what inputs are for, by their bytes; Rejected for a byte that isn't a role of its input."""
    return tuple(_unpacked(number, byte) for number, byte in enumerate(packed) if byte)


def is_emergency_stop(byte: int) -> bool:
    """Tell whether a role's byte makes its input an emergency stop."""
    return _ALONE.get(byte & _ROLE_BITS) == "emergency_stop"


def packed_roles(roles: Iterable[InputRole]) -> bytes:
    """Return the bytes of all inputs; of those without a role 0."""
    by_name = {role.input: role.pack() for role in roles}
    return bytes(by_name.get(name, 0) for name in INPUTS)


def _unpacked(number: int, byte: int) -> InputRole:
    code, name = byte & _ROLE_BITS, INPUTS[number]
    common = {
        "input": name,
        "active": "high" if byte & _ACTIVE_HIGH else "low",
        "pull_up": not byte & _WITHOUT_PULL_UP,
    }
    if _LOW_LIMIT <= code < _HIGH_LIMIT + MOST_AXES:
        end, axis = ("high", code - _HIGH_LIMIT) if code >= _HIGH_LIMIT else ("low", code - _LOW_LIMIT)
        stops = "at_once" if byte & _AT_ONCE else "ramp"
        return InputRole.checked({**common, "role": "limit", "axis": axis, "end": end, "stops": stops})
    is_good = code in _ALONE and not byte & _AT_ONCE and (code != 1 or name in EMERGENCY_INPUTS)
    if not is_good:
        raise Rejected([Rejection(f"inputs.{number}", byte, f"the byte of a role that {name} can have")])
    return InputRole.checked({**common, "role": _ALONE[code]})
