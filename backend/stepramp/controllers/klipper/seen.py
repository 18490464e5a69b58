"""What Klipper tells of its state, as its status reference names it: what makes no sense is refused here."""

from collections.abc import Mapping
from typing import Annotated, Self

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from stepramp.controllers.klipper.machine import USUAL_CRUISE_RATIO
from stepramp.errors import DeviceLost

MOST_CRUISE_RATIO = 0.99
MOST = 1e9
"""No printer is so large, or so fast [mm, mm/s, mm/s²]."""
Coordinate = Annotated[float, Field(ge=-MOST, le=MOST)]
Coordinates = Annotated[list[Coordinate], Field(min_length=3)]
Limit = Annotated[float, Field(ge=1 / MOST, le=MOST)]


class _Told(BaseModel):
    model_config = ConfigDict(strict=True, allow_inf_nan=False)


class Webhooks(_Told):
    """Whether it is ready."""

    state: str
    state_message: str = ""


class Toolhead(_Told):
    """Where the tool is told to go, and how fast it may."""

    position: Coordinates
    homed_axes: str
    axis_minimum: Coordinates
    axis_maximum: Coordinates
    max_velocity: Limit
    max_accel: Limit
    square_corner_velocity: float
    minimum_cruise_ratio: float | None = None
    """None for one that is older than 2024."""


class MotionReport(_Told):
    """Where the tool is [mm], and how fast [mm/s]; up to a quarter of a second old."""

    live_position: Coordinates
    live_velocity: Coordinate


class State(_Told):
    """What a part of it does."""

    state: str = ""


class VirtualCard(_Told):
    """The file that is printed."""

    is_active: bool = False


class StepperEnable(_Told):
    """Which motors have current."""

    steppers: dict[str, bool] = {}


class ConfigFile(_Told):
    """What has come of its configuration since it started."""

    save_config_pending: bool = False


class Seen(_Told):
    """All that is asked for again and again."""

    webhooks: Webhooks
    toolhead: Toolhead
    motion_report: MotionReport
    print_stats: State = State()
    idle_timeout: State = State()
    virtual_sdcard: VirtualCard = VirtualCard()
    stepper_enable: StepperEnable = StepperEnable()
    configfile: ConfigFile = ConfigFile()

    @classmethod
    def of(cls, status: Mapping[str, object], name: str) -> Self:
        """Return what is told of the one at a port; DeviceLost when that makes no sense."""
        try:
            return cls.model_validate(status)
        except ValidationError as error:
            where = ".".join(map(str, error.errors()[0]["loc"]))
            raise DeviceLost(f"What Klipper at {name} tells of {where} makes no sense.") from error

    @property
    def cruise_ratio(self) -> float:
        """The least part of a way that goes at one speed; the usual of an older one, which doesn't tell it."""
        ratio = self.toolhead.minimum_cruise_ratio
        return min(USUAL_CRUISE_RATIO if ratio is None else max(ratio, 0.0), MOST_CRUISE_RATIO)

    @property
    def is_printing(self) -> bool:
        """Whether somebody prints, or has paused that."""
        return self.virtual_sdcard.is_active or self.print_stats.state in ("printing", "paused")

    @property
    def is_busy(self) -> bool:
        """Whether it carries out what somebody has told it."""
        return self.idle_timeout.state == "Printing"

    @property
    def has_current(self) -> bool:
        """Whether a motor has current."""
        return any(self.stepper_enable.steppers.values())

    @property
    def has_unsaved(self) -> bool:
        """Whether it has calibrations that a restart would lose."""
        return self.configfile.save_config_pending


OBJECTS: dict[str, list[str] | None] = {
    "webhooks": ["state", "state_message"],
    "toolhead": [
        "position",
        "homed_axes",
        "axis_minimum",
        "axis_maximum",
        "max_velocity",
        "max_accel",
        "square_corner_velocity",
        "minimum_cruise_ratio",
    ],
    "motion_report": ["live_position", "live_velocity"],
    "print_stats": ["state"],
    "idle_timeout": ["state"],
    "virtual_sdcard": ["is_active"],
    "stepper_enable": ["steppers"],
    "configfile": ["save_config_pending"],
}
"""What is asked for, by the names that Klipper has for it."""
READY, SHUTDOWN, ERROR, STARTUP, DISCONNECTED = "ready", "shutdown", "error", "startup", "disconnected"
"""States of Klipper; in the last one Moonraker doesn't reach it."""
