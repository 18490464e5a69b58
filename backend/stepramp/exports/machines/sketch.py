"""Sketches that have a library move a motor there and back: what they share."""

from collections.abc import Iterable
from textwrap import indent, wrap

from stepramp.design import Design
from stepramp.exports.c_text import filled, heading
from stepramp.exports.machines.sheet import WIDTH, Setting, Sheet, harmless

IN_A_COMMENT = " * "


def sketch(template: str, design: Design, name: str, values: dict[str, str], remarks: Iterable[str]) -> str:
    """Return a sketch of a template, with what every one of them says and does."""
    lines = [line for each in remarks for line in wrap(harmless(f"- {each}"), WIDTH, subsequent_indent="  ")]
    return filled(
        template,
        heading(design, name, "sketch") | {
            "steps": str(design.move.steps),
            "remarks": indent("\n".join(lines), IN_A_COMMENT),
            "button": filled("button.ino", {}),
            "there_and_back": filled("there_and_back.ino", {}),
        } | values,
    )  # fmt: skip


def of_a_library(
    template: str, design: Design, name: str, settings: Iterable[Setting], remarks: Iterable[str]
) -> Sheet:
    """Return a sketch whose template names a setting `$setMaxSpeed` as the library does."""
    settings, remarks = tuple(settings), tuple(remarks)
    values = {each.name: each.sent for each in settings}
    return Sheet(sketch(template, design, name, values, remarks), settings, remarks)
