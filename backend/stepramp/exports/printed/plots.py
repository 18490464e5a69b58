"""The plots of a report, drawn into matplotlib's axes; to be called in matplotlib's turn."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stepramp.exports.printed.content import Line, Report
from stepramp.exports.printed.numbers import plain

FEW_TICKS_RATIO = 5
"""Below this ratio of largest to smallest, a logarithmic axis has ticks also between 1, 2 and 5."""
LONGEST_IN_LEGEND = 40
"""[characters]; tables have the whole name."""


@dataclass(frozen=True)
class Plot:
    """One plot: what it shows, over the steps of the move."""

    name: str
    title: Callable[[Report], str]
    curve: Callable[[Line], NDArray[np.float64] | None]
    """None: of this line it isn't shown."""
    is_logarithmic: bool = False

    def curves(self, report: Report) -> list[tuple[Line, NDArray[np.float64]]]:
        """Return the lines that are shown in it, with what is shown of them."""
        curves = [(line, self.curve(line)) for line in report.lines]
        return [(line, curve) for line, curve in curves if curve is not None]


PLOTS = (
    Plot("velocity", lambda report: f"velocity, {report.units.word('speed')}", lambda line: line.speed),
    Plot("delay", lambda _: "delay of a step, µs", lambda line: line.delay_us, is_logarithmic=True),
    Plot("error", lambda _: "error of the delay against exact, %", lambda line: line.error_percent),
    Plot(
        "acceleration",
        lambda report: f"acceleration as planned, {report.units.word('acceleration')}",
        lambda line: line.acceleration,
    ),
    Plot("jerk", lambda report: f"jerk as planned, {report.units.word('jerk')}", lambda line: line.jerk),
)


def plots_of(report: Report) -> list[Plot]:
    """Return the plots that have anything to show."""
    return [plot for plot in PLOTS if plot.curves(report)]


def draw(axes: Any, plot: Plot, report: Report) -> None:
    """Draw one plot of a report."""
    from matplotlib.ticker import FuncFormatter  # noqa: PLC0415  # loads slowly

    curves = plot.curves(report)
    for line, curve in curves:
        axes.plot(line.step, curve, label=_legend_text(line.label), **line.style)
    axes.set_title(plot.title(report), loc="left", fontsize=10)
    if plot.is_logarithmic:
        _scale_logarithmically(axes, np.concatenate([curve for _, curve in curves]))
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_formatter(FuncFormatter(lambda value, _: plain(value)))
    axes.margins(x=0.01)
    axes.tick_params(labelsize=8)


def _scale_logarithmically(axes: Any, values: NDArray[np.float64]) -> None:
    """Make the vertical axis logarithmic, with plain numbers at 1, 2, 5 and their tenfolds."""
    from matplotlib.ticker import LogLocator, NullFormatter  # noqa: PLC0415  # loads slowly

    axes.set_yscale("log")
    is_wide = values.max() / values.min() > FEW_TICKS_RATIO
    axes.yaxis.set_major_locator(LogLocator(subs=(1, 2, 5) if is_wide else range(1, 10), numticks=20))
    axes.yaxis.set_minor_formatter(NullFormatter())


def described(plot: Plot, report: Report) -> str:
    """Return in words what a plot shows: for those who don't see it."""
    parts = []
    for line, curve in plot.curves(report):
        parts.append(f"{line.label} from {plain(float(curve.min()), 3)} to {plain(float(curve.max()), 3)}")
    return f"{plot.title(report)}, over {report.lines[0].step[-1]:,} steps: {'; '.join(parts)}."


def printable(text: str) -> str:
    """Return a text with a mark in place of each character that the font lacks."""
    from matplotlib.font_manager import findfont, get_font  # noqa: PLC0415  # loads slowly

    font = get_font(findfont("DejaVu Sans"))
    line = "".join(each if each.isprintable() else " " for each in text)
    return "".join(each if font.get_char_index(ord(each)) else "\N{REPLACEMENT CHARACTER}" for each in line)


def _legend_text(text: str) -> str:
    """Return a text, shortened, in which matplotlib finds no formula, and no entry to be left out."""
    short = text if len(text) <= LONGEST_IN_LEGEND else text[: LONGEST_IN_LEGEND - 1] + "…"
    return printable(short).replace("$", r"\$").lstrip("_")
