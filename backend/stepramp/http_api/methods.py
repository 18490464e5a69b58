"""The route that tells what methods there are: the page's list, and that of any other program."""

from fastapi import APIRouter
from pydantic import BaseModel, Field

from stepramp.design import MethodName
from stepramp.exports.export import format_of
from stepramp.http_api.bodies import JsonRoute
from stepramp.methods import METHODS, REFERENCE
from stepramp.methods.common.method import Code, RampMethod
from stepramp.numerics.numbers import Arithmetic

router = APIRouter(tags=["planning"], route_class=JsonRoute)


class StyleAnswer(BaseModel):
    """How a method's line is drawn."""

    light: str = Field(description="Colour on a light ground")
    dark: str = Field(description="Colour on a dark ground")
    dash: tuple[float, float] | None = Field(description="Dash and gap; null: solid [px]")


class CodeAnswer(BaseModel):
    """A method's C code, which is a format of exports."""

    format: str = Field(description="Of POST /export")
    label: str
    help: str


class MethodAnswer(BaseModel):
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


class MethodsAnswer(BaseModel):
    """The methods, in the order in which people are shown them."""

    reference: MethodName = Field(description="The one that others are compared with, unless another is asked for")
    methods: list[MethodAnswer]


@router.get("/methods")
async def methods() -> MethodsAnswer:
    """Return the methods that a ramp can be computed by."""
    return methods_answer()


def methods_answer() -> MethodsAnswer:
    """Return what is told of the methods."""
    return MethodsAnswer(reference=REFERENCE, methods=[_answer(name, method) for name, method in METHODS.items()])


def _answer(name: MethodName, method: RampMethod) -> MethodAnswer:
    style = method.style
    return MethodAnswer(
        name=name,
        label=method.label,
        formula=method.formula,
        help=method.help,
        arithmetics=list(method.arithmetics),
        style=StyleAnswer(light=style.light, dark=style.dark, dash=style.dash),
        plays_table=method.sides is None,
        is_tuned=method.tuning is not None,
        is_shown_at_first=method.is_shown_at_first,
        code=method.code and _code_answer(name, method.code),
    )


def _code_answer(name: MethodName, code: Code) -> CodeAnswer:
    return CodeAnswer(format=format_of(name), label=code.label, help=code.help)
