"""Settings: what the drivers of the motors want of a controller's pins. Kept next to its ramps."""

import struct
from typing import Annotated, Literal, Self

from pydantic import Field

from stepramp.controllers.axes import AxisNumbers
from stepramp.controllers.stepramp.messages.axes import axes_of, mask_of
from stepramp.controllers.stepramp.messages.settings import SETTINGS_BYTES
from stepramp.validation import Document, Within

Outputs = Literal["step_and_direction", "gauges"]
OUTPUTS: tuple[Outputs, ...] = ("step_and_direction", "gauges")
Level = Literal["low", "high"]
LEVELS: tuple[Level, ...] = ("low", "high")
MOST_GAUGES = 3
HOLD_FOR_EVER = 0xFFFF
_LAYOUT = struct.Struct("<6B3H")


class StepRampSettings(Document):
    """How a controller drives its pins. A controller without any stored has these defaults."""

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

    def pack(self) -> bytes:
        """Return the settings as they travel and are stored."""
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
    def unpack(cls, packed: bytes) -> Self:
        """Return packed settings. Raises Rejected when one is out of its range, ValueError when bytes are missing."""
        if len(packed) != SETTINGS_BYTES:
            raise ValueError(f"Settings of {len(packed)} bytes; allowed: {SETTINGS_BYTES}.")
        outputs, both_edges, step, direction, enable, *times, hold = _LAYOUT.unpack(packed)
        return cls.checked(
            {
                "outputs": OUTPUTS[outputs] if outputs < len(OUTPUTS) else outputs,
                "both_edges": axes_of(both_edges),
                "step_inverted": axes_of(step),
                "direction_inverted": axes_of(direction),
                "enable_level": LEVELS[enable] if enable < len(LEVELS) else enable,
                **dict(zip(("pulse_width_us", "direction_setup_us", "enable_lead_ms"), times, strict=True)),
                "enable_hold_ms": None if hold == HOLD_FOR_EVER else hold,
            }
        )


OFFSETS = dict(zip(StepRampSettings.model_fields, (0, 1, 2, 3, 4, 5, 6, 8, 10), strict=True))
"""Where each setting lies when packed [bytes]."""
