"""Where the command line begins: a stop goes out before anything else is loaded."""

import os
import sys
from collections.abc import Sequence

HELP = "--help"
OF_ALL = (HELP, "--version", "--install-completion", "--show-completion")
"""Options of the program itself. Any other one without a command is the server's."""
COMPLETION_VARIABLE = "_STEPRAMP_COMPLETE"


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; return its exit code."""
    words = list(sys.argv[1:] if arguments is None else arguments)
    if COMPLETION_VARIABLE not in os.environ:
        if words[:1] == ["stop"] and HELP not in words:
            from stepramp.command_line.stop import asked_by, carry_out  # noqa: PLC0415

            return carry_out(asked_by(words[1:]))
        if not words or (words[0].startswith("-") and words[0] not in OF_ALL):
            words = ["serve", *words]
    from stepramp.command_line.app import run  # noqa: PLC0415

    return run(words)
