"""What firmware/src/boards/avr/avr_limits.h says."""

import re
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Limits:
    """What avr_limits.h says."""

    shortest: tuple[int, ...]
    shortest_line: tuple[int, ...]
    shortest_formula: int


def read_limits() -> Limits:
    text = (Path(__file__).parents[3] / "firmware/src/boards/avr/avr_limits.h").read_text()
    said = {name: int(value) for name, value in re.findall(r"#define (\w+) (\d+)u\n", text)}
    return Limits(
        tuple(said[f"SHORTEST_INTERVAL_{name}_TICKS"] for name in ("1_AXIS", "2_AXES", "3_AXES", "4_AXES")),
        tuple(said[f"SHORTEST_INTERVAL_LINE_{axes}_TICKS"] for axes in (2, 3, 4)),
        said["SHORTEST_FORMULA_INTERVAL_TICKS"],
    )


LIMITS = read_limits()
