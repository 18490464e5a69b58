"""What is checked of a planned move, each with its verdict."""

from dataclasses import dataclass

from stepramp.design import Design
from stepramp.exports.printed.numbers import plain
from stepramp.exports.printed.told import in_units, shown
from stepramp.ramp.profile import Profile
from stepramp.units import ShownUnits, us_from_ticks


@dataclass(frozen=True)
class Check:
    """One check: what should hold, whether it does, and by what figures; failed, what to change."""

    what: str
    passed: bool
    detail: str

    @property
    def verdict(self) -> str:
        """The verdict in a word."""
        return "passed" if self.passed else "failed"


def checks_of(design: Design, profile: Profile, units: ShownUnits) -> list[Check]:
    """Return the verdict of each warning that there is: the warning itself where it was given."""
    given: dict[str | None, list[str]] = {}
    for warning in profile.warnings:
        given.setdefault(warning.field, []).append(in_units(warning.message, warning.told, units))
    known = _good_news(design, profile, units)
    checks = [
        Check(what, field not in given, " ".join(given.pop(field, [good]))) for field, (what, good) in known.items()
    ]
    others = [Check("Other", False, message) for messages in given.values() for message in messages]
    return checks + others


def _good_news(design: Design, profile: Profile, units: ShownUnits) -> dict[str | None, tuple[str, str]]:
    """Return by field of its warning what is checked, and what is said when there is no such warning."""
    timer = design.timer
    longest, shortest = int(profile.intervals_ticks.max()), int(profile.intervals_ticks.min())
    return {
        "timer.counter_bits": (
            "Every interval fits in the timer's counter",
            f"The longest has {longest:,} ticks of at most {2**timer.counter_bits - 1:,}.",
        ),
        "timer.shortest_interval_us": (
            "No interval is too short for the controller",
            f"The shortest has {plain(us_from_ticks(shortest, timer.frequency_hz))} µs; "
            f"at least {plain(timer.shortest_interval_us)} µs are needed.",
        ),
        "timer.frequency_hz": (
            "The timer is fine enough at slew speed",
            f"One tick is {plain(100 * profile.slew_resolution.relative, 2)} % of the slew interval.",
        ),
        "move.steps": (
            "The move is long enough for full speed",
            f"It peaks at {shown(profile.peak_speed_steps_per_s, units, 'speed')}.",
        ),
        **_ramps(design, profile),
    }


def _ramps(design: Design, profile: Profile) -> dict[str | None, tuple[str, str]]:
    ramp, up, down = design.ramp, profile.plan.ramp.up.size, profile.plan.ramp.down.size
    if design.method.plays_table or ramp.base_speed_steps_per_s == ramp.slew_speed_steps_per_s:
        return {}
    if ramp.deceleration_steps_per_s2 is None:
        return {"ramp.acceleration_steps_per_s2": ("There is a ramp", f"Of {up:,} steps up and {down:,} down.")}
    return {
        "ramp.acceleration_steps_per_s2": ("There is a ramp up", f"Of {up:,} steps."),
        "ramp.deceleration_steps_per_s2": ("There is a ramp down", f"Of {down:,} steps."),
    }
