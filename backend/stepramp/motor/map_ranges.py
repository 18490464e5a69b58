"""From where to where a stall map goes where nobody says: around the design, as far as its border if there is one."""

import numpy as np

from stepramp.design import Design
from stepramp.drive_train import Load
from stepramp.motor.demand import demands_of
from stepramp.motor.limits import greatest_acceleration, required_nm
from stepramp.motor.map_points import SPACINGS, Over, Question
from stepramp.motor.torque import drive_train
from stepramp.numerics.drive_train import DriveTrain

Range = tuple[float, float]

ACCELERATIONS: Range = (0.001, 1e9)
"""Allowed [steps/s²]."""
VALUES: dict[Over, Range] = {"slew_speed": (0.001, 1e6), "load": (-1000.0, 1000.0), "supply_voltage": (0.5, 1000.0)}
"""Allowed [of UNITS]."""
UNITS: dict[Over, str] = {"slew_speed": "steps/s", "load": "Nm", "supply_voltage": "V"}
SPEEDS = 400
"""At so many speeds it is looked whether torque is left."""


def question_of(design: Design, over: Over, values: Range | None, accelerations: Range | None, cells: int) -> Question:
    """Return the question of a map; None stands for usual ranges. Raises Rejected without a motor."""
    values = values or value_range(design, over)
    accelerations = accelerations or acceleration_range(design)
    space = np.linspace if SPACINGS[over] == "even" else np.geomspace
    return Question(
        design,
        over,
        over_values=tuple(space(*values, cells + 1).tolist()),
        accelerations=tuple(np.geomspace(*accelerations, cells + 1).tolist()),
    )


def acceleration_range(design: Design) -> Range:
    """Return from which to which acceleration to look [steps/s²]: to twice what the static torque gives at rest."""
    own, greatest = design.ramp.acceleration_steps_per_s2, greatest_acceleration(drive_train(design), 1.0)
    ends = (own / 4, 2 * own, *((greatest / 32, 2 * greatest) if greatest > 0 else ()))
    return _within(ACCELERATIONS, min(ends), max(ends))


def value_range(design: Design, over: Over) -> Range:
    """Return from where to where to look at what the map goes over. Raises Rejected without a motor."""
    train = drive_train(design)
    ways = {"slew_speed": _speeds, "load": _loads, "supply_voltage": _voltages}
    low, high = ways[over](design, train)
    return _within(VALUES[over], low, high)


def _within(allowed: Range, low: float, high: float) -> Range:
    return max(low, allowed[0]), min(high, allowed[1])


def _speeds(design: Design, train: DriveTrain) -> Range:
    """Return speeds from the base speed on, to beyond that at which nothing is left to accelerate with [steps/s]."""
    own, base = design.ramp.slew_speed_steps_per_s, design.ramp.base_speed_steps_per_s
    speeds = np.geomspace(*VALUES["slew_speed"], SPEEDS)
    moved = speeds[train.pull_out_nm(speeds * train.radians_per_step) > train.holding_back_nm]
    last = float(moved[-1]) if moved.size else own
    return max(base, min(own / 4, last / 16)), max(2 * own, 1.25 * last)


def _loads(design: Design, train: DriveTrain) -> Range:
    """Return loads from none to more than the static torque, on the side of the design's own [Nm]."""
    most = max(1.1 * train.static_torque_nm, 1.25 * abs(train.load_nm))
    # What a mechanism adds isn't varied.
    added = train.load_nm - (design.load or Load()).torque_nm
    return (-added, most - added) if train.load_nm >= 0 else (-most - added, -added)


def _voltages(design: Design, train: DriveTrain) -> Range:
    """Return voltages around that with which the motor has what is asked for at slew speed, or by a table's rows [V].

    T = k K_m (V / Z - K_m ω R / Z²), solved for V: docs/motor.md.
    """
    speeds = np.array([design.ramp.slew_speed_steps_per_s])
    asked = required_nm(train, np.array([design.ramp.acceleration_steps_per_s2]))
    if design.method.plays_table:
        demands = demands_of(design, train)
        speeds, asked = (
            np.concatenate(each) for each in zip(*((d.speeds, d.torques_nm) for d in demands), strict=True)
        )
    speeds = speeds * train.radians_per_step
    constant, resistance = train.torque_constant_nm_per_a, train.resistance_ohm
    impedances = np.hypot(resistance, train.periods_per_rev * speeds * train.inductance_h)
    volts = impedances * asked / (train.pull_out_factor * constant) + constant * speeds * resistance / impedances
    needed = float(volts.max())
    return min(train.supply_v, needed) / 3, max(train.supply_v, needed) * 2
