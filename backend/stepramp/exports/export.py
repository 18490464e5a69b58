"""The formats that a design is exported in, by name."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated

from stepramp.design import Design, MethodName
from stepramp.exports.arduino import arduino_library_sketch, arduino_sketch
from stepramp.exports.c_formula import CODES, formula_header
from stepramp.exports.c_ramp_image import ramp_image_header
from stepramp.exports.c_segments import segments_header
from stepramp.exports.c_table import table_header
from stepramp.exports.listing import csv, document
from stepramp.exports.machines.machines import MACHINES, Machine
from stepramp.exports.machines.sheet import AxisLetter, Sheet
from stepramp.exports.names import identifier_of
from stepramp.exports.picture import picture_of
from stepramp.exports.zoomable_page import zoomable_page
from stepramp.methods import REFERENCE
from stepramp.numerics.numbers import Arithmetic
from stepramp.ramp.error_curves import ErrorCurves, judged_against, reference_intervals
from stepramp.validation import OneOf


@dataclass(frozen=True)
class Options:
    """What is wanted besides the design."""

    name: str | None = None
    """Begin of the names in C and of the file's name; None: made of the design's name."""
    methods: tuple[MethodName, ...] = ()
    """Methods that pages and pictures compare the design's own with."""
    arithmetic: Arithmetic | None = None
    """Of the C code of a formula; None: the design's own for its own method, else the one usual for the formula."""
    segment_bound_ticks: int = 0
    """How far intervals of segments may be from the planned ones [ticks]."""
    axis_letter: AxisLetter = "X"
    """Which axis of a machine that ramps by itself the design is for."""


@dataclass(frozen=True)
class Exported:
    """A file, complete."""

    file_name: str
    media_type: str
    content: bytes


@dataclass(frozen=True)
class _Format:
    ending: str
    media_type: str
    make: Callable[[Design, str, Options], str | bytes]


HEADER, TEXT = "text/x-c; charset=utf-8", "charset=utf-8"


def format_of(method: MethodName) -> str:
    """Return the format that is a method's C code."""
    return f"c_{method}"


def _code_of(method: MethodName) -> _Format:
    return _Format(
        f"_{method}.h",
        HEADER,
        lambda design, name, options: formula_header(design, method, name, options.arithmetic),
    )


def _settings_of(machine: Machine) -> _Format:
    return _Format(
        machine.ending,
        HEADER if machine.is_code else f"text/plain; {TEXT}",
        lambda design, name, options: machine.make(design, name, options.axis_letter).text,
    )


_FORMATS: dict[str, _Format] = {
    "c_table": _Format("_table.h", HEADER, lambda design, name, _: table_header(design, name, in_progmem=False)),
    "c_table_progmem": _Format(
        "_table_progmem.h", HEADER, lambda design, name, _: table_header(design, name, in_progmem=True)
    ),
    "c_segments": _Format(
        "_segments.h", HEADER, lambda design, name, options: segments_header(design, name, options.segment_bound_ticks)
    ),
    "c_ramp_image": _Format(
        "_ramp_image.h",
        HEADER,
        lambda design, name, options: ramp_image_header(design, name, options.segment_bound_ticks),
    ),
    **{format_of(method): _code_of(method) for method in CODES},
    "arduino": _Format(
        ".ino", HEADER, lambda design, name, options: arduino_sketch(design, name, options.segment_bound_ticks)
    ),
    "arduino_library": _Format(
        "_library.ino",
        HEADER,
        lambda design, name, options: arduino_library_sketch(design, name, options.segment_bound_ticks),
    ),
    **{name: _settings_of(machine) for name, machine in MACHINES.items()},
    "csv": _Format(".csv", f"text/csv; {TEXT}", lambda design, *_: csv(design)),
    "json": _Format(".json", "application/json", lambda design, *_: document(design)),
    "html": _Format(
        ".html", f"text/html; {TEXT}", lambda design, _, options: zoomable_page(design, _moves(design, options))
    ),
    "svg": _Format(".svg", "image/svg+xml", lambda design, _, options: picture_of(_moves(design, options), "svg")),
    "png": _Format(".png", "image/png", lambda design, _, options: picture_of(_moves(design, options), "png")),
}

FORMAT_NAMES = tuple(_FORMATS)
FormatName = Annotated[str, OneOf(FORMAT_NAMES)]
MachineName = Annotated[str, OneOf(MACHINES)]

MEDIA_TYPES = tuple(sorted({each.media_type.partition(";")[0] for each in _FORMATS.values()}))
"""Of all formats."""


def export(design: Design, format_name: FormatName, options: Options) -> Exported:
    """Return a design in a format.

    Raises Rejected when the design can't be planned, or lacks what the format is about.
    """
    chosen = _FORMATS[format_name]
    name = options.name or identifier_of(design.name)
    content = chosen.make(design, name, options)
    return Exported(
        file_name=f"{name}{chosen.ending}",
        media_type=chosen.media_type,
        content=content.encode() if isinstance(content, str) else content,
    )


def sheet_of(design: Design, machine_name: MachineName, options: Options) -> tuple[str, Sheet]:
    """Return the name of the file for a machine that ramps by itself, and what it says with its figures and losses.

    Raises Rejected for what the machine can't take.
    """
    machine = MACHINES[machine_name]
    name = options.name or identifier_of(design.name)
    return f"{name}{machine.ending}", machine.make(design, name, options.axis_letter)


def _moves(design: Design, options: Options) -> list[ErrorCurves]:
    methods = dict.fromkeys((design.method.name, *options.methods))
    reference_ticks = reference_intervals(design, REFERENCE)
    return [judged_against(reference_ticks, design.with_method(method)) for method in methods]
