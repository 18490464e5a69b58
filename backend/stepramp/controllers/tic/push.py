"""Pushing a design to a Tic: what is sent, what came of it, and what of the design is lost."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from stepramp.controllers.contract import FigureUnit, OwnTerms, PreviewItem, PushItem, PushPreview, PushReport
from stepramp.controllers.tic.ramp import (
    ACCELERATION_UNIT,
    SPEED_UNIT,
    TicRamp,
    figures_of,
    other_steps,
    tic_losses,
)
from stepramp.design import Design
from stepramp.errors import Count, Rejected, Rejection

FIGURES: tuple[tuple[str, FigureUnit, str, str], ...] = (
    ("Starting speed", "steps/s", "Starting speed", SPEED_UNIT),
    ("Full speed", "steps/s", "Max speed", SPEED_UNIT),
    ("Acceleration", "steps/s²", "Max acceleration", ACCELERATION_UNIT),
    ("Deceleration", "steps/s²", "Max deceleration", ACCELERATION_UNIT),
)
"""Of what TicRamp.figures has: name and unit, and both as the Tic has them."""
VOLATILE = "The Tic forgets these figures when it is reset or switched off."


@dataclass(frozen=True)
class PushPlan:
    """What will be sent for a design."""

    design: Design
    ramp: TicRamp
    microsteps: int
    """What the Tic makes of a full step."""

    @classmethod
    def of(cls, designs: Sequence[Design], first_axis: int | None, microsteps: int) -> "PushPlan":
        """Return the plan for the only axis; Rejected for others, and for what a Tic can't do."""
        if len(designs) != 1:
            raise Rejected(
                [Rejection("axes", Count(f"{len(designs)} designs"), "a list of 1 design: a Tic has one axis")]
            )
        if first_axis not in (None, 0):
            raise Rejected([Rejection("to_axis", first_axis, "0: a Tic has one axis")])
        return cls(designs[0], TicRamp.of(designs[0], "axes.0." if first_axis is None else ""), microsteps)

    @property
    def bytes(self) -> int:
        """Length of the commands that are sent [bytes]."""
        return sum(map(len, self.ramp.commands))

    def report(self, read_back: TicRamp) -> PushReport:
        """Return what came of the push."""
        return PushReport(
            items=tuple(self._items(read_back)),
            verified=read_back == self.ramp,
            segments=None,
            bytes=self.bytes,
            largest_deviation_us=None,
            sequence=None,
            kept=False,
            warnings=tuple(self._losses()),
        )

    def preview(self, present: TicRamp) -> PushPreview:
        """Return what the push would change of the ramp in use."""
        return PushPreview(
            items=tuple(
                PreviewItem(each.name, each.unit, each.read_back, each.sent, each.axis, each.own)
                for each in self._items(present)
            ),
            same=present == self.ramp,
            segments=None,
            bytes=self.bytes,
            largest_deviation_us=None,
            warnings=tuple(self._losses()),
        )

    def _items(self, present: TicRamp) -> Iterator[PushItem]:
        own = zip(self.ramp.units, present.units, strict=True)
        rows = zip(FIGURES, figures_of(self.design), self.ramp.figures, present.figures, own, strict=True)
        for (name, unit, term, own_unit), asked, sent, there, in_units in rows:
            yield PushItem(name, unit, asked, sent, there, 0, OwnTerms(term, own_unit, *in_units))

    def _losses(self) -> Iterator[str]:
        """Yield what works, but not as the design says."""
        yield from tic_losses(self.design)
        yield from other_steps(self.design, self.microsteps)
        yield VOLATILE
