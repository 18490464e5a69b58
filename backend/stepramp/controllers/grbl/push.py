"""Pushing designs to a grbl: which settings are sent, what came of it, and what of the designs is lost."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from stepramp.controllers.contract import OwnTerms, PreviewItem, PushItem, PushPreview, PushReport
from stepramp.controllers.given_numbers import typed
from stepramp.controllers.grbl.numbers import exact, is_same, read
from stepramp.controllers.grbl.ramp import GrblRamp, grbl_losses
from stepramp.controllers.grbl.scales import other_scales, refuse_others
from stepramp.controllers.grbl.settings import ACCELERATION, MOST_RATE, AxisSettings, Settings
from stepramp.controllers.losses import other_scale, rounding, slower
from stepramp.controllers.order import lowered_first
from stepramp.controllers.remark import of_axes
from stepramp.design import Design
from stepramp.errors import Count, Rejected, Rejection

SPEED, ACCELERATIONS = "Full speed", "Acceleration"


@dataclass(frozen=True)
class PushPlan:
    """What will be sent for designs, by axes."""

    designs: dict[int, Design]
    ramps: dict[int, GrblRamp]
    rounding_words: dict[int, str | None]

    @classmethod
    def of(cls, designs: Sequence[Design], first_axis: int | None, scales: Sequence[AxisSettings]) -> "PushPlan":
        """Return the plan; Rejected for axes that aren't there, and for what grbl can't take."""
        if first_axis is not None and first_axis >= len(scales):
            raise Rejected([Rejection("to_axis", first_axis, f"an axis of this controller: 0 to {len(scales) - 1}")])
        if len(designs) > len(scales):
            raise Rejected([Rejection("axes", Count(f"{len(designs)} designs"), f"up to {len(scales)} designs")])
        first = first_axis or 0
        by_axis = {first + number: design for number, design in enumerate(designs)}
        paths = {axis: "" if first_axis is not None else f"axes.{axis}." for axis in by_axis}
        return cls(
            by_axis,
            {
                axis: GrblRamp.of(each, scales[axis].steps_per_mm, paths[axis], scales[axis].most_steps_per_mm)
                for axis, each in by_axis.items()
            },
            {axis: scales[axis].rounding_words for axis in by_axis},
        )

    @property
    def wanted(self) -> dict[int, str]:
        """The settings, by number, as they are sent."""
        values: dict[int, str] = {}
        for axis, ramp in self.ramps.items():
            values[ACCELERATION + axis] = ramp.acceleration_text
            values[MOST_RATE + axis] = ramp.rate_text
        return values

    def other_scales(self, present: Settings) -> list[str]:
        """Return which steps per mm are others than it was made with, in words."""
        return other_scales({axis: ramp.steps_per_mm for axis, ramp in self.ramps.items()}, present)

    def refuse_other_scales(self, present: Settings) -> None:
        """Refused where the controller has other steps per mm than it was made with."""
        refuse_others(self.other_scales(present))

    def lines(self, present: Settings) -> list[str]:
        """Return what is sent, a line each, to a controller with these settings."""
        wanted = self.wanted

        def is_raised(number: int) -> bool:
            try:
                return bool(read(wanted[number]) > read(present.values[number]))
            except (KeyError, ValueError):
                return False

        return [f"${number}={wanted[number]}" for number in lowered_first(wanted, is_raised)]

    @property
    def bytes(self) -> int:
        """Length of the lines [bytes]."""
        return sum(len(f"${number}={value}\n") for number, value in self.wanted.items())

    def report(self, read_back: Settings, remarks: Sequence[str], *, verified: bool) -> PushReport:
        """Return what came of the push. remarks: what else there is to say."""
        return PushReport(
            items=tuple(self._items(read_back)),
            verified=verified,
            segments=None,
            bytes=self.bytes,
            largest_deviation_us=None,
            sequence=None,
            kept=True,
            warnings=(*self._losses(), *remarks),
        )

    def preview(self, present: Settings) -> PushPreview:
        """Return what the push would change of the settings as they were last read."""
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
            warnings=tuple(self._losses()),
        )

    def _items(self, present: Settings) -> Iterator[PushItem]:
        for axis, ramp in self.ramps.items():
            asked, there = self.designs[axis].ramp, present.axis(axis)
            # What is told the same is shown as the same, whatever the last place of a float32.
            rate = ramp.rate if there is None or is_same(there.most_rate, ramp.rate) else there.most_rate
            gain = ramp.acceleration
            if there is not None and not is_same(there.acceleration, gain):
                gain = there.acceleration
            known = AxisSettings(ramp.steps_per_mm if there is None else there.steps_per_mm, rate, gain)
            yield PushItem(
                SPEED,
                "steps/s",
                asked.slew_speed_steps_per_s,
                ramp.speed_steps_per_s,
                None if there is None else known.speed_steps_per_s,
                axis,
                OwnTerms(
                    f"${MOST_RATE + axis}",
                    "mm/min",
                    _told(ramp.rate),
                    None if there is None else _told(there.most_rate),
                ),
            )
            yield PushItem(
                ACCELERATIONS,
                "steps/s²",
                float(slower(self.designs[axis])),
                ramp.acceleration_steps_per_s2,
                None if there is None else known.acceleration_steps_per_s2,
                axis,
                OwnTerms(
                    f"${ACCELERATION + axis}",
                    "mm/s²",
                    _told(ramp.acceleration),
                    None if there is None else _told(there.acceleration),
                ),
            )

    def _losses(self) -> Iterator[str]:
        losses = dict[int, list[str]]()
        for axis, design in self.designs.items():
            rounded = self.rounding_words[axis]
            losses[axis] = [*_losses_of(design, self.ramps[axis]), *(() if rounded is None else (rounded,))]
        return of_axes(losses)


def _losses_of(design: Design, ramp: GrblRamp) -> Iterator[str]:
    yield from grbl_losses(design)
    asked = typed(design.ramp.slew_speed_steps_per_s)
    yield from rounding("Slew speed", "steps/s", asked, typed(ramp.speed_steps_per_s))
    yield from rounding("Acceleration", "steps/s²", slower(design), typed(ramp.acceleration_steps_per_s2))
    yield from other_scale(design, "grbl", exact(ramp.steps_per_mm))


def _told(value: np.float32) -> float:
    """Return a number with as many decimals as grbl tells."""
    return round(float(value), 3)
