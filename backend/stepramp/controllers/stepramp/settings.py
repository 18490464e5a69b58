"""Settings: what the drivers of the motors want of a controller's pins. Kept next to its ramps."""

import struct
from typing import Annotated, Literal, Self

from pydantic import AfterValidator, Field, StrictBool

from stepramp.controllers.axes import AxisNumbers
from stepramp.controllers.inputs import Level
from stepramp.controllers.stepramp.input_roles import INPUTS, InputRole, packed_roles, unpacked_roles
from stepramp.controllers.stepramp.messages.axes import axes_of, mask_of
from stepramp.controllers.stepramp.messages.settings import SETTINGS_BYTES
from stepramp.controllers.stepramp.soft_limits import SoftLimits, packed_limits, unpacked_limits
from stepramp.validation import Document, ListOrNull, Within, refuse

Outputs = Literal["step_and_direction", "gauges"]
OUTPUTS: tuple[Outputs, ...] = ("step_and_direction", "gauges")
LEVELS: tuple[Level, ...] = ("low", "high")
MOST_GAUGES = 3
HOLD_FOR_EVER = 0xFFFF
_LAYOUT = struct.Struct("<6B3H")
SILENCE_STEP_S = 0.256
LEAST_SILENCE, MOST_SILENCE = 2, 200
"""In such steps."""
USUAL_OF_INPUTS = bytes([4, 0, 4, *bytes(len(INPUTS))])
"""What follows the 12 bytes when nothing is stored, of a controller with inputs."""
OF_INPUTS = ("silence_s", "silence_ends_moves", "looks", "inputs")
"""Settings that only a controller with inputs has."""
_ROLES = 3
"""Where the roles begin, after the 12 bytes."""


def _whole_steps(silence_s: float | None) -> float | None:
    """Return the silence that is taken for one [s]."""
    return None if silence_s is None else _silence_s(round(silence_s / SILENCE_STEP_S))


def _silence_s(steps: int) -> float:
    return round(steps * SILENCE_STEP_S, 3)


def _in_order(roles: tuple[InputRole, ...] | None) -> tuple[InputRole, ...] | None:
    if roles is None:
        return None
    named = [role.input for role in roles]
    for number, name in enumerate(named):
        if name in named[:number]:
            refuse(f"{number}.input", name, "each input once")
    return tuple(sorted(roles, key=lambda role: INPUTS.index(role.input)))


Silence = Annotated[
    float, Within(_silence_s(LEAST_SILENCE), _silence_s(MOST_SILENCE), "s", ", or null: it stays as it is")
]
Looks = Annotated[int, Within(1, 10, "", ", or null: it stays as it is")]
Roles = Annotated[
    tuple[InputRole, ...] | None,
    ListOrNull("inputs and what they are for", most=len(INPUTS)),
    AfterValidator(_in_order),
]


