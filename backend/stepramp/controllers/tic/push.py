"""Pushing a design to a Tic: what is sent, what came of it, and what of the design is lost."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from stepramp.controllers.contract import FigureUnit, PreviewItem, PushItem, PushPreview, PushReport
from stepramp.controllers.tic.ramp import TicRamp, figures_of
from stepramp.design import Design
from stepramp.errors import Rejected, Rejection
from stepramp.methods import METHODS

FIGURES: tuple[tuple[str, FigureUnit], ...] = (
    ("Starting speed", "steps/s"),
    ("Full speed", "steps/s"),
    ("Acceleration", "steps/s²"),
    ("Deceleration", "steps/s²"),
)
"""Names and units of what TicRamp.figures has."""


@dataclass(frozen=True)
class PushPlan:
    """What will be sent for a design."""

    design: Design
    ramp: TicRamp

    @classmethod
    def of(cls, designs: Sequence[Design], first_axis: int | None) -> "PushPlan":
        """Return the plan for the only axis; Rejected for others, and for what a Tic can't do."""
        if len(designs) != 1:
            raise Rejected([Rejection("axes", f"{len(designs)} designs", "a list of 1 design: a Tic has one axis")])
        if first_axis not in (None, 0):
            raise Rejected([Rejection("to_axis", first_axis, "0: a Tic has one axis")])
        return cls(designs[0], TicRamp.of(designs[0], "axes.0." if first_axis is None else ""))

    @property
    def bytes(self) -> int:
        """Length of the commands that are sent [bytes]."""
        return sum(map(len, self.ramp.commands))

    def report(self, read_back: TicRamp) -> PushReport:
        """Return what came of the push."""
        rows = zip(FIGURES, figures_of(self.design), self.ramp.figures, read_back.figures, strict=True)
        return PushReport(
            items=tuple(PushItem(name, unit, requested, sent, back, 0) for (name, unit), requested, sent, back in rows),
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
        rows = zip(FIGURES, present.figures, self.ramp.figures, strict=True)
        return PushPreview(
            items=tuple(PreviewItem(name, unit, there, sent, 0) for (name, unit), there, sent in rows),
            same=present == self.ramp,
            segments=None,
            bytes=self.bytes,
            largest_deviation_us=None,
            warnings=tuple(self._losses()),
        )

    def _losses(self) -> Iterator[str]:
        """Yield what works, but not as the design says."""
        method = self.design.method.name
        lost = "the lookup table" if method == "table" else f"the method {METHODS[method].label}"
        yield (
            f"A Tic computes its own ramp, of constant acceleration, from these four figures: {lost} and the "
            "intervals that it gives are not played."
        )
        yield "The Tic forgets these figures when it is reset or switched off."
