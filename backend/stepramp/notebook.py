"""StepRamp from Python: a design that plans its move, and a profile that compares and draws itself."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, ValidationError

from stepramp import design as document
from stepramp.design import MethodName, Schema
from stepramp.figure import figure_of
from stepramp.methods import REFERENCE
from stepramp.ramp.error_curves import ErrorCurves, error_curves
from stepramp.ramp.profile import Phase, Profile, profile_of
from stepramp.ramp.timer_limits import TimerWarning
from stepramp.validation import rejected

if TYPE_CHECKING:
    import plotly.graph_objects as go


class Design(document.Design):
    """A design document, made from its parts; see stepramp.design for them.

    Raises Rejected, naming each field, its value and what is allowed.

    >>> design = Design(
    ...     timer={"frequency_hz": 2_000_000},
    ...     ramp={"slew_speed_steps_per_s": 1000, "acceleration_steps_per_s2": 5000},
    ...     move={"steps": 500},
    ... )
    >>> design.ramp.slew_speed_steps_per_s
    1000.0
    >>> Design(timer={"frequency_hz": 0}, ramp=design.ramp, move=design.move)
    Traceback (most recent call last):
    stepramp.errors.Rejected: timer.frequency_hz is 0; allowed: a number from 1,000 to 1,000,000,000 Hz.
    """

    schema_: Schema = Field("stepramp/2", alias="schema", description="Name and version of the document's format")

    def __init__(self, **parts: object) -> None:
        try:
            super().__init__(**parts)
        except ValidationError as error:
            raise rejected(error.errors(include_url=False)) from None

    def profile(self) -> "PlannedMove":
        """Plan the move.

        Raises Rejected when the ramp can't be made, as an acceleration so small that the ramp takes more than
        10,000,000 steps.
        """
        return PlannedMove(self, profile_of(self))


@dataclass(frozen=True)
class PlannedMove:
    """A design's move of N steps, and what can be asked about it."""

    design: document.Design
    profile: Profile

    @property
    def intervals_ticks(self) -> NDArray[np.int64]:
        """Wait after each pulse [ticks], shape (N,)."""
        return self.profile.intervals_ticks

    @property
    def time_s(self) -> NDArray[np.float64]:
        """Instant of each pulse, the first at 0 [s], shape (N,)."""
        return self.profile.time_s

    @property
    def position_steps(self) -> NDArray[np.int64]:
        """Position after each pulse [steps], shape (N,)."""
        return self.profile.position_steps

    @property
    def speed_steps_per_s(self) -> NDArray[np.float64]:
        """Speed of each interval, v = F / p, formula (7) [steps/s], shape (N,)."""
        return self.profile.speed_steps_per_s

    @property
    def duration_s(self) -> float:
        """From pulse 1 to the end of the last interval [s]."""
        return self.profile.duration_s

    @property
    def phases(self) -> tuple[Phase, ...]:
        """Acceleration, slew and deceleration, as far as the move has them."""
        return self.profile.phases

    @property
    def warnings(self) -> tuple[TimerWarning, ...]:
        """What works, but not as the design says, and what to change."""
        return self.profile.warnings

    def errors(self, reference: MethodName = REFERENCE, method: MethodName | None = None) -> ErrorCurves:
        """Compare the move, or the one by another method, with a reference, step by step.

        >>> design = Design(
        ...     timer={"frequency_hz": 1_000_000},
        ...     ramp={"slew_speed_steps_per_s": 2000, "acceleration_steps_per_s2": 4000},
        ...     move={"steps": 1200},
        ... )
        >>> worst = design.profile().errors(method="compromise").largest_relative_error
        >>> f"{worst.value:+.1%} at step {worst.step}"
        '-19.0% at step 1200'
        """
        return error_curves(self.design, method or self.design.method.name, reference)

    def figure(self, methods: Sequence[MethodName] = ()) -> "go.Figure":
        """Draw velocity, delay and error of the move, and of other methods beside it, as a Plotly figure.

        >>> design = Design(
        ...     timer={"frequency_hz": 1_000_000},
        ...     ramp={"slew_speed_steps_per_s": 2000, "acceleration_steps_per_s2": 4000},
        ...     move={"steps": 1200},
        ... )
        >>> [trace.name for trace in design.profile().figure(["newton"]).data]
        ['exact', 'exact', 'exact', 'newton', 'newton', 'newton']
        """
        names = dict.fromkeys([self.design.method.name, *methods])
        return figure_of([error_curves(self.design, name, REFERENCE) for name in names])
