"""Pushing designs to a module: what is sent, what came of it, and what of the designs is lost."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from stepramp.controllers.constant_rates import with_constant_rates
from stepramp.controllers.contract import FigureUnit, OwnTerms, PreviewItem, PushItem, PushMode, PushPreview, PushReport
from stepramp.controllers.microsteps import steps
from stepramp.controllers.remark import OnTrial, of_axes
from stepramp.controllers.tmcl.modules import Parameters
from stepramp.controllers.tmcl.ramp import (
    TmclRamp,
    chip_in_steps,
    in_steps,
    in_units,
    is_kept,
    is_speed,
    tmcl_losses,
)
from stepramp.controllers.tmcl.ramps import Ramps
from stepramp.controllers.tmcl.units import Units
from stepramp.controllers.tmcl.wire import FRAME_BYTES
from stepramp.design import Design
from stepramp.errors import Count, Rejected, Rejection

NAMES = {
    "vmax": "Full speed",
    "amax": "Acceleration",
    "dmax": "Deceleration",
    "vstart": "Starting speed",
    "vstop": "Stopping speed",
    "a1": "Acceleration up to V1",
    "v1": "V1, up to which other accelerations hold",
    "d1": "Deceleration below V1",
}
"""What people call the figures of a ramp."""
VOLATILE = OnTrial("The module forgets these figures when it is reset or switched off.")
UNVERIFIED = (
    "The figures are not those that were sent, so they weren't stored. Roll back, restore a backup of this device, or "
    "push again."
)


@dataclass(frozen=True)
class PushPlan:
    """What will be sent for designs, by axes."""

    designs: Mapping[int, Design]
    ramps: Mapping[int, TmclRamp]
    units: Sequence[Units]
    """Of each axis of the module."""
    microsteps: Sequence[int]
    """The same, for a full step."""
    parameters: Parameters

    @classmethod
    def of(cls, designs: Sequence[Design], first_axis: int | None, known: Ramps) -> "PushPlan":
        """Return the plan; Rejected for axes that aren't there, and for what a module can't do."""
        axes = len(known.units)
        if first_axis is not None and first_axis >= axes:
            raise Rejected([Rejection("to_axis", first_axis, f"an axis of this controller: 0 to {axes - 1}")])
        if not 1 <= len(designs) <= axes:
            raise Rejected([Rejection("axes", Count(f"{len(designs)} designs"), f"1 to {axes} designs")])
        by_axis = {(first_axis or 0) + number: design for number, design in enumerate(designs)}
        ramps = {
            axis: TmclRamp.of(design, known.units[axis], "" if first_axis is not None else f"axes.{axis}.")
            for axis, design in by_axis.items()
        }
        return cls(by_axis, ramps, known.units, [each.count for each in known.microsteps], known.parameters)

    @property
    def bytes(self) -> int:
        """Length of the commands that are sent [bytes]."""
        return FRAME_BYTES * len(TmclRamp.figures()) * len(self.ramps)

    def is_had(self, ramps: Sequence[TmclRamp]) -> bool:
        """Whether axes that tell such ramps have those of the plan."""
        return all(ramp.is_kept_by(ramps[axis], self.units[axis]) for axis, ramp in self.ramps.items())

    def report(self, read_back: Sequence[TmclRamp], mode: PushMode) -> PushReport:
        """Return what came of the push."""
        verified = self.is_had(read_back)
        kept = verified and mode == "keep"
        return PushReport(
            items=tuple(self._items(read_back)),
            verified=verified,
            segments=None,
            bytes=self.bytes,
            largest_deviation_us=None,
            sequence=None,
            kept=kept,
            warnings=(*self._losses(), *(() if kept else (VOLATILE,)), *(() if verified else (UNVERIFIED,))),
        )

    def preview(self, present: Sequence[TmclRamp]) -> PushPreview:
        """Return what the push would change of the ramps in use."""
        return PushPreview(
            items=tuple(
                PreviewItem(each.name, each.unit, each.read_back, each.sent, each.axis, each.own)
                for each in self._items(present)
            ),
            same=self.is_had(present),
            segments=None,
            bytes=self.bytes,
            largest_deviation_us=None,
            warnings=tuple(self._losses()),
        )

    def _items(self, present: Sequence[TmclRamp]) -> Iterator[PushItem]:
        """Yield each figure as the chip gets it, and has it where the module tells one that may be that."""
        for axis, ramp in self.ramps.items():
            asked, units = _asked(self.designs[axis]), self.units[axis]
            for (name, sent), (_, there) in zip(ramp.named, present[axis].named, strict=True):
                unit: FigureUnit = "steps/s" if is_speed(name) else "steps/s²"
                is_had, in_chip = is_kept(name, sent, there, units), chip_in_steps(name, sent, units)
                own = OwnTerms(
                    f"{self.parameters.of(name)} ({name.upper()})",
                    units.speed_name if is_speed(name) else units.acceleration_name,
                    there if is_had else in_units(name, in_chip, units),
                    there,
                )
                read_back = float(in_chip) if is_had else in_steps(name, there, units)
                yield PushItem(NAMES[name], unit, asked[name], float(in_chip), read_back, axis, own)

    def _losses(self) -> Iterator[str]:
        return of_axes(
            {
                axis: (*tmcl_losses(design, self.units[axis]), *_other_steps(design, self.microsteps[axis]))
                for axis, design in self.designs.items()
            }
        )


def _asked(design: Design) -> dict[str, float]:
    """Return the figures that a design gives [steps/s, steps/s²]; of a speed V1 it knows nothing, so 0."""
    ramp = with_constant_rates(design).ramp
    base, gain, loss = ramp.base_speed_steps_per_s, ramp.acceleration_steps_per_s2, ramp.slowdown_steps_per_s2
    speeds = {"vmax": ramp.slew_speed_steps_per_s, "vstart": base, "vstop": base, "v1": 0.0}
    return {**speeds, "amax": gain, "a1": gain, "dmax": loss, "d1": loss}


def _other_steps(design: Design, microsteps: int) -> Iterator[str]:
    if design.axis.microsteps != microsteps:
        yield (
            f"The design has {steps(design.axis.microsteps)} a full step, the module {microsteps:,} (axis parameter "
            "140): its steps are sent as microsteps of the module."
        )
