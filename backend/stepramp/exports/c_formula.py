"""C99 code that computes a ramp step by step as planned, bit for bit, by the methods that have such code."""

from string import Template

import numpy as np

from stepramp.design import Design, MethodName
from stepramp.errors import Rejected, Rejection
from stepramp.exports.c_text import filled, heading, number, ramp_values, ticks_types
from stepramp.methods import METHODS
from stepramp.methods.common.fixed_point import EXPONENTS, RAMP_INDEX_BITS, Format, Output, Scaled
from stepramp.methods.common.method import Code, FixedCode
from stepramp.numerics.numbers import NUMBERS, Arithmetic, Number
from stepramp.ramp.plan import Plan, plan_of
from stepramp.ramp.slopes import constant_slopes_of
from stepramp.shapes.constant import ConstantAcceleration

CODES = {name: method.code for name, method in METHODS.items() if method.code}
"""The methods that have code, by name."""
TYPES: dict[Arithmetic, str] = {"float32": "float", "float64": "double"}
NO_STEPS = Format(Scaled(0, 0), Scaled(0, 0), 0, (Output(0, 0),) * EXPONENTS)
"""Of a side that is never asked for an interval."""


def formula_header(design: Design, method: MethodName, name: str, arithmetic: Arithmetic | None) -> str:
    """Return a C header that computes the design's ramp by a method that has code, for moves of any length.

    arithmetic: None for the design's own, when the method is its own, else for the one usual for the method.
    Raises Rejected as plan_of does, and when the ramp's shape isn't constant acceleration.
    """
    code = CODES[method]
    design = design.with_method(method, arithmetic)
    slopes = constant_slopes_of(design)
    if slopes is None:
        allowed = "constant, in code that computes the ramp; intervals and segments are of any shape"
        raise Rejected([Rejection("ramp.shape.name", design.ramp.shape.name, allowed)])
    plan, (up, down) = plan_of(design), slopes
    is_fixed = design.method.arithmetic == "fixed"
    values = heading(design, name, method) | ramp_values(design) | ticks_types(_longest(plan))
    values |= {"formula": code.title, "arithmetic": design.method.arithmetic, "checks": _checks(design)}
    values |= _rounding(design, name)
    values |= _fixed_numbers(design, plan) if is_fixed else {"number": TYPES[design.method.arithmetic]}
    values["slew"] = values.get("slew") or number(NUMBERS[design.method.arithmetic](up.slew_interval))
    if is_fixed:
        values["side"] = _fixed_side(values, code.fixed, up, down)
    else:
        values["side"] = _side(values, code, up, down, NUMBERS[design.method.arithmetic])
    return filled("recurrence.h", values)


def _longest(plan: Plan) -> int:
    """Return a bound for the intervals of all moves [ticks]; a carried remainder adds at most 1."""
    sides = (plan.ramp.up, plan.ramp.down)
    return max(plan.ramp.slew, *(int(side.max(initial=0)) for side in sides)) + 1


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


def _side(
    values: dict[str, str], code: Code, up: ConstantAcceleration, down: ConstantAcceleration, numbers: Number
) -> str:
    """Return one side of the ramp in floating-point numbers."""
    steps = {"up_steps": str(up.steps), "down_steps": str(down.steps)}
    constants = {"up_first": numbers(up.initial_interval)} | code.constants(up, down, numbers)
    literals = {name: number(constant) for name, constant in constants.items()}
    return Template(code.side).substitute(values | steps | literals)


def _fixed_numbers(design: Design, plan: Plan) -> dict[str, str]:
    """Return the type of an interval before rounding: only for carrying are the fractions of ticks kept."""
    if design.method.rounding == "carry":
        made = "return (double)interval / (double)((uint32_t)1 << output->fraction_bits);"
        return {"number": "double", "slew": number(np.float64(plan.real.slew)), "made": _indented([made])}
    half = " + ((uint32_t)1 << output->fraction_bits >> 1)" if design.method.rounding == "nearest" else ""
    made = f"return (uint32_t)(((uint64_t)interval{half}) >> output->fraction_bits);"
    return {"number": "uint32_t", "slew": str(plan.ramp.slew), "made": _indented([made])}


def _fixed_side(values: dict[str, str], code: FixedCode, up: ConstantAcceleration, down: ConstantAcceleration) -> str:
    """Return one side of the ramp in integers."""
    return filled(
        "fixed_side.h",
        values | {
            "side_fields": _indented(["int is_up;", Template(code.field).substitute(values)]),
            "up": _fixed_constants(up, code, is_up=True),
            "down": _fixed_constants(down, code, is_up=False),
            "state_fields": f"\n    {code.state_field}" if code.state_field else "",
            "state_values": f", {code.state_value}" if code.state_value else "",
            "change": Template(code.change).substitute(values),
        },
    )  # fmt: skip


def _fixed_constants(slope: ConstantAcceleration, code: FixedCode, *, is_up: bool) -> str:
    """Return the initialiser of a side, whole: C++ warns of what is left out."""
    form = Format.of(slope) if slope.steps else NO_STEPS
    first = form.longest if is_up else form.shortest
    index = form.first_ramp_index + (0 if is_up else slope.steps << RAMP_INDEX_BITS)
    own = ", ".join(str(each) if isinstance(each, int) else _braced(each) for each in code.constants(form, index))
    outputs = ", ".join(_braced(output) for output in form.outputs)
    return f"{{{slope.steps}, {int(is_up)}, {_braced(first)}, {int(is_up)}, {own}, {{{outputs}}}}}"


def _braced(pair: Scaled | tuple[int, int]) -> str:
    return f"{{{pair[0]}, {pair[1]}}}"


def _indented(lines: list[str]) -> str:
    return "\n".join(f"    {line}" for line in lines)
