"""A design as one HTML page that opens offline: its numbers, warnings, and plots to zoom."""

from collections.abc import Iterable, Sequence
from html import escape
from importlib.resources import files
from string import Template

from stepramp.design import Design
from stepramp.exports.shape_text import shape_text
from stepramp.figure import figure_of
from stepramp.ramp.error_curves import ErrorCurves
from stepramp.units import us_from_ticks
from stepramp.version import __version__

METHOD_COLUMNS = (
    "method", "duration", "largest error", "at step", "r.m.s. error", "largest acceleration", "time difference",
    "landing error",
)  # fmt: skip


def zoomable_page(design: Design, moves: Sequence[ErrorCurves]) -> str:
    """Return the page of a design; moves: by its own method first, then by those that it is compared with."""
    # Plotly loads slowly; figure.py waits with it too.
    figure = figure_of(moves)
    plots = figure.to_html(
        full_html=False, include_plotlyjs=True, div_id="plots", config={"displaylogo": False, "responsive": True}
    )
    template = Template((files("stepramp.exports") / "templates" / "zoomable_page.html").read_text(encoding="utf-8"))
    return template.substitute(
        title=escape(design.name or "Ramp"),
        version=__version__,
        warnings="".join(f'<p class="warning">{escape(each.message)}</p>\n' for each in moves[0].profile.warnings),
        parameters=_table(_parameters(design)),
        summary=_table(_summary(moves[0])),
        methods=_table(map(_figures, moves), METHOD_COLUMNS),
        plots=plots,
        table=_lookup_table(design),
    )


def _parameters(design: Design) -> list[tuple[str, str]]:
    ramp, timer, method, axis = design.ramp, design.timer, design.method, design.axis
    return [
        ("base speed v0", f"{ramp.base_speed_steps_per_s:,.10g} steps/s"),
        ("slew speed v", f"{ramp.slew_speed_steps_per_s:,.10g} steps/s"),
        ("acceleration a", f"{ramp.acceleration_steps_per_s2:,.10g} steps/s²"),
        ("deceleration d", f"{ramp.slowdown_steps_per_s2:,.10g} steps/s²"),
        ("shape", shape_text(ramp.shape, design.move, lambda jerk: f"{jerk:,.10g} steps/s³")),
        ("timer F", f"{timer.frequency_hz:,.10g} Hz, {timer.counter_bits} bits"),
        ("shortest interval", f"{timer.shortest_interval_us:,.10g} µs"),
        ("method", f"{method.name} in {method.arithmetic}, rounding {method.rounding}"),
        ("motor", f"{axis.full_steps_per_rev:,} full steps a turn, {axis.microsteps:,} pulses each"),
        ("travel", f"{axis.travel_per_rev:,.10g} {axis.travel_unit} a turn"),
    ]


def _summary(move: ErrorCurves) -> list[tuple[str, str]]:
    profile = move.profile
    shortest, longest = (us_from_ticks(int(end), move.timer_hz) for end in _ends(move))
    return [
        ("length", f"{profile.direction * profile.intervals_ticks.size:,} steps"),
        ("duration", f"{profile.duration_s:,.6g} s"),
        ("peak speed", f"{profile.speed_steps_per_s.max():,.6g} steps/s"),
        ("longest interval", f"{longest:,.6g} µs"),
        ("shortest interval", f"{shortest:,.6g} µs"),
        *((f"{phase.name}", f"{phase.last_step - phase.first_step + 1:,} steps") for phase in profile.phases),
    ]


def _ends(move: ErrorCurves) -> tuple[int, int]:
    intervals = move.profile.intervals_ticks
    return int(intervals.min()), int(intervals.max())


def _figures(move: ErrorCurves) -> tuple[str, ...]:
    worst, peak = move.largest_relative_error, move.peak_acceleration
    return (
        move.method,
        f"{move.profile.duration_s:,.6g} s",
        f"{100 * worst.value:+.3g} %",
        f"{worst.step:,}",
        f"{100 * move.rms_relative_error:.3g} %",
        f"{peak.value:,.0f} steps/s² at {peak.step:,}",
        f"{1000 * move.time_difference_s:+,.4g} ms",
        f"{move.landing_error_steps_per_s:+,.4g} steps/s",
    )


def _lookup_table(design: Design) -> str:
    if design.table is None:
        return ""
    unit = "µs" if design.table.interval_unit == "us" else "ticks"
    rows = ((f"{last:,}", f"{delay:,}") for last, delay in design.table.rows)
    return "<h2>Lookup table</h2>\n" + _table(rows, ("last ramp index", f"delay, {unit}"))


def _table(rows: Iterable[Sequence[str]], head: Sequence[str] = ()) -> str:
    """Return rows of plain text as an HTML table."""
    lines = [_row("td", row) for row in rows]
    if head:
        lines.insert(0, _row("th", head))
    return f"<table>\n{''.join(lines)}</table>"


def _row(cell: str, texts: Sequence[str]) -> str:
    return f"<tr>{''.join(f'<{cell}>{escape(text)}</{cell}>' for text in texts)}</tr>\n"
