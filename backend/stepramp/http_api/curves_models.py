"""What the route for plots answers: described for the API's page, and filled from error curves.

The answer is columns of numbers as short as they can be written: instants and intervals as whole ticks, exact, and
what is only drawn as 32-bit floats. Speeds and positions are left to whoever draws: F / p (7), and the step itself.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, Field

from stepramp.design import MethodName
from stepramp.errors import Rejected
from stepramp.http_api.planning_models import (
    ErrorFiguresAnswer,
    MethodFailure,
    PhaseAnswer,
    SummaryAnswer,
    WarningAnswer,
    failure_content,
    figures_content,
    summary_content,
    warnings_content,
)
from stepramp.ramp.drawing import Drawing


class PartsAnswer(BaseModel):
    """Where the error of each interval comes from; the first three together are that of the planned interval."""

    method: list[float] = Field(description="Part of the method itself [ticks]")
    arithmetic: list[float] = Field(description="Part of the arithmetic [ticks]")
    rounding: list[float] = Field(description="Part of the rounding [ticks]")
    compression: list[float] = Field(description="Part of the segments [ticks]")


class MethodCurvesAnswer(ErrorFiguresAnswer):
    """One method's move, thinned. A run of equal intervals has its two ends; between two steps, lines are straight."""

    method: MethodName
    step: list[int] = Field(description="Which steps the arrays are of, counted from 1 [steps]")
    intervals_ticks: list[int] = Field(description="Wait after the pulse of each step [ticks]")
    start_ticks: list[int] = Field(description="Instant of the pulse of each step [ticks]")
    relative_error: list[float] = Field(description="Interval over reference interval, less 1: 0.01 is 1 % too long")
    implied_acceleration_steps_per_s2: list[float] | None = Field(
        None, description="(v_i² - v_(i-1)²) / 2; left out unless asked for [steps/s²]"
    )
    parts: PartsAnswer | None = Field(None, description="Left out unless asked for")
    phases: list[PhaseAnswer] = Field(description="Stretches of the move that have steps, in order of time")
    summary: SummaryAnswer
    warnings: list[WarningAnswer]


class CurvesAnswer(BaseModel):
    """A design's move by several methods, ready to be drawn."""

    reference: MethodName
    timer_hz: float = Field(description="Ticks a second [Hz]")
    direction: int = Field(description="1 forwards, -1 backwards: the position after step i is i times this")
    methods: list[MethodCurvesAnswer] = Field(description="In the order asked for, without those that failed")
    failures: list[MethodFailure] = Field(description="Methods that don't fit the design, and why")


def curves_content(drawing: Drawing) -> dict[str, Any]:
    """Return a drawing as a CurvesAnswer's content; its methods are computed one by one."""
    methods: list[dict[str, Any]] = []
    failures: list[dict[str, Any]] = []
    for method, drawn in drawing.methods():
        if isinstance(drawn, Rejected):
            failures.append(failure_content(method, drawn))
            continue
        kept, judged, profile = drawn.kept, drawn.judged, drawn.judged.profile
        methods.append(
            {
                "method": method,
                "step": kept + 1,
                "intervals_ticks": judged.played_ticks[kept],
                "start_ticks": drawn.start_ticks,
                "relative_error": _short(judged.relative_error[kept]),
                "phases": [vars(phase) for phase in profile.phases],
                "summary": summary_content(profile),
                "warnings": warnings_content(profile),
                **figures_content(judged),
            }
        )
        if drawing.with_acceleration:
            methods[-1]["implied_acceleration_steps_per_s2"] = _short(judged.implied_acceleration_steps_per_s2[kept])
        if drawn.parts is not None:
            methods[-1]["parts"] = {name: _short(part[kept]) for name, part in vars(drawn.parts).items()}
    return {
        "reference": drawing.reference,
        "timer_hz": drawing.design.timer.frequency_hz,
        "direction": 1 if drawing.design.move.steps > 0 else -1,
        "methods": methods,
        "failures": failures,
    }


def _short(curve: NDArray[np.float64]) -> NDArray[np.float32]:
    """Return numbers that are only drawn in the precision that a screen can show many times over."""
    return curve.astype(np.float32)
