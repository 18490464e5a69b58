"""A report on paper: a PDF of A4 pages, whose text can be searched and copied."""

import io
import textwrap
from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import partial
from typing import Any

from stepramp.exports.matplotlib_turn import matplotlib_turn
from stepramp.exports.printed.content import Report
from stepramp.exports.printed.motor_plots import draw_motor, motor_plots_of
from stepramp.exports.printed.plots import draw, plots_of, printable
from stepramp.exports.printed.stall_maps import draw_stall_map
from stepramp.exports.printed.table import Table

WIDTH_IN, HEIGHT_IN = 8.27, 11.69
MARGIN_IN = 0.7
LINE_IN = 0.17
TEXT_POINTS, HEAD_POINTS, TITLE_POINTS = 8, 11, 18
CHARACTERS_AN_INCH = 15.5
"""Of text of that size; wide letters take some more, and columns have a gap for that."""
GAP_CHARACTERS = 2
LEAST_CHARACTERS = 8
MANY_ROWS = 40
"""More stand side by side."""
MONO_CHARACTERS_A_LINE = 100
INK, MUTED, RULE = "#13171c", "#47525f", "#dfe3e9"
PASSED, FAILED = "#1b6e3c", "#a1260d"
VERDICTS = {"passed": PASSED, "failed": FAILED, "safe": PASSED, "stalls": FAILED}


def paper(report: Report) -> bytes:
    """Return a report as a PDF."""
    from matplotlib.backends.backend_pdf import PdfPages  # noqa: PLC0415  # loads slowly

    out = io.BytesIO()
    with matplotlib_turn():
        about = {"Title": report.title, "Creator": report.made, "Producer": None, "CreationDate": None}
        with PdfPages(out, metadata=about) as pages:
            for figure in _pages(report):
                pages.savefig(figure)
    return out.getvalue()


def _pages(report: Report) -> Iterator[Any]:
    first, *others = report.tables
    writer = _Writer()
    writer.write(printable(report.title), TITLE_POINTS)
    writer.write(f"{report.made}. What is shown are the intervals that a controller plays.", TEXT_POINTS, MUTED)
    if not _is_printable(report):
        writer.write(
            "Characters that this file's font lacks stand as \N{REPLACEMENT CHARACTER}; the HTML has them.",
            TEXT_POINTS,
            MUTED,
        )
    for table in (first, *others[:2]):
        writer.write_table(table)
    yield from writer.figures
    yield _plots(report)
    of_motor = motor_plots_of(report.motor)
    if of_motor:
        yield _over_each_other(partial(draw_motor, plot=plot) for plot in of_motor)
    if report.maps:
        yield _over_each_other(partial(draw_stall_map, plot=plot) for plot in report.maps)
    writer = _Writer()
    for table in others[2:]:
        writer.write_table(table)
    yield from writer.figures


def _is_printable(report: Report) -> bool:
    """Tell whether the font has all that people have named."""
    texts = [report.title, *(line.label for line in report.lines), *report.parameters.head]
    return all("\N{REPLACEMENT CHARACTER}" not in printable(text) for text in texts)


def _plots(report: Report) -> Any:
    from matplotlib.figure import Figure  # noqa: PLC0415  # loads slowly
    from matplotlib.layout_engine import ConstrainedLayoutEngine  # noqa: PLC0415

    figure = Figure(figsize=(WIDTH_IN, HEIGHT_IN), layout=ConstrainedLayoutEngine(rect=(0.06, 0.05, 0.88, 0.84)))
    plots = plots_of(report)
    all_axes = figure.subplots(len(plots), 1, sharex=True)
    for axes, plot in zip(all_axes, plots, strict=True):
        draw(axes, plot, report)
    all_axes[-1].set_xlabel("step", fontsize=9)
    entries = all_axes[0].get_legend_handles_labels()
    corner = (MARGIN_IN / WIDTH_IN, 1 - MARGIN_IN / HEIGHT_IN)
    figure.legend(*entries, loc="upper left", bbox_to_anchor=corner, ncols=3, frameon=False, fontsize=8)
    return figure


def _over_each_other(drawings: Iterable[Callable[[Any], None]]) -> Any:
    """Return a page with up to three plots that each have their own axes."""
    from matplotlib.figure import Figure  # noqa: PLC0415  # loads slowly
    from matplotlib.layout_engine import ConstrainedLayoutEngine  # noqa: PLC0415

    into = list(drawings)
    height = 0.27 * len(into)
    rect = (0.06, 0.94 - height, 0.88, height)
    figure = Figure(figsize=(WIDTH_IN, HEIGHT_IN), layout=ConstrainedLayoutEngine(rect=rect))
    for axes, draw_into in zip(figure.subplots(len(into), 1, squeeze=False)[:, 0], into, strict=True):
        draw_into(axes)
        axes.legend(frameon=False, fontsize=8, loc="upper left", bbox_to_anchor=(1, 1))
    return figure


