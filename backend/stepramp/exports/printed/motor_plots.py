"""The plots of a report about the motor: its torque over the speed, and its load angle along the move."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stepramp.exports.printed.motor import MotorPart
from stepramp.exports.printed.numbers import plain

HAS_STYLE = {"color": "#1f6feb", "linewidth": 1.6}
ASKS_STYLE = {"color": "#b35900", "linewidth": 1.6, "linestyle": "--"}
ANGLE_STYLE = {"color": "#1f6feb", "linewidth": 1.2}


@dataclass(frozen=True)
class MotorPlot:
    """Curves over one quantity; arrays of shape (n,)."""

    title: str
    across: str
    """What it is over, with the unit."""
    curves: tuple[tuple[str, dict[str, Any], NDArray[np.float64], NDArray[np.float64]], ...]
    """Of each the label, the style, where it is, and what it is."""
    begins_at_zero: bool = False


def motor_plots_of(motor: MotorPart | None) -> list[MotorPlot]:
    """Return the plots that there are of a motor; none where its move couldn't be played."""
    if motor is None or motor.played is None:
        return []
    curve, angles = motor.played.torque, motor.played.load_angles_deg
    torque = (
        ("the motor has", HAS_STYLE, curve.rpm, curve.torques.pull_out_nm),
        ("the ramp asks for", ASKS_STYLE, curve.rpm, curve.torques.required_nm),
    )
    angle = (("load angle", ANGLE_STYLE, motor.played.steps.astype(float), angles),)
    return [
        MotorPlot("torque, Nm", "speed of the motor's shaft, rpm", torque, begins_at_zero=True),
        MotorPlot("load angle, electrical °; beyond 180° a step is lost", "step", angle),
    ]


def draw_motor(axes: Any, plot: MotorPlot) -> None:
    """Draw one plot of the motor."""
    from matplotlib.ticker import FuncFormatter  # noqa: PLC0415  # loads slowly

    for label, style, across, up in plot.curves:
        axes.plot(across, up, label=label, **style)
    axes.set_title(plot.title, loc="left", fontsize=10)
    axes.set_xlabel(plot.across, fontsize=9)
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_formatter(FuncFormatter(lambda value, _: plain(value)))
    axes.margins(x=0.01)
    if plot.begins_at_zero:
        axes.set_ylim(bottom=0)
    axes.tick_params(labelsize=8)


def described_motor(plot: MotorPlot) -> str:
    """Return in words what a plot shows: for those who don't see it."""
    parts = [
        f"{label} from {plain(float(up.min()), 3)} to {plain(float(up.max()), 3)}" for label, _, _, up in plot.curves
    ]
    return f"{plot.title}, over {plot.across}: {'; '.join(parts)}."
