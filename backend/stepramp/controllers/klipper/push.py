"""Pushing designs to a Klipper: which limits are set, what came of it, and what of the designs is lost."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

from stepramp.controllers.contract import OwnTerms, PreviewItem, PushItem, PushMode, PushPreview, PushReport
from stepramp.controllers.klipper.machine import Limits, Machine, Z
from stepramp.controllers.klipper.ramp import KLIPPER, losses_in_use
from stepramp.controllers.losses import slower
from stepramp.controllers.per_mm import PerMm
from stepramp.controllers.remark import OnTrial, of_axes
from stepramp.design import Design
from stepramp.errors import Count, Rejected, Rejection

SPEED, ACCELERATION = "Full speed", "Acceleration"
VOLATILE = OnTrial("Klipper forgets these limits when it is restarted.")
UNVERIFIED = "The limits are not those that were sent. Restore a backup of this device, or push again."
SHARED = "max_velocity and max_accel hold for x and y together: each is sent as the slower one of both."


@dataclass(frozen=True)
class PushPlan:
    """What will be set for designs, by axes."""

    machine: Machine
    designs: Mapping[int, Design]
    given: Mapping[int, PerMm]
    options: Mapping[str, str]
    """By the names of the options in the section [printer]."""
    cruise_ratio: float

    @classmethod
    def of(
        cls,
        designs: Sequence[Design],
        first_axis: int | None,
        machine: Machine,
        cruise_ratio: float,
        mode: PushMode = "keep",
    ) -> "PushPlan":
        """Return the plan; Rejected for axes that aren't there, and for what Klipper can't take, or start with."""
        axes = len(machine.steppers)
        if first_axis is not None and first_axis >= axes:
            raise Rejected([Rejection("to_axis", first_axis, f"an axis of this controller: 0 to {axes - 1}")])
        if not 1 <= len(designs) <= axes:
            raise Rejected([Rejection("axes", Count(f"{len(designs)} designs"), f"1 to {axes} designs")])
        by_axis = {(first_axis or 0) + number: design for number, design in enumerate(designs)}
        paths = {axis: "" if first_axis is not None else f"axes.{axis}." for axis in by_axis}
        given = {
            axis: PerMm.of(design, KLIPPER, paths[axis], own=machine.steppers[axis].steps_per_mm)
            for axis, design in by_axis.items()
        }
        if Z in given and mode == "try":
            field = "to_axis" if first_axis is not None else f"axes.{Z}"
            allowed = "axis 0 or 1 where nothing is stored: the limits of z are in Klipper's configuration only"
            raise Rejected([Rejection(field, Z if first_axis is not None else "a design", allowed)])
        options = _options(given)
        if Z in given:
            _refuse_faster_z(by_axis[Z], paths[Z], given[Z], options, machine.limits)
        return cls(machine, by_axis, given, options, cruise_ratio)

    @property
    def bytes(self) -> int:
        """Length of the options as they are set [bytes]."""
        return sum(len(f"{name}: {value}\n") for name, value in self.options.items())

    def report(self, present: Limits, remarks: Sequence[str], mode: PushMode, *, verified: bool) -> PushReport:
        """Return what came of the push. present: the limits as read back. remarks: what else there is to say."""
        kept = mode == "keep"
        more = (*remarks, *(() if kept else (VOLATILE,)), *(() if verified else (UNVERIFIED,)))
        return PushReport(
            items=tuple(self._items(present)),
            verified=verified,
            segments=None,
            bytes=self.bytes,
            largest_deviation_us=None,
            sequence=None,
            kept=kept and verified,
            warnings=(*self._losses(), *more),
        )

    def preview(self, present: Limits, consequences: Iterable[str]) -> PushPreview:
        """Return what the push would change of limits. consequences: what storing them does besides."""
        items = tuple(
            PreviewItem(each.name, each.unit, each.read_back, each.sent, each.axis, each.own)
            for each in self._items(present)
        )
        return PushPreview(
            items=items,
            same=not any(item.differs for item in items),
            segments=None,
            bytes=self.bytes,
            largest_deviation_us=None,
            warnings=(*consequences, *self._losses()),
        )

    def is_had(self, present: Limits) -> bool:
        """Whether limits are those of the plan."""
        return all(float(value) == float(present_of(name, present)) for name, value in self.options.items())

    def _items(self, present: Limits) -> Iterator[PushItem]:
        for axis, design in self.designs.items():
            scale, ramp = self.machine.steppers[axis].steps_per_mm, design.ramp
            names = names_of(axis)
            asked = float(ramp.slew_speed_steps_per_s), float(slower(design))
            for label, unit, name, requested in zip(
                (SPEED, ACCELERATION), ("mm/s", "mm/s²"), names, asked, strict=True
            ):
                sent, there = Fraction(self.options[name]), present_of(name, present)
                yield PushItem(
                    label,
                    "steps/s" if label == SPEED else "steps/s²",
                    requested,
                    float(sent * scale),
                    float(there * scale),
                    axis,
                    OwnTerms(name, unit, float(sent), float(there)),
                )

    def _losses(self) -> Iterator[str]:
        yield from of_axes(
            {axis: losses_in_use(design, self.given[axis], self.cruise_ratio) for axis, design in self.designs.items()}
        )
        if any(axis != Z for axis in self.designs):
            yield SHARED
        if self.machine.remark is not None:
            yield self.machine.remark


def names_of(axis: int) -> tuple[str, str]:
    """Return the names of the options that limit an axis' speed and acceleration."""
    return ("max_z_velocity", "max_z_accel") if axis == Z else ("max_velocity", "max_accel")


def present_of(name: str, limits: Limits) -> Fraction:
    """Return a limit by its option's name."""
    value: Fraction = getattr(limits, name.removeprefix("max_"))
    return value


def _options(given: Mapping[int, PerMm]) -> dict[str, str]:
    """Return what is set: of several axes the slower one's."""
    options: dict[str, str] = {}
    for axis, each in given.items():
        speed, gain = names_of(axis)
        for name, value in ((gain, each.acceleration), (speed, each.speed)):
            options[name] = min(options.get(name, value), value, key=float)
    return options


def _refuse_faster_z(design: Design, path: str, given: PerMm, options: Mapping[str, str], limits: Limits) -> None:
    """Reject limits of z above those of all axes: Klipper doesn't start with such a configuration."""
    bad = []
    fields = {
        "max_velocity": ("slew_speed_steps_per_s", given.speed, "steps/s"),
        "max_accel": ("acceleration_steps_per_s2", given.acceleration, "steps/s²"),
    }
    for name, (field, value, unit) in fields.items():
        most = Fraction(options[name]) if name in options else present_of(name, limits)
        if Fraction(value) > most:
            allowed = (
                f"at most {float(most * given.scale):,.10g} {unit}, as {name} is {float(most):,.10g}: Klipper doesn't "
                "start with more for z"
            )
            bad.append(Rejection(f"{path}ramp.{field}", getattr(design.ramp, field), allowed))
    if bad:
        raise Rejected(bad)
