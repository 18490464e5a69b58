"""The pieces that exported C files share: templates, titles, numbers, types."""

from importlib.resources import files
from string import Template

import numpy as np

from stepramp.design import Design, RampShape
from stepramp.exports.names import comment_text
from stepramp.exports.shape_text import shape_text
from stepramp.version import __version__


def filled(template: str, values: dict[str, str]) -> str:
    """Return a template of this package with its placeholders filled."""
    text = (files("stepramp.exports") / "templates" / template).read_text(encoding="utf-8")
    return Template(text).substitute(values)


def heading(design: Design, name: str, kind: str) -> dict[str, str]:
    """Return what every header says at its top: whose ramp it is, and the names that it defines.

    kind: tells headers with the same names apart.
    """
    made = f"Made by StepRamp {__version__}; changes are best made there."
    title = comment_text(f"{design.name}. {made}" if design.name else made)
    return {"title": title, "name": name, "prefix": name.upper(), "guard": f"{name}_{kind}_H".upper()}


def ramp_values(design: Design) -> dict[str, str]:
    """Return the figures of a design's ramp, as decimal numbers."""
    ramp = design.ramp
    return {
        "timer_hz": number(np.float64(design.timer.frequency_hz)),
        "base_speed": f"{ramp.base_speed_steps_per_s:g}",
        "slew_speed": f"{ramp.slew_speed_steps_per_s:g}",
        "acceleration": f"{ramp.acceleration_steps_per_s2:g}",
        "deceleration": f"{ramp.slowdown_steps_per_s2:g}",
        # As before shapes, where there is nothing to tell.
        "shape": "" if ramp.shape == RampShape() else ";\n * " + shape_text(ramp.shape, design.move, _c_jerk),
        "rounding": {"nearest": "to the nearest tick", "floor": "down", "carry": "down, the remainder carried on"}[
            design.method.rounding
        ],
    }


def _c_jerk(jerk: float) -> str:
    return f"{jerk:g} steps/s^3"


def number(value: np.floating) -> str:
    """Return a floating-point constant of C that has exactly the value, in the value's own type.

    >>> number(np.float32(0.1)), number(np.float64(2e6))
    ('0.1f', '2000000.0')
    """
    return str(value) + ("f" if isinstance(value, np.float32) else "")


def ticks_in_words(ticks: int) -> str:
    """Return a number of ticks as it stands in a sentence.

    >>> ticks_in_words(1), ticks_in_words(0)
    ('1 tick', '0 ticks')
    """
    return f"{ticks} tick{'' if ticks == 1 else 's'}"


def ticks_types(most: int) -> dict[str, str]:
    """Return the types that hold intervals of up to `most` ticks, without and with sign, and the largest number."""
    unsigned, signed = ("32" if most < 2**bits else "64" for bits in (32, 31))
    return {"ticks_type": f"uint{unsigned}_t", "signed_type": f"int{signed}_t", "ticks_max": f"UINT{unsigned}_MAX"}
