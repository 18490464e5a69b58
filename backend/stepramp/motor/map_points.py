"""What a stall map asks at each of its points: the design with two of its values replaced."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

from stepramp.design import Design
from stepramp.drive_train import Drive, Load
from stepramp.errors import Rejected
from stepramp.motor.shortened import shortened
from stepramp.motor.stall_map import Point
from stepramp.motor.torque import drive_train
from stepramp.motor.verdict import Verdict, verdict_of

Over = Literal["slew_speed", "load", "supply_voltage"]

VERDICTS: dict[Verdict, int] = {"safe": 0, "marginal": 1, "stalls": 2}
Spacing = Literal["even", "ratios"]

SPACINGS: dict[Over, Spacing] = {"slew_speed": "ratios", "load": "even", "supply_voltage": "ratios"}
"""How a map's values follow each other: loads begin with none, and may change sides."""
NOT_POSSIBLE = 3
"""Stands for a design that isn't planned or played, such as one beyond its timer."""


@dataclass(frozen=True)
class Question:
    """A design, and the values that take the place of its own."""

    design: Design
    over: Over
    over_values: tuple[float, ...]
    """Of slew speed [steps/s], load torque [Nm] or supply [V], one a column."""
    accelerations: tuple[float, ...]
    """[steps/s²], one a row."""


def own_value(design: Design, over: Over) -> float:
    """Return a design's own value of what a map goes over. Raises Rejected without a motor."""
    own = {
        "slew_speed": design.ramp.slew_speed_steps_per_s,
        "load": (design.load or Load()).torque_nm,
        "supply_voltage": drive_train(design).supply_v,
    }
    return own[over]


def own_verdict(question: Question, is_wanted: Callable[[], bool] = lambda: True) -> int:
    """Return the verdict of the design itself, as verdict_at does of a point."""
    design = question.design
    own = own_value(design, question.over)
    return _verdict_with(question, design.ramp.acceleration_steps_per_s2, own, is_wanted)


def verdict_at(question: Question, point: Point, is_wanted: Callable[[], bool] = lambda: True) -> int:
    """Return the verdict of a point: 0 safe, 1 marginal, 2 stalls, 3 not possible. Raises NotWanted as verdict_of."""
    row, column = point
    return _verdict_with(question, question.accelerations[row], question.over_values[column], is_wanted)


def _verdict_with(question: Question, acceleration: float, value: float, is_wanted: Callable[[], bool]) -> int:
    try:
        return VERDICTS[verdict_of(shortened(design_with(question, acceleration, value)), is_wanted)]
    except Rejected:
        return NOT_POSSIBLE


def design_with(question: Question, acceleration: float, value: float) -> Design:
    """Return the design with another acceleration [steps/s²], a given deceleration in proportion, and another value.

    Raises Rejected where that is no design.
    """
    design = question.design
    ramp = design.ramp.model_dump(by_alias=True) | {"acceleration_steps_per_s2": acceleration}
    if design.ramp.deceleration_steps_per_s2 is not None:
        part = acceleration / design.ramp.acceleration_steps_per_s2
        ramp["deceleration_steps_per_s2"] = part * design.ramp.deceleration_steps_per_s2
    changes: dict[str, object] = {"ramp": ramp}
    match question.over:
        case "slew_speed":
            ramp["slew_speed_steps_per_s"] = value
        case "load":
            changes["load"] = (design.load or Load()).model_dump(by_alias=True) | {"torque_nm": value}
        case "supply_voltage":
            changes["drive"] = (design.drive or Drive()).model_dump(by_alias=True) | {"supply_v": value}
            changes["motor"] = design.motor and design.motor.pinned(design.drive)
    # What isn't changed is valid already, and isn't looked at again.
    own = {field.alias or name: getattr(design, name) for name, field in Design.model_fields.items()}
    return Design.checked(own | changes)
