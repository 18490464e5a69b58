"""What commands print: tables for people, CSV and JSON for programs; what is only told goes to standard error."""

import csv
import os
import sys
import threading
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Annotated, Literal

import typer
from pydantic import BaseModel
from rich.console import Console
from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn
from rich.table import Table
from rich.text import Text

from stepramp.command_line.visible import visible, visible_json
from stepramp.errors import Rejected, Rejection

FormatName = Literal["table", "csv", "json"]
Format = Annotated[
    FormatName,
    typer.Option("--format", help="table: for people. csv: rows for a spreadsheet. json: all that the API answers"),
]
WIDEST = 400
"""Width of tables that go to no terminal: no line is cut [characters]."""
LOOKED_AT_EVERY_S = 0.2


@dataclass(frozen=True)
class Rows:
    """A table: what its columns are called, with units, and their values."""

    columns: Sequence[str]
    rows: Iterable[Sequence[object]]
    title: str = ""


def show(how: FormatName, answer: BaseModel, *tables: Rows, listed: Rows | None = None) -> None:
    """Print an answer: as tables for people, as one list of rows, or as it is. listed: the rows of CSV, if others."""
    if how == "json":
        print(visible_json(answer.model_dump_json(indent=2, by_alias=True, exclude_unset=True)))
    elif how == "csv":
        write_csv(listed or tables[0])
    else:
        console = _console()
        for number, each in enumerate(tables):
            if number:
                console.print()
            console.print(as_table(each))


def write_csv(rows: Rows) -> None:
    """Print rows as CSV; what isn't there is empty. Programs are given each text as it is, a terminal isn't."""
    writer, is_seen = csv.writer(sys.stdout, lineterminator="\n"), sys.stdout.isatty()
    writer.writerow(rows.columns)
    writer.writerows([_in_csv(value, is_seen=is_seen) for value in row] for row in rows.rows)


def _in_csv(value: object, *, is_seen: bool) -> object:
    if value is None:
        return ""
    return visible(value) if is_seen and isinstance(value, str) else value


def as_table(rows: Rows) -> Table:
    """Return rows as a table for people."""
    title = Text(visible(rows.title)) if rows.title else None
    table = Table(title=title, title_justify="left", box=None, pad_edge=False, show_edge=False)
    listed = [list(row) for row in rows.rows]
    for number, column in enumerate(rows.columns):
        is_number = all(isinstance(row[number], int | float) or row[number] is None for row in listed)
        table.add_column(Text(visible(column)), justify="right" if is_number and listed else "left", overflow="fold")
    for row in listed:
        table.add_row(*(Text(visible(figure(value))) for value in row))
    return table


def figure(value: object) -> str:
    """Return a value as people read it."""
    if value is None:
        return "–"
    if isinstance(value, bool):
        return "yes" if value else "no"
    return f"{value:,.6g}" if isinstance(value, float) else f"{value:,}" if isinstance(value, int) else str(value)


def tell(words: str) -> None:
    """Tell something that is no result."""
    if sys.stderr is not None:  # It may be closed; print would take standard output then.
        print(f"stepramp: {visible(words)}", file=sys.stderr, flush=True)


def refuse_closed_output() -> None:
    """Refuse a standard output that is closed before anything is done. Raises Rejected."""
    if sys.stdout is None:
        raise Rejected([Rejection("standard output", "closed", "one that can be written")])


def drop_output() -> None:
    """Drop what is still to be written: who reads has read enough, as head does."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def warn(warnings: Iterable[str]) -> None:
    """Tell what works, but not as it was asked for."""
    for each in warnings:
        tell(f"warning: {each}")


@contextmanager
def progress(words: str) -> Iterator[Callable[[float], None]]:
    """Show a bar at a terminal while the context lasts; yields what it is told by, from 0 to 1."""
    console = Console(stderr=True)
    columns = TextColumn("{task.description}"), BarColumn(), TaskProgressColumn()
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as bar:
        task = bar.add_task(words, total=1.0)
        yield lambda part: bar.update(task, completed=part)


@contextmanager
def progress_asked(words: str, ask: Callable[[], float | None]) -> Iterator[None]:
    """Show a bar at a terminal while the context lasts, by what is asked from time to time."""
    if not Console(stderr=True).is_terminal:
        yield
        return
    ended = threading.Event()
    with progress(words) as told:

        def look() -> None:
            while not ended.wait(LOOKED_AT_EVERY_S):
                if (part := ask()) is not None:
                    told(part)

        thread = threading.Thread(target=look, daemon=True)
        thread.start()
        try:
            yield
        finally:
            ended.set()
            thread.join()


def _console() -> Console:
    return Console(highlight=False, soft_wrap=False, width=None if sys.stdout.isatty() else WIDEST)
