"""A report as a file."""

from collections.abc import Callable
from datetime import date
from typing import Literal

from stepramp.errors import Rejected, Rejection
from stepramp.exports.export import Exported
from stepramp.exports.names import identifier_of
from stepramp.exports.printed.content import Asked, report_of
from stepramp.exports.printed.page import page
from stepramp.exports.printed.paper import paper
from stepramp.ramp.plan import computed_steps

ReportFormat = Literal["html", "pdf"]
MEDIA_TYPES: dict[ReportFormat, str] = {"html": "text/html; charset=utf-8", "pdf": "application/pdf"}
MOST_COMPUTED_STEPS = 40_000_000
"""Of all methods together [steps]."""


def report_file(
    asked: Asked, file_format: ReportFormat, made_on: date, is_wanted: Callable[[], bool] = lambda: True
) -> Exported:
    """Return a report as a file, the same for the same day.

    Raises Rejected as report_of does, and for more methods than can be computed in a minute for so long a move;
    NotWanted as outcome_of does.
    """
    most = max(1, MOST_COMPUTED_STEPS // computed_steps(asked.design))
    if len(set(asked.methods)) > most:
        allowed = f"at most {most} methods for so long a ramp or move"
        raise Rejected([Rejection("methods", list(asked.methods), allowed)])
    report = report_of(asked, made_on, is_wanted)
    return Exported(
        file_name=f"{identifier_of(asked.design.name)}_report.{file_format}",
        media_type=MEDIA_TYPES[file_format],
        content=page(report) if file_format == "html" else paper(report),
    )
