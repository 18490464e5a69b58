"""How a function becomes a command: its options refuse in StepRamp's words, and each has an example that is tested."""

import inspect
import re
import types
from collections.abc import Callable, Iterable, Sequence
from copy import copy
from dataclasses import dataclass, replace
from functools import partial
from typing import Annotated, Any, Literal, TypeVar, Union, get_args, get_origin, get_type_hints

import typer

from stepramp.command_line.completion import completing, family_names
from stepramp.command_line.output import drop_output, refuse_closed_output
from stepramp.command_line.where import Where
from stepramp.errors import Rejected, Rejection
from stepramp.http_api.devices_models import DeviceAnswer

F = TypeVar("F", bound=Callable[..., None])
Find = Callable[[], DeviceAnswer]
"""Returns the device that is meant."""

SERVER_HELP = "address of the server to ask, also as its printed link; else STEPRAMP_URL's, else one of this machine"
ALONE_HELP = "ask no server: do it in this program"
DEVICE_HELP = "id of the device, as `stepramp devices` tells; needed where several are connected"
PORT_HELP = "port that the device is at: it is connected to, which starts most boards anew"
FAMILY_HELP = "family of the controller at --port, if not StepRamp's own: `stepramp ports` lists them"


@dataclass(frozen=True)
class Described:
    """A command, for its documentation and its test."""

    name: str
    """With the group that it is in."""
    example: str


COMMANDS: dict[str, Described] = {}
"""All that there are, by their names, once the program was made."""


def command(app: typer.Typer, name: str, *, example: str, group: str = "") -> Callable[[F], F]:
    """Make a command of a function.

    Numbers and choices are given as text and read here. A parameter `where` stands for --server and --alone, a
    parameter `find` for --device, --port and --family: calling it returns the device that is meant, connected to if
    need be, so that what can't be used is refused before a port is opened.
    """

    def register(function: F) -> F:
        parameters, readers = _parameters(function)

        def run(**given: Any) -> None:
            try:
                refuse_closed_output()
                values = {name: readers[name](given[name]) if name in readers else given[name] for name in given}
                _call(function, values)
            except Rejected as error:
                raise renamed(error, labels) from None
            except BrokenPipeError:
                drop_output()

        labels = {each.name: _label(each) for each in parameters}
        run.__name__, run.__doc__ = function.__name__, function.__doc__
        run.__annotations__ = {each.name: each.annotation for each in parameters}
        setattr(run, "__signature__", inspect.Signature(parameters))  # noqa: B010  # functions may have one of their own
        app.command(name, epilog=f"Example: {example}")(run)
        full = f"{group} {name}".strip()
        COMMANDS[full] = Described(full, example)
        return function

    return register


def renamed(error: Rejected, labels: dict[str, str]) -> Rejected:
    """Return a rejection with fields called as on the command line; those of designs as in their file."""
    rejections = []
    for each in error.rejections:
        field = each.field.removeprefix("design.").removeprefix("axes.0.")
        # What may be given several times is counted over HTTP: its value says which it is.
        name = re.sub(r"(\.[0-9]+)?$", "", field)
        is_own = name in labels and not each.field.startswith("design.")
        allowed = _in_options(each.allowed, labels) if is_own or field != each.field else each.allowed
        rejections.append(replace(each, field=labels[name] if is_own else field, allowed=allowed))
    return Rejected(rejections, error.more)


def _in_options(allowed: str, labels: dict[str, str]) -> str:
    """Return what is allowed in the words of the command line: what there is null is left out here."""
    allowed = re.sub(r",? or null\b( for)?", lambda found: "; leave it out for" if found[1] else "", allowed)
    fields = "|".join(name for name, label in labels.items() if label.startswith("--"))
    if allowed.startswith("exactly one of "):
        return re.sub(rf"\b({fields})\b", lambda found: labels[found[0]], allowed)
    # Other words, as rows or bytes, are also what is counted.
    given = rf"\b({fields})\b(?= is given| has )|\b(?:{fields})(?<=_steps)\b"
    return re.sub(given, lambda found: labels[found[0]], allowed)