class StepRampSettings(Document):
    """How a controller drives its pins. A controller without any stored has these defaults.

    What only those with inputs have is null for the others; null for one with inputs lets it stay as it is.
    """

    outputs: Outputs = Field(
        "step_and_direction",
        description="step_and_direction: a step and a direction pin for each axis. gauges: four coil pins for each of "
        "three gauges",
    )
    both_edges: AxisNumbers = Field((), description="Axes with a step at each edge of the step pin, not only one")
    step_inverted: AxisNumbers = Field((), description="Axes whose step pin rests high")
    direction_inverted: AxisNumbers = Field((), description="Axes whose direction pin is low for forwards")
    enable_level: Level = Field("low", description="Level of the enable pin while motors are on")
    pulse_width_us: Annotated[int, Within(0, 100, "µs")] = Field(
        0,
        description="Least width of a step pulse; 0: as short as the controller makes it. A step takes twice as much "
        "of the controller's time: with wide pulses the fastest speeds are out of reach [µs]",
    )
    direction_setup_us: Annotated[int, Within(20, 15_000, "µs")] = Field(
        30, description="Time from a change of direction to the next pulse [µs]"
    )
    enable_lead_ms: Annotated[int, Within(0, 1000, "ms")] = Field(
        1, description="Time from switching the motors on to the first pulse [ms]"
    )
    enable_hold_ms: Annotated[int, Within(0, HOLD_FOR_EVER - 1, "ms", ", or null: they stay on")] | None = Field(
        None, description="Time from the rest of the last motor to switching them off; null: they stay on [ms]"
    )

    silence_s: Annotated[Silence | None, AfterValidator(_whole_steps)] = Field(
        None,
        description="Axes that run at a speed, or are homed, slow down when nobody has asked anything for so long, or "
        "0.256 s more. It is taken in steps of 0.256 s, the nearest; the answer tells which. null: it stays as it is; "
        "in an answer, the controller has no such setting [s]",
    )
    silence_ends_moves: StrictBool | None = Field(
        None, description="Whether such a silence ends moves and lines, too; null as in silence_s"
    )
    looks: Looks | None = Field(
        None,
        description="An input counts as changed once it was found so in so many looks in a row, which are 1 ms apart, "
        "those at an emergency stop 4 µs; null as in silence_s",
    )
    inputs: Roles = Field(
        None,
        description="What inputs are for; those that aren't named are left alone. null: all stay as they are, or there "
        "are none. With gauge outputs D9 to D11 are a gauge's",
    )
    soft_limits: SoftLimits = Field(
        None,
        description="How far the controller lets axes go, whoever asks, as long as their positions are known; axes "
        "that aren't named have no limits. null: all stay as they are; in an answer, the controller keeps none",
    )

    @property
    def given_of_inputs(self) -> list[str]:
        """The names of the settings that are given of those that only controllers with inputs have."""
        return [name for name in OF_INPUTS if getattr(self, name) is not None]

    def pack(self, before: bytes = b"") -> bytes:
        """Return the settings as they travel and are stored.

        before: those in use; of them everything stays that isn't given, and that isn't known. Without any, only what
        every controller has is packed.
        """
        return self._packed_outputs() + self._packed_inputs(before[SETTINGS_BYTES:])

    def pack_limits(self, before: bytes) -> bytes:
        """Return the soft limits of all axes as they are stored; before: those in use, which stay if none are given."""
        return before if self.soft_limits is None else packed_limits(self.soft_limits)

    def _packed_inputs(self, before: bytes) -> bytes:
        packed = bytearray(before)
        if not packed:
            return b""
        if self.silence_s is not None:
            packed[0] = round(self.silence_s / SILENCE_STEP_S)
        if self.silence_ends_moves is not None:
            packed[1] = int(self.silence_ends_moves)
        if self.looks is not None:
            packed[2] = self.looks
        if self.inputs is not None:
            there = packed[_ROLES : _ROLES + len(INPUTS)]
            packed[_ROLES : _ROLES + len(INPUTS)] = packed_roles(self.inputs)[: len(there)]
        return bytes(packed)

    def _packed_outputs(self) -> bytes:
        return _LAYOUT.pack(
            OUTPUTS.index(self.outputs),
            mask_of(self.both_edges),
            mask_of(self.step_inverted),
            mask_of(self.direction_inverted),
            LEVELS.index(self.enable_level),
            self.pulse_width_us,
            self.direction_setup_us,
            self.enable_lead_ms,
            HOLD_FOR_EVER if self.enable_hold_ms is None else self.enable_hold_ms,
        )

    @classmethod
    def unpack(cls, packed: bytes, limits: bytes = b"") -> Self:
        """Return packed settings, and soft limits where there are any.

        Raises Rejected when one is out of its range, ValueError when bytes are missing.
        """
        if len(packed) < SETTINGS_BYTES or SETTINGS_BYTES < len(packed) < SETTINGS_BYTES + _ROLES:
            raise ValueError(f"Settings of {len(packed)} bytes; allowed: {SETTINGS_BYTES}, or 24 and more.")
        outputs, both_edges, step, direction, enable, *times, hold = _LAYOUT.unpack_from(packed)
        return cls.checked(
            {
                "outputs": OUTPUTS[outputs] if outputs < len(OUTPUTS) else outputs,
                "both_edges": axes_of(both_edges),
                "step_inverted": axes_of(step),
                "direction_inverted": axes_of(direction),
                "enable_level": LEVELS[enable] if enable < len(LEVELS) else enable,
                **dict(zip(("pulse_width_us", "direction_setup_us", "enable_lead_ms"), times, strict=True)),
                "enable_hold_ms": None if hold == HOLD_FOR_EVER else hold,
                **_of_inputs(packed[SETTINGS_BYTES:]),
                "soft_limits": unpacked_limits(limits) if limits else None,
            }
        )


def _of_inputs(packed: bytes) -> dict[str, object]:
    """Return the settings that only a controller with inputs has, from the bytes after the others; {} without."""
    if not packed:
        return {}
    silence, ends_moves, looks = packed[:_ROLES]
    return {
        "silence_s": _silence_s(silence),
        "silence_ends_moves": bool(ends_moves) if ends_moves in (0, 1) else ends_moves,
        "looks": looks,
        "inputs": unpacked_roles(packed[_ROLES : _ROLES + len(INPUTS)]),
    }


OFFSETS = dict(zip(StepRampSettings.model_fields, (0, 1, 2, 3, 4, 5, 6, 8, 10, 12, 13, 14, 15), strict=False))
"""Where each setting lies when packed [bytes]."""
