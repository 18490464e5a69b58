"""Commands about ramps and lookup tables."""

from typing import Annotated, Literal

import typer

from stepramp.command_line.commands import command
from stepramp.command_line.completion import completing
from stepramp.command_line.files import DesignFile, DesignFiles, design_of, designs_of, document_of
from stepramp.command_line.output import Format, Rows, show, warn
from stepramp.command_line.where import Where
from stepramp.errors import Rejected, Rejection
from stepramp.methods import METHODS

MostPoints = Annotated[
    int | None, typer.Option("--points", help="thin to about so many steps that keep the curve's shape; else all")
]
A_TABLE = "a file with a lookup table, or with a design that has one"


def add(app: typer.Typer) -> None:
    """Add the commands to the program."""
    command(app, "profile", example="stepramp profile design.json --format csv")(profile)
    command(app, "errors", example="stepramp errors design.json --method newton --method first_order")(errors)
    command(app, "fit", example="stepramp fit design.json --rows 8")(fit)
    command(app, "play", example="stepramp play design.json --range 300 --target 0:250 --target 40000:10")(play)
    command(app, "schedule", example="stepramp schedule design.json other.json --mode line --points 50")(schedule)


def profile(where: Where, design: DesignFile, max_points: MostPoints = None, format: Format = "table") -> None:
    """Plan a design's move. CSV has a row for each step."""
    answer = where.client.profile(design_of(design), max_points=max_points)
    warn(each.message for each in answer.warnings)
    summary, resolution = answer.summary, answer.slew_resolution
    figures = Rows(
        ("figure", "value", "unit"),
        [
            ("steps", summary.steps, "steps"),
            ("duration", summary.duration_s, "s"),
            ("peak speed", summary.peak_speed_steps_per_s, "steps/s"),
            ("accelerate", summary.accelerate_steps, "steps"),
            ("slew", summary.slew_steps, "steps"),
            ("decelerate", summary.decelerate_steps, "steps"),
            ("one tick at slew speed", resolution.relative * 100, "%"),
        ],
    )
    names = ("step", "intervals_ticks", "time_s", "position_steps", "speed_steps_per_s")
    steps = Rows(names, zip(*(getattr(answer, name) for name in names), strict=True))
    show(format, answer, figures, listed=steps)


def errors(
    where: Where,
    design: DesignFile,
    methods: Annotated[
        list[str],
        typer.Option(
            "--method",
            metavar="NAME",
            help="method to compare; may be repeated",
            autocompletion=completing(lambda: METHODS),
        ),
    ],
    reference: Annotated[
        str | None,
        typer.Option(
            "--reference",
            metavar="NAME",
            help="method that they are compared with",
            autocompletion=completing(lambda: METHODS),
        ),
    ] = None,
    max_points: MostPoints = None,
    format: Format = "table",
) -> None:
    """Compare methods with a reference. CSV has a row for each step of each method."""
    answer = where.client.errors(design_of(design), methods, reference=reference, max_points=max_points)
    for failure in answer.failures:
        warn(f"{failure.method}: {each.message}" for each in failure.errors)
    columns = ("method", "largest error [%]", "at step", "rms [%]", "takes longer [s]", "peak acceleration [steps/s²]")
    figures = Rows(
        columns,
        [
            (
                each.method,
                each.largest_relative_error.value * 100,
                each.largest_relative_error.step,
                each.rms_relative_error * 100,
                each.time_difference_s,
                each.peak_acceleration_steps_per_s2.value,
            )
            for each in answer.methods
        ],
        f"Against {answer.reference}",
    )
    steps = (
        (each.method, *row)
        for each in answer.methods
        for row in zip(each.step, each.relative_error or [], each.tick_error or [], strict=True)
    )
    show(format, answer, figures, listed=Rows(("method", "step", "relative_error", "tick_error"), steps))