class _Writer:
    """Writes lines down a page, and goes on on the next one."""

    def __init__(self) -> None:
        self.figures: list[Any] = []
        self._down_in = HEIGHT_IN
        """From the upper edge of the page."""

    def write(self, text: str, points: float, colour: str = INK) -> None:
        """Write a paragraph."""
        lines = textwrap.wrap(text, int((WIDTH_IN - 2 * MARGIN_IN) * CHARACTERS_AN_INCH * TEXT_POINTS / points)) or [""]
        height_in = LINE_IN * points / TEXT_POINTS
        for line in lines:
            self._take_room(height_in)
            self._put(0, line, points, colour)
            self._down_in += height_in

    def write_table(self, table: Table) -> None:
        """Write a table; on each page that it takes, its head again."""
        self._take_room(5 * LINE_IN)
        self._down_in += LINE_IN
        self.write(table.title, HEAD_POINTS)
        if len(table.rows) > MANY_ROWS:
            self._write_many(table)
            return
        widths = _widths(table)
        self._write_row(table.head, widths, MUTED)
        for row in table.rows:
            height_in = LINE_IN * max(len(cell) for cell in _cells(row, widths))
            if self._take_room(height_in):
                self._write_row(table.head, widths, MUTED)
            self._write_row(row, widths, INK)

    def _write_many(self, table: Table) -> None:
        """Write rows of short texts side by side, a line at a time: a text for each of them would take long."""
        widths = [max(map(len, column)) for column in zip(table.head, *table.rows, strict=True)]
        together = max(1, MONO_CHARACTERS_A_LINE // (sum(widths) + 2 * len(widths) + 3))

        def line_of(rows: Sequence[Sequence[str]]) -> str:
            return "     ".join(
                "  ".join(text.rjust(width) for text, width in zip(row, widths, strict=True)) for row in rows
            )

        def write_line(rows: Sequence[Sequence[str]], colour: str) -> None:
            self._put(0, line_of(rows), TEXT_POINTS, colour, "DejaVu Sans Mono")
            self._down_in += LINE_IN

        write_line([table.head] * together, MUTED)
        for first in range(0, len(table.rows), together):
            if self._take_room(LINE_IN):
                write_line([table.head] * together, MUTED)
            write_line(table.rows[first : first + together], INK)

    def _write_row(self, row: Sequence[str], widths: Sequence[int], colour: str) -> None:
        cells, at = _cells(row, widths), 0.0
        top_in = self._down_in
        for text, lines, width in zip(row, cells, widths, strict=True):
            for number, line in enumerate(lines):
                self._down_in = top_in + number * LINE_IN
                self._put(at, line, TEXT_POINTS, VERDICTS.get(text, colour))
            at += width / CHARACTERS_AN_INCH
        self._down_in = top_in + LINE_IN * max(map(len, cells))

    def _put(self, across_in: float, text: str, points: float, colour: str, family: str = "DejaVu Sans") -> None:
        x, y = (MARGIN_IN + across_in) / WIDTH_IN, 1 - self._down_in / HEIGHT_IN
        style = {"size": points, "color": colour, "family": family, "va": "top"}
        self.figures[-1].text(x, y, printable(text), **style, parse_math=False)

    def _take_room(self, height_in: float) -> bool:
        """Begin a page when there is no such room on this one; return whether."""
        from matplotlib.figure import Figure  # noqa: PLC0415  # loads slowly

        if self._down_in + height_in <= HEIGHT_IN - MARGIN_IN:
            return False
        self.figures.append(Figure(figsize=(WIDTH_IN, HEIGHT_IN)))
        self._down_in = MARGIN_IN
        return True


def _widths(table: Table) -> list[int]:
    """Return the widths of a table's columns [characters]: as wide as they ask for, the widest less if need be."""
    columns = zip(table.head, *table.rows, strict=True)
    widths = [max(map(len, column)) + GAP_CHARACTERS for column in columns]
    room = int((WIDTH_IN - 2 * MARGIN_IN) * CHARACTERS_AN_INCH)
    while sum(widths) > room and max(widths) > LEAST_CHARACTERS:
        widths[widths.index(max(widths))] -= 1
    return widths


def _cells(row: Sequence[str], widths: Sequence[int]) -> list[list[str]]:
    """Return the lines of each cell."""
    return [
        textwrap.wrap(text, max(width - GAP_CHARACTERS, 1)) or [""] for text, width in zip(row, widths, strict=True)
    ]
