"""A report as one HTML file: without scripts, and without anything from elsewhere."""

import base64
import io
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from html import escape
from typing import Any

from stepramp.exports.c_text import filled
from stepramp.exports.matplotlib_turn import matplotlib_turn
from stepramp.exports.printed.content import Report
from stepramp.exports.printed.motor_plots import described_motor, draw_motor, motor_plots_of
from stepramp.exports.printed.plots import Plot, described, draw, plots_of
from stepramp.exports.printed.stall_maps import described_stall_map, draw_stall_map
from stepramp.exports.printed.table import Table

INCHES = (9.0, 3.4)
VERDICTS = {"passed": "passed", "failed": "failed", "safe": "passed", "stalls": "failed"}
"""The style sheet's name for what stands in a cell."""


def page(report: Report) -> bytes:
    """Return a report as HTML."""
    tables = [_table(table) for table in (report.parameters, report.move)]
    others = [_table(table) for table in report.tables[2:]]
    text = filled(
        "printed.html",
        {
            "title": escape(report.title),
            "made": escape(report.made),
            "figures": "".join(tables),
            "checks": others[0],
            "plots": "".join(_plots(report)),
            "rest": "".join(others[1:]),
        },
    )
    return text.encode()


def _plots(report: Report) -> Iterator[str]:
    with matplotlib_turn():
        for plot in plots_of(report):
            yield _figure(described(plot, report), partial(_draw_over_steps, plot=plot, report=report))
        for of_motor in motor_plots_of(report.motor):
            yield _figure(described_motor(of_motor), partial(draw_motor, plot=of_motor))
        for played in report.maps:
            yield _figure(described_stall_map(played), partial(draw_stall_map, plot=played))


def _draw_over_steps(axes: Any, plot: Plot, report: Report) -> None:
    draw(axes, plot, report)
    axes.set_xlabel("step", fontsize=9)


def _figure(words: str, draw_into: Callable[[Any], None]) -> str:
    # As a picture of its own: names within one can't be mistaken for those of another.
    data = base64.b64encode(_drawn(draw_into)).decode()
    return (
        f'<figure><img src="data:image/svg+xml;base64,{data}" alt="{escape(words)}" '
        f'width="{INCHES[0] * 96:.0f}" height="{INCHES[1] * 96:.0f}"></figure>\n'
    )


def _drawn(draw_into: Callable[[Any], None]) -> bytes:
    from matplotlib.figure import Figure  # noqa: PLC0415  # loads slowly

    figure = Figure(figsize=INCHES, layout="constrained")
    axes = figure.subplots()
    draw_into(axes)
    figure.legend(*axes.get_legend_handles_labels(), loc="outside right upper", frameon=False, fontsize=8)
    out = io.BytesIO()
    # All that would name other places, or the time.
    figure.savefig(out, format="svg", metadata=dict.fromkeys(("Date", "Creator", "Format", "Type")))
    # What stands before it names a document type that lies elsewhere.
    return out.getvalue()[out.getvalue().index(b"<svg") :]


def _table(table: Table) -> str:
    head = "".join(f'<th scope="col">{escape(text)}</th>' for text in table.head)
    return (
        f'<section><h2>{escape(table.title)}</h2>\n<div class="wide"><table>\n<thead><tr>{head}</tr></thead>\n<tbody>\n'
        f"{''.join(map(_row, table.rows))}</tbody>\n</table></div></section>\n"
    )


def _row(texts: Sequence[str]) -> str:
    name, *values = map(escape, texts)
    cells = "".join(f"<td{_verdict(value)}>{value}</td>" for value in values)
    return f'<tr><th scope="row">{name}</th>{cells}</tr>\n'


def _verdict(value: str) -> str:
    return f' class="{VERDICTS[value]}"' if value in VERDICTS else ""
