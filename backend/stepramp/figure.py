"""Plotly figures of moves, for notebooks and pages."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from stepramp.ramp.error_curves import ErrorCurves
from stepramp.ramp.thinning import kept_steps
from stepramp.units import us_from_ticks

if TYPE_CHECKING:
    import plotly.graph_objects as go

TITLES = ("Velocity, steps/s", "Delay per step, µs", "Error against exact, %")
MOST_POINTS = 4000


def figure_of(moves: Sequence[ErrorCurves]) -> "go.Figure":
    """Return a figure with velocity, delay and error of moves above each other, a colour a method.

    Moves of more than 4,000 steps are thinned to about so many points that keep the curves' shapes.
    """
    import plotly.graph_objects as go  # noqa: PLC0415  # loads slowly, and only figures need it
    from plotly.colors import qualitative  # noqa: PLC0415
    from plotly.subplots import make_subplots  # noqa: PLC0415

    figure = make_subplots(rows=3, cols=1, shared_xaxes=True, vertical_spacing=0.06, subplot_titles=TITLES)
    for number, move in enumerate(moves):
        kept = kept_steps(move.relative_error, move.profile.phases, MOST_POINTS)
        curves = (
            move.profile.speed_steps_per_s[kept],
            us_from_ticks(1, move.timer_hz) * move.profile.intervals_ticks[kept],
            100 * move.relative_error[kept],
        )
        colour = qualitative.Safe[number % len(qualitative.Safe)]
        for row, curve in enumerate(curves, start=1):
            trace = go.Scatter(
                x=kept + 1, y=curve, name=move.method, legendgroup=move.method, showlegend=row == 1,
                mode="lines", line={"color": colour, "simplify": False},
            )  # fmt: skip
            figure.add_trace(trace, row=row, col=1)
    figure.update_yaxes(type="log", row=2, col=1)
    figure.update_xaxes(title_text="step", row=3, col=1)
    figure.update_layout(height=800, hovermode="x unified")
    return figure
