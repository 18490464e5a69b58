"""C99 code that computes a ramp step by step as planned, bit for bit: (20), (22), (23) and Newton's method."""

import math
from typing import Literal

import numpy as np

from stepramp.design import Arithmetic, Design
from stepramp.exports.c_text import filled, heading, number, ramp_values, ticks_types
from stepramp.ramp.fixed_point import COEFFICIENT_BITS, Format, Scaled
from stepramp.ramp.kinematics import Number, Slope
from stepramp.ramp.methods import COEFFICIENTS, NUMBERS
from stepramp.ramp.plan import Plan, plan_of

Formula = Literal["first_order", "second_order", "compromise", "newton"]
TITLES: dict[Formula, str] = {
    "first_order": "p = p (1 + q), formula (20)",
    "second_order": "p = p (1 + q + 1.5 q^2), formula (22)",
    "compromise": "p = p (1 + q + q^2), formula (23)",
    "newton": "p = p + p (1 - w p^2 / F^2) / 2, w = v^2 growing by 2 a a step (newton)",
}
SERIES: dict[Formula, str] = {
    "first_order": "1 + q",
    "second_order": "1 + q + {} * q * q",
    "compromise": "1 + q + q * q",
}
TYPES: dict[Arithmetic, str] = {"float32": "float", "float64": "double"}


def formula_header(design: Design, formula: Formula, name: str, arithmetic: Arithmetic | None) -> str:
    """Return a C header that computes the design's ramp by a formula, for moves of any length.

    arithmetic: None for the design's own, when the formula is its method, else for the one usual for the formula.
    Raises Rejected as plan_of does.
    """
    design = design.with_method(formula, arithmetic)
    plan = plan_of(design)
    up, down = (
        Slope(design.timer.frequency_hz, design.ramp.base_speed_steps_per_s, design.ramp.slew_speed_steps_per_s, rate)
        for rate in (design.ramp.acceleration_steps_per_s2, design.ramp.slowdown_steps_per_s2)
    )
    is_fixed = design.method.arithmetic == "fixed"
    values = heading(design, name, formula) | ramp_values(design) | ticks_types(_longest(plan))
    values |= {"formula": TITLES[formula], "arithmetic": design.method.arithmetic, "checks": _checks(design)}
    values |= _rounding(design, name)
    values |= _fixed_numbers(design, plan) if is_fixed else {"number": TYPES[design.method.arithmetic]}
    values["slew"] = values.get("slew") or number(NUMBERS[design.method.arithmetic](up.slew_interval))
    side = _fixed_side if is_fixed else _newton_side if formula == "newton" else _taylor_side
    values["side"] = side(values, design, formula, up, down)
    return filled("recurrence.h", values)


def _longest(plan: Plan) -> int:
    """Return a bound for the intervals of all moves [ticks]; a carried remainder adds at most 1."""
    sides = (plan.ramp.up, plan.ramp.down)
    return max(int(plan.ramp.slew), *(int(side.max(initial=0)) for side in sides)) + 1


def _checks(design: Design) -> str:
    """Return the lines that refuse a compiler in whose numbers the ramp would be another."""
    lines = []
    if design.method.arithmetic != "fixed":
        lines += [
            "#if FLT_EVAL_METHOD < 0 || FLT_EVAL_METHOD == 1 || FLT_EVAL_METHOD == 2",
            '#error "This ramp needs operations rounded to their own type; with GCC for x86: -msse2 -mfpmath=sse"',
            "#endif",
        ]
    if design.method.arithmetic == "float64" or design.method.rounding == "carry":
        lines += [
            "#if DBL_MANT_DIG < 53",
            '#error "This ramp needs double precision: choose float32 or fixed, and a rounding other than carry"',
            "#endif",
        ]
    return "".join(f"{line}\n" for line in lines)


def _rounding(design: Design, name: str) -> dict[str, str]:
    """Return how an interval becomes whole ticks; only carrying takes a sum along."""
    if design.method.rounding == "carry":
        lines = [
            "const uint64_t before = (uint64_t)*sum;",
            "*sum += (double)interval;",
            f"return ({name}_ticks)((uint64_t)*sum - before);",
        ]
        return {
            "whole": _indented(lines),
            "sum_parameter": ", double *sum",
            "sum_variable": "\n    double sum = 0;",
            "sum_argument": ", &sum",
            "sum_field": "\n    double sum; /* of the intervals so far [ticks] */",
            "sum_begin": "\n    move->sum = 0;",
            "sum_of_move": ", &move->sum",
        }
    if design.method.arithmetic == "fixed":
        lines = ["return interval;"]
    elif design.method.rounding == "floor":
        lines = [f"return ({name}_ticks)interval;"]
    elif design.method.arithmetic == "float64":
        lines = [f"return ({name}_ticks)(interval + 0.5);"]
    else:
        # In float, adding a half could round once more.
        lines = [
            f"const {name}_ticks whole = ({name}_ticks)interval;",
            "return interval - (float)whole < 0.5f ? whole : whole + 1;",
        ]
    none = dict.fromkeys(("parameter", "variable", "argument", "field", "begin", "of_move"), "")
    return {"whole": _indented(lines)} | {f"sum_{key}": value for key, value in none.items()}