def fit(
    where: Where,
    design: DesignFile,
    rows: Annotated[int | None, typer.Option("--rows", help="most rows")] = None,
    largest_relative_error: Annotated[
        float | None, typer.Option("--error", help="largest relative error of a delay: 0.05 is 5 %")
    ] = None,
    bytes: Annotated[int | None, typer.Option("--bytes", help="most memory of the table")] = None,
    row_kind: Annotated[
        Literal["constant", "linear"], typer.Option("--kind", help="linear: the delay changes along a row")
    ] = "constant",
    interval_unit: Annotated[Literal["us", "ticks"], typer.Option("--unit", help="of the delays")] = "us",
    fit_to: Annotated[
        Literal["played", "ramp_index"], typer.Option("--to", help="what gauge libraries play, or the ramp's own index")
    ] = "played",
    format: Format = "table",
) -> None:
    """Fit a lookup table to a design's ramp, by one of --rows, --error and --bytes."""
    answer = where.client.fit(
        design_of(design),
        rows=rows,
        largest_relative_error=largest_relative_error,
        bytes=bytes,
        row_kind=row_kind,
        interval_unit=interval_unit,
        fit_to=fit_to,
    )
    title = (
        f"{answer.rows} rows, {answer.bytes:,} bytes, largest error {answer.largest_relative_error * 100:.3g} % "
        f"(no table has less than {answer.floor.relative_error * 100:.3g} %)"
    )
    columns = ["last_ramp_index", f"delay_{answer.interval_unit}"]
    fitted = answer.table.rows if answer.table is not None else answer.linear_rows or []
    if answer.table is None:
        columns.append("added_each_step")
    listed = [(*row, error) for row, error in zip(fitted, answer.relative_errors, strict=True)]
    show(format, answer, Rows([*columns, "relative_error"], listed, title))


def play(
    where: Where,
    table: Annotated[str, typer.Argument(metavar="TABLE", help=f"{A_TABLE}, - for standard input")],
    range_steps: Annotated[int, typer.Option("--range", help="range of the gauge [steps]")],
    targets: Annotated[
        list[str],
        typer.Option("--target", metavar="AT_US:STEPS", help="when [µs], and which position [steps]; may be repeated"),
    ],
    format: Format = "table",
) -> None:
    """Play a lookup table as a gauge library does. CSV has a row for each step."""
    document = document_of(table, "TABLE", A_TABLE)
    if isinstance(document, dict) and "timer" in document:
        document = document.get("table")
    if not isinstance(document, dict):
        raise Rejected([Rejection("TABLE", table, A_TABLE)])
    answer = where.client.play_table(document, range_steps, [_target(each) for each in targets])
    names = ("at_us", "position", "direction", "ramp_index", "delay_us")
    steps = Rows(names, zip(*(getattr(answer.steps, name) for name in names), strict=True))
    stops = Rows(("at rest at [µs]", "position [steps]"), [(each.at_us, each.position) for each in answer.stops])
    show(format, answer, stops, listed=steps)


def _target(text: str) -> tuple[int, int]:
    at_us, _, target = text.partition(":")
    try:
        return int(at_us), int(target)
    except ValueError:
        allowed = "an instant [µs], a colon and a position [steps], as 40000:10"
        raise Rejected([Rejection("--target", text, allowed)]) from None


def schedule(
    where: Where,
    designs: DesignFiles,
    mode: Annotated[
        Literal["independent", "line"],
        typer.Option("--mode", help="each axis by itself, or along a straight line"),
    ] = "independent",
    max_points: MostPoints = None,
    shortest_spacing_us: Annotated[
        float | None, typer.Option("--spacing", help="least time between two pulses of different axes [µs]")
    ] = None,
    format: Format = "table",
) -> None:
    """Plan up to four axes together. CSV has a row for each pulse."""
    answer = where.client.schedule(
        designs_of(designs), mode, max_points=max_points, shortest_spacing_us=shortest_spacing_us
    )
    warn([*(each.message for each in answer.limits), *(each.message for each in answer.warnings)])
    axes = Rows(
        ("axis", "design", "steps", "direction", "duration [s]"),
        [(number, each.name, each.steps, each.direction, each.duration_s) for number, each in enumerate(answer.axes)],
        f"{answer.duration_s:,.6g} s; {answer.conflicts.count:,} pairs of pulses too close",
    )
    names = ("time_s", "axis", "position_steps")
    pulses = Rows(names, zip(*(getattr(answer.schedule, name) for name in names), strict=True))
    show(format, answer, axes, listed=pulses)
