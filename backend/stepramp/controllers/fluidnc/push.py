"""Pushing designs to a FluidNC: which items are set, what came of it, and what of the designs is lost."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from stepramp.controllers.contract import OwnTerms, PreviewItem, PushItem, PushPreview, PushReport
from stepramp.controllers.fluidnc.configuration import LETTERS
from stepramp.controllers.fluidnc.ramp import FLUIDNC, fluidnc_losses
from stepramp.controllers.grbl.numbers import exact, is_same
from stepramp.controllers.grbl.scales import other_scales, refuse_others, unlike_words
from stepramp.controllers.grbl.settings import AxisSettings, Known
from stepramp.controllers.losses import slower
from stepramp.controllers.per_mm import PerMm
from stepramp.controllers.remark import of_axes
from stepramp.design import Design
from stepramp.errors import Count, Rejected, Rejection

SPEED, ACCELERATION = "Full speed", "Acceleration"
VOLATILE = "FluidNC forgets this when it is restarted or switched off: its configuration's file stays as it is."
UNVERIFIED = "The items are not those that were sent. Roll back, or push again."


@dataclass(frozen=True)
class PushPlan:
    """What will be set for designs, by axes."""

    designs: Mapping[int, Design]
    given: Mapping[int, PerMm]
    rounding_words: Mapping[int, str | None]

    @classmethod
    def of(cls, designs: Sequence[Design], first_axis: int | None, scales: Sequence[AxisSettings]) -> "PushPlan":
        """Return the plan; Rejected for axes that aren't there, and for what FluidNC can't take."""
        if first_axis is not None and first_axis >= len(scales):
            raise Rejected([Rejection("to_axis", first_axis, f"an axis of this controller: 0 to {len(scales) - 1}")])
        if not 1 <= len(designs) <= len(scales):
            raise Rejected([Rejection("axes", Count(f"{len(designs)} designs"), f"1 to {len(scales)} designs")])
        by_axis = {(first_axis or 0) + number: design for number, design in enumerate(designs)}
        paths = {axis: "" if first_axis is not None else f"axes.{axis}." for axis in by_axis}
        given = {
            axis: PerMm.of(
                design,
                FLUIDNC,
                paths[axis],
                own=exact(scales[axis].steps_per_mm),
                most=exact(scales[axis].most_steps_per_mm),
            )
            for axis, design in by_axis.items()
        }
        return cls(by_axis, given, {axis: scales[axis].rounding_words for axis in by_axis})

    @property
    def wanted(self) -> dict[str, str]:
        """The items by their paths, as they are sent."""
        values: dict[str, str] = {}
        for axis, each in self.given.items():
            values[acceleration_of(axis)] = each.acceleration
            values[rate_of(axis)] = each.speed
        return values

    @property
    def bytes(self) -> int:
        """Length of the lines that are sent [bytes]."""
        return sum(len(f"$/{path}={value}\n") for path, value in self.wanted.items())

    def other_scales(self, present: Known) -> list[str]:
        """Return which steps per mm are others than it was made with, in words."""
        return other_scales({axis: np.float32(float(each.scale)) for axis, each in self.given.items()}, present)

    def refuse_other_scales(self, present: Known) -> None:
        """Refused where the controller has other steps per mm than it was made with."""
        refuse_others(self.other_scales(present))

    def is_had(self, present: Known) -> bool:
        """Whether a controller has what is to be sent, as far as it tells."""
        return not self.other_scales(present) and all(self._is_had(axis, present.axis(axis)) for axis in self.given)

    def report(self, read_back: Known) -> PushReport:
        """Return what came of the push."""
        verified = self.is_had(read_back)
        unlike = () if verified else (*unlike_words(self.other_scales(read_back)), UNVERIFIED)
        return PushReport(
            items=tuple(self._items(read_back)),
            verified=verified,
            segments=None,
            bytes=self.bytes,
            largest_deviation_us=None,
            sequence=None,
            kept=False,
            warnings=(*self._losses(), VOLATILE, *unlike),
        )

    def preview(self, present: Known) -> PushPreview:
        """Return what the push would change of what a controller has."""
        items = tuple(
            PreviewItem(each.name, each.unit, each.read_back, each.sent, each.axis, each.own)
            for each in self._items(present)
        )
        return PushPreview(
            items=items,
            same=self.is_had(present),
            segments=None,
            bytes=self.bytes,
            largest_deviation_us=None,
            warnings=tuple(self._losses()),
        )

    def _is_had(self, axis: int, there: AxisSettings | None) -> bool:
        given = self.given[axis]
        return (
            there is not None
            and is_same(there.most_rate, np.float32(given.speed))
            and is_same(there.acceleration, np.float32(given.acceleration))
        )

    def _items(self, present: Known) -> Iterator[PushItem]:
        for axis, given in self.given.items():
            there, asked = present.axis(axis), self.designs[axis]
            scale = float(given.scale if there is None else there.steps_per_mm)
            rate, gain = np.float32(given.speed), np.float32(given.acceleration)
            told = (None, None) if there is None else (_told(there.most_rate, rate), _told(there.acceleration, gain))
            yield PushItem(
                SPEED,
                "steps/s",
                float(asked.ramp.slew_speed_steps_per_s),
                float(given.speed_steps_per_s),
                None if told[0] is None else float(told[0]) * scale / FLUIDNC.seconds,
                axis,
                OwnTerms(rate_of(axis), "mm/min", float(given.speed), _shown(told[0])),
            )
            yield PushItem(
                ACCELERATION,
                "steps/s²",
                float(slower(asked)),
                float(given.acceleration_steps_per_s2),
                None if told[1] is None else float(told[1]) * scale,
                axis,
                OwnTerms(acceleration_of(axis), "mm/s²", float(given.acceleration), _shown(told[1])),
            )

    def _losses(self) -> Iterator[str]:
        losses = dict[int, list[str]]()
        for axis, design in self.designs.items():
            rounded = self.rounding_words[axis]
            losses[axis] = [*fluidnc_losses(design, self.given[axis]), *(() if rounded is None else (rounded,))]
        return of_axes(losses)


def rate_of(axis: int) -> str:
    """Return the path of an axis' highest rate."""
    return f"axes/{LETTERS[axis]}/max_rate_mm_per_min"


def acceleration_of(axis: int) -> str:
    """Return the path of an axis' acceleration."""
    return f"axes/{LETTERS[axis]}/acceleration_mm_per_sec2"


def _told(there: np.float32, meant: np.float32) -> np.float32:
    """Return what is told the same as the same, whatever the last place of a float32."""
    return meant if is_same(there, meant) else there


def _shown(value: np.float32 | None) -> float | None:
    """Return a number with as many decimals as FluidNC is told."""
    return None if value is None else round(float(value), FLUIDNC.speed.decimals)