def _taylor_side(values: dict[str, str], design: Design, formula: Formula, up: Slope, down: Slope) -> str:
    numbers = NUMBERS[design.method.arithmetic]
    return filled(
        "taylor_side.h",
        values | _common(up, down, numbers) | {
            "up_longest": number(numbers(up.initial_interval)),
            "down_longest": number(numbers(down.initial_interval)),
            "up_multiplier": number(numbers(-up.multiplier)),
            "down_multiplier": number(numbers(down.multiplier)),
            "series": SERIES[formula].format(number(numbers(1.5))),
        },
    )  # fmt: skip


def _newton_side(values: dict[str, str], design: Design, _: Formula, up: Slope, down: Slope) -> str:
    numbers = NUMBERS[design.method.arithmetic]
    base = up.base_speed**2
    return filled(
        "newton_side.h",
        values | _common(up, down, numbers) | {
            "up_w": number(numbers(base + 2 * up.acceleration)),
            "up_gain": number(numbers(2 * up.acceleration)),
            "down_w": number(numbers(base + 2 * down.acceleration * (down.steps + 1))),
            "down_gain": number(numbers(-2 * down.acceleration)),
            "k": number(numbers(1 / up.timer_hz**2)),
            "half": number(numbers(0.5)),
        },
    )  # fmt: skip


def _common(up: Slope, down: Slope, numbers: Number) -> dict[str, str]:
    return {
        "up_steps": str(up.steps),
        "down_steps": str(down.steps),
        "up_first": number(numbers(up.initial_interval)),
    }


def _fixed_numbers(design: Design, plan: Plan) -> dict[str, str]:
    """Return the type of an interval before rounding: only for carrying are the fractions of ticks kept."""
    if design.method.rounding == "carry":
        made = "return (double)interval / (double)((uint32_t)1 << output->fraction_bits);"
        return {"number": "double", "slew": number(np.float64(plan.real.slew)), "made": _indented([made])}
    half = " + ((uint32_t)1 << output->fraction_bits >> 1)" if design.method.rounding == "nearest" else ""
    made = f"return (uint32_t)(((uint64_t)interval{half}) >> output->fraction_bits);"
    return {"number": "uint32_t", "slew": str(plan.ramp.slew), "made": _indented([made])}


def _fixed_side(values: dict[str, str], _: Design, formula: Formula, up: Slope, down: Slope) -> str:
    is_newton = formula == "newton"
    fields = ["int is_up;", *(
        ["uint64_t k;            /* v^2 / 2 a there, in 2^-24 steps */"] if is_newton
        else ["struct {}_x shortest, longest; /* those of pS and of p1 */".format(values["name"])]
    )]  # fmt: skip
    parts = values | {
        "side_fields": _indented(fields),
        "up": _fixed_constants(up, is_up=True, is_newton=is_newton),
        "down": _fixed_constants(down, is_up=False, is_newton=is_newton),
        "way_fields": "\n    uint64_t k;" if is_newton else "",
        "way_values": ", side->k" if is_newton else "",
    }
    if is_newton:
        return filled("fixed_side.h", parts | {"change": filled("fixed_newton.h", values)})
    coefficient = str(round(math.ldexp(COEFFICIENTS[formula], COEFFICIENT_BITS)))
    return filled("fixed_side.h", parts | {"change": filled("fixed_taylor.h", values | {"coefficient": coefficient})})


def _fixed_constants(slope: Slope, *, is_up: bool, is_newton: bool) -> str:
    """Return the initialiser of a side; one without steps is never asked for an interval."""
    if slope.steps == 0:
        return "{0}"
    form = Format.of(slope)
    first = form.longest if is_up else form.shortest
    index = form.first_ramp_index + (0 if is_up else slope.steps << 24)
    own = str(index) if is_newton else f"{_braced(form.shortest)}, {_braced(form.longest)}"
    outputs = ", ".join(_braced(output) for output in form.outputs)
    return f"{{{slope.steps}, {int(is_up)}, {_braced(first)}, {int(is_up)}, {own}, {{{outputs}}}}}"


def _braced(pair: Scaled | tuple[int, int]) -> str:
    return f"{{{pair[0]}, {pair[1]}}}"


def _indented(lines: list[str]) -> str:
    return "\n".join(f"    {line}" for line in lines)
