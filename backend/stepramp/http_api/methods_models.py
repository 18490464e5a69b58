"""What the route of the methods answers."""

from typing import Self

from pydantic import Field

from stepramp.design import MethodName
from stepramp.exports.export import format_of
from stepramp.http_api.answer import Answer
from stepramp.methods import METHODS, REFERENCE
from stepramp.methods.common.method import Code, RampMethod
from stepramp.numerics.numbers import Arithmetic


class StyleAnswer(Answer):
    """How a method's line is drawn."""

    light: str = Field(description="Colour on a light ground")
    dark: str = Field(description="Colour on a dark ground")
    dash: tuple[float, ...] | None = Field(description="Dashes and gaps in turn; null: solid [px]")


class CodeAnswer(Answer):
    """A method's C code, which is a format of exports."""

    format: str = Field(description="Of POST /export")
    label: str
    help: str

    @classmethod
    def of(cls, name: MethodName, code: Code) -> Self:
        """Return what is told of a method's code."""
        return cls(format=format_of(name), label=code.label, help=code.help)


class MethodAnswer(Answer):
    """A method, and what people are told of it."""

    name: MethodName
    label: str
    formula: str = Field(description="Its number in Eiderman's paper; empty: none")
    help: str = Field(description="What it is good for")
    arithmetics: list[Arithmetic] = Field(description="Those that it can be computed in, the usual one first")
    style: StyleAnswer
    plays_table: bool = Field(description="Whether it is not computed, but the design's lookup table")
    is_tuned: bool = Field(description="Whether the design's method.tuned_for counts")
    is_shown_at_first: bool = Field(description="Whether the page shows it until a person chooses")
    code: CodeAnswer | None = Field(description="Null: it has no C code of its own")

    @classmethod
    def of(cls, name: MethodName, method: RampMethod) -> Self:
        """Return what is told of a method."""
        style = method.style
        return cls(
            name=name,
            label=method.label,
            formula=method.formula,
            help=method.help,
            arithmetics=list(method.arithmetics),
            style=StyleAnswer(light=style.light, dark=style.dark, dash=style.dash),
            plays_table=method.sides is None,
            is_tuned=method.tuning is not None,
            is_shown_at_first=method.is_shown_at_first,
            code=method.code and CodeAnswer.of(name, method.code),
        )


class MethodsAnswer(Answer):
    """The methods, in the order in which people are shown them."""

    reference: MethodName = Field(description="The one that others are compared with, unless another is asked for")
    methods: list[MethodAnswer]

    @classmethod
    def of_all(cls) -> Self:
        """Return what is told of the methods that there are."""
        return cls(reference=REFERENCE, methods=[MethodAnswer.of(name, method) for name, method in METHODS.items()])
