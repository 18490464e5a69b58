"""The plots as a picture: velocity, delay and error over steps, drawn by matplotlib."""

import io
from collections.abc import Sequence
from typing import Literal

from stepramp.exports.matplotlib_turn import matplotlib_turn, style_of
from stepramp.ramp.error_curves import ErrorCurves
from stepramp.ramp.thinning import kept_steps
from stepramp.units import us_from_ticks

PictureFormat = Literal["png", "svg"]
INCHES = (10.0, 9.0)
DOTS_PER_INCH = 150
MOST_POINTS = 4000


def picture_of(moves: Sequence[ErrorCurves], file_format: PictureFormat) -> bytes:
    """Return velocity, delay and error of moves above each other as a file; the same moves give the same bytes.

    Moves of more than 4,000 steps are thinned to about so many points that keep the curves' shapes.
    """
    from matplotlib.figure import Figure  # noqa: PLC0415  # loads slowly, and only pictures need it

    out = io.BytesIO()
    with matplotlib_turn():
        figure = Figure(figsize=INCHES, dpi=DOTS_PER_INCH, layout="constrained")
        velocity, delay, error = figure.subplots(3, 1, sharex=True)
        for move in moves:
            kept = kept_steps(move.relative_error, move.profile.phases, MOST_POINTS)
            intervals_us = us_from_ticks(1, move.timer_hz) * move.profile.intervals_ticks[kept]
            curves = (move.profile.speed_steps_per_s[kept], intervals_us, 100 * move.relative_error[kept])
            style = style_of(move.method)
            for axes, curve in zip((velocity, delay, error), curves, strict=True):
                axes.plot(kept + 1, curve, label=move.method, **style)
        velocity.set_ylabel("velocity [steps/s]")
        delay.set_ylabel("delay per step [µs]")
        delay.set_yscale("log")
        error.set_ylabel("error against exact [%]")
        error.set_xlabel("step")
        figure.legend(*velocity.get_legend_handles_labels(), loc="outside upper center", ncols=5, frameon=False)
        # Without the date the same design gives the same file.
        figure.savefig(out, format=file_format, metadata={"Date": None} if file_format == "svg" else {"Software": None})
    return out.getvalue()
