"""Writes the list of commands in command_line.md anew, from their own help texts."""

import re
from pathlib import Path

import typer

from stepramp.command_line.app import NAME, program

FILE = Path(__file__).parent / "command_line.md"
MARK = "<!-- commands -->"
WIDTH = 110


def commands() -> str:
    """Return what stands below the mark: of each command its name, and its help as the terminal shows it."""
    group = typer.main.get_command(program())
    texts = []
    for name, command in group.commands.items():
        for path, each in _leaves((name,), command):
            texts.append(f"## {' '.join(path)}\n\n```\n{_help(path, each)}\n```\n")
    return "\n".join(texts)


def _leaves(path, command):
    inner = getattr(command, "commands", None)
    if inner is None:
        yield path, command
    else:
        for name, each in inner.items():
            yield from _leaves((*path, name), each)


def _help(path, command) -> str:
    with typer.main.get_command(program()).make_context(NAME, [], resilient_parsing=True) as parent:
        width = {"terminal_width": WIDTH, "max_content_width": WIDTH}
        context = command.context_class(command, info_name=" ".join(path), parent=parent, **width)
        text = command.get_help(context)
    return re.sub(r"[ \t]+$", "", text, flags=re.MULTILINE).strip()


if __name__ == "__main__":
    before = FILE.read_text(encoding="utf-8").split(MARK)[0]
    FILE.write_text(f"{before}{MARK}\n{commands()}", encoding="utf-8")
