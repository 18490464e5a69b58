"""Sentences about what a controller doesn't keep, with their quantities as data, to be told in other units."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from typing import Self

from stepramp.errors import StepUnit, Told

UNLIKE = "is not as in the backup."
"""How what a restore has left otherwise is told, behind its name."""


class Remark(str):
    """A sentence that knows which parts of it are quantities."""

    __slots__ = ("told",)
    told: tuple[Told, ...]
    """The quantities, in their order."""

    def __new__(cls, *parts: str | Told) -> Self:
        """Make a sentence of its parts."""
        remark = super().__new__(cls, "".join(map(str, parts)))
        remark.told = tuple(part for part in parts if isinstance(part, Told))
        return remark


class Unwritten(str):
    """A sentence on what a restore was to write, could be written, and is not as it was to be."""

    __slots__ = ()


class OnTrial(str):
    """A sentence about what is on trial, which holds no more once that is stored."""

    __slots__ = ()


def of_axis(axis: int, sentence: str) -> str:
    """Return a sentence about one of several axes as one that says which."""
    remark = Remark(f"Axis {axis}: {sentence}")
    remark.told = tuple(replace(each, axis=axis) for each in _told(sentence))
    return remark


def of_axes(losses: Mapping[int, Iterable[str]]) -> Iterator[str]:
    """Yield what axes lose, each sentence with the axes that it is about unless there is only one axis.

    What is said of several alike is said once; quantities are each axis' own.
    """
    about: dict[tuple[str, tuple[Told, ...], int | None], list[int]] = {}
    for axis, sentences in losses.items():
        for sentence in sentences:
            about.setdefault((sentence, _told(sentence), axis if _told(sentence) else None), []).append(axis)
    for (sentence, _, _), axes in about.items():
        if len(losses) == 1:
            yield sentence
        elif len(axes) == 1:
            yield of_axis(axes[0], sentence)
        else:
            yield f"Axes {', '.join(map(str, axes[:-1]))} and {axes[-1]}: {sentence}"


def told_in(sentences: Iterable[str]) -> tuple[tuple[Told, ...], ...]:
    """Return the quantities of each sentence."""
    return tuple(map(_told, sentences))


def quantity(value: float, unit: StepUnit, figures: int = 10) -> Told:
    """Return a quantity as sentences have it [its unit]."""
    return Told.of(value, unit, figures)


def _told(sentence: str) -> tuple[Told, ...]:
    return sentence.told if isinstance(sentence, Remark) else ()
