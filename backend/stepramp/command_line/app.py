"""The program with all of its commands, and what it ends with."""

import io
import os
import re
import sys
from collections.abc import Sequence
from typing import Annotated, Any

import typer

from stepramp.command_line.exit_codes import FAILED, INTERRUPTED, MEANINGS, NOBODY_THERE, OK, WRONG_INPUT
from stepramp.command_line.main import COMPLETION_VARIABLE
from stepramp.command_line.visible import visible
from stepramp.errors import DeviceLost, NoServer, Rejected, Rejection, StepRampError, shown
from stepramp.version import __version__

NAME = "stepramp"
_CODES = "  ".join(f"{code}: {meaning}." for code, meaning in MEANINGS.items())
ABOUT = f"""Designs stepper-motor ramps. Without a command it starts the server and opens its page: see serve.

Commands ask the server of this machine if one runs, or else do it by themselves. Exit codes: {_CODES}"""


def program() -> typer.Typer:
    """Return the program."""
    # The others load what takes a while: `serve --help` and `stop --help` do without.
    from stepramp.command_line import (  # noqa: PLC0415
        designs,
        device_list,
        exporting,
        history,
        motion,
        motors,
        pushing,
        ramps,
    )
    from stepramp.command_line.server_commands import add_serve, add_stop  # noqa: PLC0415

    app = typer.Typer(name=NAME, help=ABOUT, rich_markup_mode=None, pretty_exceptions_enable=False)
    app.callback()(_of_all)
    add_serve(app)
    for part in (ramps, motors, exporting, device_list, pushing, motion):
        part.add(app)
    add_stop(app)
    of_library = typer.Typer(name=designs.GROUP, help="The library of designs.", rich_markup_mode=None)
    for part in (designs, history):
        part.add(of_library)
    app.add_typer(of_library)
    return app


def run(words: Sequence[str]) -> int:
    """Do what the command line says; return the exit code."""
    _write_all_that_is_printed()
    try:
        _refuse_words_of_completion(words)
        made = _light() if words[:1] == ["serve"] or words == ["--version"] else program()
        code = made(words, prog_name=NAME, standalone_mode=False)
        if sys.stdout is not None:  # It may be closed.
            sys.stdout.flush()
        return code if isinstance(code, int) else OK
    except StepRampError as error:
        return _told(str(error), _code_of(error))
    except KeyboardInterrupt:
        return INTERRUPTED
    except BrokenPipeError:
        from stepramp.command_line.output import drop_output  # noqa: PLC0415

        drop_output()
        return OK
    except OSError as error:
        if error.filename is not None:
            raise
        from stepramp.command_line.output import drop_output  # noqa: PLC0415

        drop_output()
        return _told(f"Standard output can't be written: {error.strerror}.", FAILED)
    except Exception as error:
        # Typer's own, whatever it is called in its version: an option that there isn't, an argument that is missing.
        if not hasattr(error, "format_message"):
            raise
        return _told(_in_words(error), WRONG_INPUT)


def _write_all_that_is_printed() -> None:
    """Have output written whole, or refused, where Python was told not to buffer it (PYTHONUNBUFFERED).

    A file that isn't buffered takes what there is room for, and says how much that was: nobody asks.
    """
    out = sys.stdout
    if out is not sys.__stdout__ or not isinstance(out, io.TextIOWrapper):
        return
    raw: object = out.buffer
    if isinstance(raw, io.RawIOBase):
        sys.stdout = io.TextIOWrapper(io.BufferedWriter(raw), out.encoding, out.errors, line_buffering=True)


def _refuse_words_of_completion(words: Sequence[str]) -> None:
    """Refuse what Typer would drop, or not understand, about completion. Raises Rejected."""
    if words[:1] in (["--install-completion"], ["--show-completion"]) and len(words) > 1:
        raise Rejected([Rejection(words[0], words[1], "nothing: it is for the shell that it is called from")])
    if os.environ.get(COMPLETION_VARIABLE) == "complete_bash":
        for name in ("COMP_WORDS", "COMP_CWORD"):
            given = os.environ.get(name)
            if given is None or (name == "COMP_CWORD" and not re.fullmatch("[0-9]{1,9}", given)):
                raise Rejected([Rejection(name, given, "what bash sets while it completes a word")])


def _code_of(error: StepRampError) -> int:
    if isinstance(error, Rejected):
        return WRONG_INPUT
    return NOBODY_THERE if isinstance(error, DeviceLost | NoServer) else FAILED


def _light() -> typer.Typer:
    """Return the program with nothing but its server, which need not wait for the rest."""
    from stepramp.command_line.server_commands import add_serve  # noqa: PLC0415

    app = typer.Typer(name=NAME, rich_markup_mode=None, pretty_exceptions_enable=False, add_completion=False)
    app.callback()(_of_all)
    add_serve(app)
    return app


def _tell_version(is_asked: bool) -> None:
    if is_asked:
        print(f"StepRamp {__version__}")
        raise typer.Exit


def _of_all(
    version: Annotated[
        bool, typer.Option("--version", is_eager=True, callback=_tell_version, help="tell the version")
    ] = False,
) -> None:
    del version


def _in_words(error: Any) -> str:
    """Return what is wrong with the words of a command line: which one, and what is allowed."""
    context = getattr(error, "ctx", None)
    parameter = getattr(error, "param", None)
    if (name := getattr(error, "option_name", None)) and context is not None and "requires" not in str(error):
        there = sorted(option for each in context.command.params for option in each.opts if option.startswith("--"))
        return f"{name} is no option of `{context.command_path}`; allowed: {', '.join(there)}."
    if parameter is not None and type(error).__name__ == "MissingParameter":
        label = next((each for each in parameter.opts if each.startswith("--")), parameter.metavar or parameter.name)
        return f"{label} is missing; allowed: {parameter.help}."
    if context is not None and getattr(context.command, "commands", None) and "command" in str(error).lower():
        named = str(error).partition("'")[2].partition("'")[0]
        return f"command is {shown(named or None)}; allowed: {', '.join(context.command.commands)}."
    words = str(error.format_message())
    extra = re.match(r"Got unexpected extra arguments?(?:\(s\))? \((.*)\)", words)
    if context is not None and extra is not None:
        arguments = [each.metavar for each in context.command.params if each.param_type_name == "argument"]
        allowed = f"{', '.join(arguments)}, in quotes where it has blanks" if arguments else "options only"
        return f"{extra[1]} is too much; allowed: {allowed}."
    return words if words.endswith(".") else f"{words}."


def _told(words: str, code: int) -> int:
    if sys.stderr is not None:
        print(f"{NAME}: {visible(words)}", file=sys.stderr, flush=True)
    return code
