"""What a design tells of its motor that doesn't fit together: it is played all the same, and said."""

from stepramp.design import Design
from stepramp.ramp.timer_limits import TimerWarning

ROUNDED = 1.01
"""So many times as much as it may be is the same, rounded."""


def motor_contradictions(design: Design) -> list[TimerWarning]:
    """Return what of a design's motor contradicts what else is told; none without a motor."""
    found = _other_full_steps(design), _more_than_held(design)
    return [warning for warning in found if warning is not None]


def _other_full_steps(design: Design) -> TimerWarning | None:
    own, of_axis = design.motor and design.motor.full_steps_per_rev, design.axis.full_steps_per_rev
    if own is None or own == of_axis:
        return None
    return TimerWarning(
        "motor.full_steps_per_rev",
        f"The motor has {own:,} full steps of a turn, and the axis {of_axis:,} (axis.full_steps_per_rev): of the same "
        "motor. Its torque and its swing are computed with the first, its speed with the second.",
    )


def _more_than_held(design: Design) -> TimerWarning | None:
    """Warn of a curve that has more torque than the current that it was measured with can hold at rest."""
    train = design.drive_train
    if train is None or not train.curve:
        return None
    then = train.when_measured or train
    most = max(torque for _, torque in train.curve)
    if most <= ROUNDED * then.static_torque_nm:
        return None
    return TimerWarning(
        "motor.torque_curve",
        f"The torque curve has up to {most:.4g} Nm, and {then.peak_current_a:.4g} A peak at {then.supply_v:.6g} V hold "
        f"the rotor with {then.static_torque_nm:.4g} Nm: more than the latter doesn't count. Was it measured with "
        "another current, or is this one rms and not peak?",
    )
