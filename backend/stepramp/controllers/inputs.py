"""Inputs of a controller, such as limit switches, and what they do: as any family tells it."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from stepramp.errors import Refused

RoleName = Literal["emergency_stop", "driver_fault", "limit"]
StopCause = Literal["emergency_stop", "driver_fault", "stepped_late"]
Level = Literal["low", "high"]
End = Literal["low", "high"]
LimitStop = Literal["ramp", "at_once"]
CALLED: dict[RoleName, str] = {
    "emergency_stop": "the emergency stop",
    "driver_fault": "the driver's fault",
    "limit": "the limit switch",
}
CAUSED: dict[StopCause, str] = {
    "emergency_stop": "the emergency stop has stopped all axes",
    "driver_fault": "the driver's fault has stopped all axes",
    "stepped_late": "steps came late, which has stopped all axes, and motors may have lost some: no position is known",
}


@dataclass(frozen=True)
class InputStatus:
    """An input that is for something, and whether it is active now."""

    input: str
    """As it is named on the board."""
    role: RoleName
    is_active: bool
    active: Level
    """The level at which it is active."""
    pull_up: bool
    axis: int | None = None
    """Whose end a limit switch is at; None for other roles, as the two below."""
    end: End | None = None
    stops: LimitStop | None = None
    """How a limit switch stops the axis."""


@dataclass(frozen=True)
class InputsState:
    """What a controller with inputs says of them."""

    inputs: tuple[InputStatus, ...]
    """Those that are for something, in the order of the board."""
    stopped_by: tuple[StopCause, ...]
    """What has stopped all motion, until it is acknowledged; () for nothing."""

    @property
    def trouble(self) -> str | None:
        """Why nothing moves, and what to do about it, as sentences for people; None where nothing is in the way."""
        if not self.stopped_by:
            return None
        pressed = [each for each in self.inputs if each.is_active and each.role in self.stopped_by]
        return stopped_words(pressed, self.stopped_by)


class InTheWay(Refused):
    """An input, or what it has stopped, keeps something from being done: the controller's status tells of it."""


def stopped_words(active: Sequence[InputStatus], stopped_by: tuple[StopCause, ...] = ()) -> str:
    """Return that nothing moves, why, and what to do, as sentences.

    active: emergency stops and driver's faults that are still there. stopped_by: what has stopped motion, if known.
    """
    if active:
        there = " and ".join(f"{CALLED[each.role]} at {each.input}" for each in active)
        is_, it = ("is", "it") if len(active) == 1 else ("are", "them")
        todo = f"release {it}" if any(each.role == "emergency_stop" for each in active) else f"mend {it}"
        return f"Nothing moves: {there} {is_} active. First {todo}, then acknowledge."
    unknown = "an emergency stop, a driver's fault or steps that came late have stopped all axes"
    causes = "; ".join(CAUSED[each] for each in stopped_by) or unknown
    return f"Nothing moves: {causes}. Acknowledge that first."


def at_limit_words(axis: int, switch: str | None, end: End | None) -> str:
    """Return that a motion leads into a limit switch that is active. switch, end: None where they aren't known."""
    which = "a limit switch" if end is None else f"the limit switch of its {end} end"
    at = "" if switch is None else f" at {switch}"
    return f"Axis {axis} is on {which}{at} and goes no further that way: move it the other way."


def at_soft_limit_words(axis: int, end: End, at_steps: int | None) -> str:
    """Return that a motion leads beyond a soft limit that the controller keeps. at_steps: None where it isn't known."""
    which = "lowest" if end == "low" else "highest"
    where = "" if at_steps is None else f", {at_steps:,} steps"
    return (
        f"This leads beyond the {which} position of axis {axis} in the controller's settings{where}: "
        "nothing has moved. Stay within it, or change that soft limit."
    )