def _call(function: Callable[..., None], values: dict[str, Any]) -> None:
    hints = inspect.signature(function).parameters
    if "where" not in hints:
        function(**values)
        return
    port = values.get("port")
    with Where(values.pop("server"), alone=values.pop("alone"), port=port) as where:
        if "find" in hints:
            values["find"] = partial(where.device, values.pop("device"), values.pop("port"), values.pop("family"))
        function(where=where, **values)


def _parameters(function: Callable[..., None]) -> tuple[list[inspect.Parameter], dict[str, Callable[[Any], Any]]]:
    """Return the parameters that Typer is told, and what reads those that it gives as text."""
    hints = get_type_hints(function, include_extras=True)
    told: list[inspect.Parameter] = []
    readers: dict[str, Callable[[Any], Any]] = {}
    for name, parameter in inspect.signature(function).parameters.items():
        if name == "where":
            told += [_option("server", str | None, None, SERVER_HELP, "URL"), _option("alone", bool, False, ALONE_HELP)]
        elif name == "find":
            told += [
                _option("device", str | None, None, DEVICE_HELP, "ID"),
                _option("port", str | None, None, PORT_HELP, "PORT"),
                _option("family", str | None, None, FAMILY_HELP, "NAME", family_names),
            ]
        else:
            annotation, reader = _as_text(hints[name])
            told.append(parameter.replace(annotation=annotation, kind=inspect.Parameter.KEYWORD_ONLY))
            if reader is not None:
                readers[name] = _reading(_label(told[-1]), reader)
    return told, readers


def _option(
    name: str,
    kind: Any,
    default: object,
    help_text: str,
    metavar: str | None = None,
    names: Callable[[], Iterable[str]] | None = None,
) -> inspect.Parameter:
    completion = None if names is None else completing(names)
    option = typer.Option(f"--{name}", help=help_text, metavar=metavar, autocompletion=completion)
    return inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=Annotated[kind, option])


def _as_text(annotation: Any) -> tuple[Any, Callable[[str, str], object] | None]:
    """Return an annotation with text in place of numbers and choices, and what reads it by its label."""
    kind, info = get_args(annotation)[:2]
    inner = kind
    is_optional = get_origin(kind) in (Union, types.UnionType)
    if is_optional:
        [inner] = [each for each in get_args(kind) if each is not type(None)]
    is_list = get_origin(inner) is list
    if is_list:
        [inner] = get_args(inner)
    info = copy(info)
    if inner in (int, float):
        info.metavar = info.metavar or ("N" if inner is int else "NUMBER")
        reader: Callable[[str, str], object] = _whole if inner is int else _number
    elif get_origin(inner) is Literal:
        names = get_args(inner)
        info.metavar = info.metavar or "|".join(names)
        info.autocompletion = completing(lambda: names)

        def reader(label: str, text: str) -> object:
            if text in names:
                return text
            raise Rejected([Rejection(label, text, ", ".join(names))])
    else:
        return annotation, None
    text_kind: Any = list[str] if is_list else str
    return Annotated[text_kind | None if is_optional else text_kind, info], reader


def _reading(label: str, read: Callable[[str, str], object]) -> Callable[[Any], Any]:
    def reading(given: Any) -> Any:
        if given is None or not isinstance(given, str | list | tuple):
            return given
        return read(label, given) if isinstance(given, str) else [read(label, each) for each in given]

    return reading


def _whole(label: str, text: str) -> int:
    if re.fullmatch(r"[+-]?[0-9]{1,18}", text):
        return int(text)
    if re.fullmatch(r"[+-]?[0-9]+", text):
        raise Rejected([Rejection(label, text, "a whole number of up to 18 digits")])
    raise Rejected([Rejection(label, text, "a whole number")])


def _number(label: str, text: str) -> float:
    if re.fullmatch(r"[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]{1,3})?", text):
        return float(text)
    raise Rejected([Rejection(label, text, "a number")])


def _label(parameter: inspect.Parameter) -> str:
    """Return what a parameter is called on the command line: its option, or an argument as in the help."""
    info = get_args(parameter.annotation)[1]
    declared: Sequence[str] = [each for each in (info.default, *(info.param_decls or ())) if isinstance(each, str)]
    called = (info.metavar or parameter.name).strip("[]").removesuffix("...")
    return next((each.split("/")[0] for each in declared if each.startswith("--")), called)
