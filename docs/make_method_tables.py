"""Write the tables of docs/methods.md.

usage: python docs/make_method_tables.py
"""

from pathlib import Path

import numpy as np

from stepramp.design import Design
from stepramp.methods import METHODS, REFERENCE
from stepramp.numerics.ramp import RealRamp
from stepramp.ramp.plan import real_ramp

PAGE = Path(__file__).with_name("methods.md")
MARK = "<!-- tables -->\n"

RAMPS = {
    "From rest: v0 0, v 2000 steps/s, a 4000 steps/s², F 1 MHz": (0, 2000, 4000),
    "With a base speed: v0 100, v 2000 steps/s, a 4000 steps/s², F 1 MHz": (100, 2000, 4000),
    "A gauge: v0 200, v 1666 steps/s, a 8000 steps/s², F 1 MHz": (200, 1666, 8000),
}


def tables() -> str:
    """Return a table for each ramp, as Markdown."""
    return "\n".join(f"### {title}\n\n{_table(*speeds)}" for title, speeds in RAMPS.items())


def _table(base: float, slew: float, acceleration: float) -> str:
    design = Design.checked(
        {
            "schema": "stepramp/1",
            "timer": {"frequency_hz": 1_000_000},
            "ramp": {
                "base_speed_steps_per_s": base,
                "slew_speed_steps_per_s": slew,
                "acceleration_steps_per_s2": acceleration,
            },
            "table": {"rows": [[10, 5000], [30, 1500], [100, 1000], [150, 800], [300, 600]]},
            "move": {"steps": 1200},
        }
    )
    exact = real_ramp(design.with_method(REFERENCE))
    lines = [
        "| method | arithmetic | up | at step | down | at step from the end | time |",
        "|---|---|--:|--:|--:|--:|--:|",
    ]
    for name, method in METHODS.items():
        ramp = real_ramp(design.with_method(name))
        sides = [_largest(ramp.up, exact.up), _largest(ramp.down, exact.down)]
        # Sides of different lengths end at slew speed: what is missing runs at the slew interval.
        length = max(each.size for each in (ramp.up, ramp.down, exact.up, exact.down))
        spent, wanted = (_time(each, length) for each in (ramp, exact))
        figures = " | ".join(f"{error:+.1%} | {step}" for error, step in sides)
        lines.append(f"| {name} | {method.arithmetics[0]} | {figures} | {spent / wanted - 1:+.2%} |")
    return "\n".join(lines) + "\n"


def _largest(side: np.ndarray, exact: np.ndarray) -> tuple[float, int]:
    size = min(side.size, exact.size)
    error = side[:size].astype(np.float64) / exact[:size] - 1
    at = int(np.abs(error).argmax())
    return float(error[at]), at + 1


def _time(ramp: RealRamp, length: int) -> float:
    missing = 2 * length - ramp.up.size - ramp.down.size
    return float(ramp.up.sum(dtype=np.float64) + ramp.down.sum(dtype=np.float64)) + missing * ramp.slew


if __name__ == "__main__":
    text = PAGE.read_text(encoding="utf-8")
    PAGE.write_text(text[: text.index(MARK)] + MARK + "\n" + tables(), encoding="utf-8")
