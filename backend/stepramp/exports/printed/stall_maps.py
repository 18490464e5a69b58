"""The stall maps of a report: pictures of verdicts that were played before, with the design as a point on them."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stepramp.design import Design
from stepramp.exports.printed.numbers import plain
from stepramp.motor.map_points import SPACINGS, Over, own_value
from stepramp.motor.map_ranges import UNITS
from stepramp.units import ShownUnits

VERDICTS = ("safe", "marginal", "stalls", "not possible")
COLOURS = ("#bfe3cb", "#f4d58d", "#d9897a", "#c9ced6")
"""From light to dark as it gets worse, so that a print without colour tells them apart."""
UNKNOWN = -1
OVER: dict[Over, str] = {"slew_speed": "slew speed", "load": "load", "supply_voltage": "supply"}
POINT_STYLE = {"marker": "X", "markersize": 10, "color": "#13171c", "markeredgecolor": "white", "linestyle": "none"}


@dataclass(frozen=True)
class StallMapPlot:
    """One map in the units of a report; n = cells + 1."""

    over: Over
    title: str
    across: str
    over_values: NDArray[np.float64]
    """Shape (n,)."""
    accelerations: NDArray[np.float64]
    """Shape (n,)."""
    verdicts: NDArray[np.int8]
    """Numbers of VERDICTS, or UNKNOWN; shape (n, n), a row for each acceleration."""
    point: tuple[float, float]
    """Where the design is: of what it goes over, and its acceleration."""


@dataclass(frozen=True)
class PlayedMap:
    """A map as it was computed, in steps and seconds."""

    over: Over
    over_values: tuple[float, ...]
    accelerations_steps_per_s2: tuple[float, ...]
    verdicts: tuple[tuple[int, ...], ...]


def stall_map_plot(played: PlayedMap, design: Design, units: ShownUnits) -> StallMapPlot:
    """Return a design's map as it is drawn."""
    over = units.factor("speed") if played.over == "slew_speed" else 1.0
    unit = units.word("speed") if played.over == "slew_speed" else UNITS[played.over]
    up = units.factor("acceleration")
    return StallMapPlot(
        over=played.over,
        title=f"stall map: acceleration, {units.word('acceleration')}, over {OVER[played.over]}",
        across=f"{OVER[played.over]}, {unit}",
        over_values=over * np.array(played.over_values),
        accelerations=up * np.array(played.accelerations_steps_per_s2),
        verdicts=np.array(played.verdicts, np.int8),
        point=(over * own_value(design, played.over), up * design.ramp.acceleration_steps_per_s2),
    )


def draw_stall_map(axes: Any, plot: StallMapPlot) -> None:
    """Draw one map."""
    from matplotlib.colors import ListedColormap  # noqa: PLC0415  # loads slowly
    from matplotlib.ticker import FuncFormatter, NullFormatter  # noqa: PLC0415

    known = np.ma.masked_equal(plot.verdicts, UNKNOWN)
    colours = ListedColormap(COLOURS)
    axes.pcolormesh(
        plot.over_values, plot.accelerations, known, cmap=colours, vmin=-0.5, vmax=3.5, shading="nearest",
        rasterized=True,
    )  # fmt: skip
    axes.set_yscale("log")
    if SPACINGS[plot.over] != "even":
        axes.set_xscale("log")
    axes.plot(*plot.point, label="this design", **POINT_STYLE)
    for number in sorted({int(each) for each in plot.verdicts.flat if each != UNKNOWN}):
        style = {"marker": "s", "markersize": 9, "color": COLOURS[number], "markeredgecolor": "#7a8491"}
        axes.plot([], [], linestyle="none", label=VERDICTS[number], **style)
    axes.set_title(plot.title, loc="left", fontsize=10)
    axes.set_xlabel(plot.across, fontsize=9)
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_formatter(FuncFormatter(lambda value, _: plain(value)))
        axis.set_minor_formatter(NullFormatter())
    axes.tick_params(labelsize=8)


def described_stall_map(plot: StallMapPlot) -> str:
    """Return in words what a map shows: for those who don't see it."""
    known = plot.verdicts[plot.verdicts != UNKNOWN]
    shares = [(name, float(np.mean(known == number))) for number, name in enumerate(VERDICTS)] if known.size else []
    parts = ", ".join(f"{plain(100 * share, 2)} % {name}" for name, share in shares if share)
    accelerations = f"from {plain(float(plot.accelerations[0]), 3)} to {plain(float(plot.accelerations[-1]), 3)}"
    over = f"from {plain(float(plot.over_values[0]), 3)} to {plain(float(plot.over_values[-1]), 3)}"
    at = f"{plain(plot.point[0], 3)} and {plain(plot.point[1], 3)}"
    return f"{plot.title}, {accelerations}; {plot.across} {over}: {parts or 'nothing is known'}; this design at {at}."
