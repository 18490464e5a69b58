"""What is at fault where no ramp is safe, however gentle: which value of the design, and one that would do."""

from collections.abc import Callable, Iterator

from stepramp.design import Design
from stepramp.errors import Limits, Rejected, Rejection
from stepramp.motor.changes import changed
from stepramp.motor.limits import greatest_start_speed
from stepramp.motor.torque import drive_train
from stepramp.motor.ways import Way, finer_clock, finer_microsteps, slower, slower_start
from stepramp.numerics.limit_text import highest

FIGURES = 4
WHY = ": with this one no ramp is safe, however gentle"


def at_fault(gentle: Design, will_do: Callable[[Design], bool]) -> Rejected:
    """Return what is wrong with a design whose ramp is gentle, and won't do.

    Of the start, the slew speed, the timer and the microsteps it is what has to be changed least so that it would do by
    that alone. Where none does, it is the load.
    """
    found = []
    for way, unit in _ways(gentle):
        value = next((each for each in way.values if _does(gentle, way, each, will_do)), None)
        if value is not None:
            found.append((way.how_far(value), way, value, unit))
    if found:
        _, way, value, unit = min(found, key=lambda each: each[0])
        limits = Limits(lowest=value, unit=unit, note=WHY) if value > way.own else Limits(0, value, unit, note=WHY)
        return Rejected([Rejection.outside(way.field, way.own, limits)])
    allowed = "a motor, a drive or a load with which more torque is left: with this one no ramp is safe, however gentle"
    return Rejected([Rejection("load", gentle.load and gentle.load.model_dump(), allowed)])


def refuse_start(design: Design) -> None:
    """Refuse a base speed to which a motor can't start at once, by the closed form. Raises Rejected."""
    base, fastest = design.ramp.base_speed_steps_per_s, greatest_start_speed(drive_train(design))
    if base > fastest:
        limits = Limits(0, highest(fastest, FIGURES), "steps/s", note=": to more this motor can't start at once")
        raise Rejected([Rejection.outside("ramp.base_speed_steps_per_s", base, limits)])


def _ways(gentle: Design) -> Iterator[tuple[Way, str]]:
    yield from ((way, "steps/s") for way in slower_start(gentle))
    yield slower(gentle, gentle.ramp.slew_speed_steps_per_s), "steps/s"
    yield finer_clock(gentle), "Hz"
    yield from ((way, "per step") for way in finer_microsteps(gentle))


def _does(gentle: Design, way: Way, value: float, will_do: Callable[[Design], bool]) -> bool:
    made = changed(gentle, way.made(value).changes)
    try:
        return made is not None and will_do(made)
    except Rejected:
        return False
