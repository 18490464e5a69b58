"""Commands that write a design as a file, and that read what a logic analyser captured."""

from collections.abc import Sequence
from typing import Annotated, Literal

import typer

from stepramp.command_line.commands import command
from stepramp.command_line.completion import completing
from stepramp.command_line.files import DesignFile, bytes_of, design_of, refuse_same, write
from stepramp.command_line.output import Format, Rows, show, tell, warn
from stepramp.command_line.where import Where
from stepramp.errors import Rejected, Rejection


def add(app: typer.Typer) -> None:
    """Add the commands to the program."""
    command(app, "export", example="stepramp export c_newton design.json ramp.h")(export)
    command(app, "capture", example="stepramp capture capture.csv --design design.json")(capture)


def _format_names() -> Sequence[str]:
    from stepramp.exports.export import FORMAT_NAMES  # noqa: PLC0415  # only to complete a word

    return FORMAT_NAMES


def export(
    where: Where,
    format: Annotated[
        str,
        typer.Argument(
            metavar="FORMAT",
            help="c_table, c_newton, grbl, csv, html …; a wrong one lists them all",
            autocompletion=completing(_format_names),
        ),
    ],
    design: DesignFile,
    file: Annotated[str, typer.Argument(metavar="FILE", help="file to write, - for standard output")],
    axis_letter: Annotated[
        str,
        typer.Option(
            "--axis-letter",
            metavar="LETTER",
            help="axis of a machine that ramps by itself, such as grbl: X, Y, Z, A, B or C",
            autocompletion=completing(lambda: "XYZABC"),
        ),
    ] = "X",
    segment_bound_ticks: Annotated[
        int,
        typer.Option(
            "--segment-bound-ticks",
            metavar="TICKS",
            help="so far may an interval of segments and ramp images be off, so that they take fewer bytes",
        ),
    ] = 0,
) -> None:
    """Write a design in a format, as C code, settings of a machine or a page of plots."""
    planned = design_of(design)
    refuse_same(design, file)
    write(file, where.client.export(planned, format, axis_letter=axis_letter, segment_bound_ticks=segment_bound_ticks))


def capture(
    where: Where,
    file: Annotated[str, typer.Argument(metavar="FILE", help="captured file, - for standard input")],
    design: Annotated[
        str | None, typer.Option("--design", metavar="FILE", help="design that the measured move is held against")
    ] = None,
    step_channel: Annotated[
        str | None, typer.Option("--step-channel", metavar="NAME", help="channel that steps; else the likeliest")
    ] = None,
    direction_channel: Annotated[
        str | None, typer.Option("--direction-channel", metavar="NAME", help="channel of the direction")
    ] = None,
    edge: Annotated[
        Literal["rising", "falling", "both"] | None, typer.Option("--edge", help="which edges step")
    ] = None,
    move_number: Annotated[int | None, typer.Option("--move", help="which of the moves, counted from 1")] = None,
    alignment: Annotated[
        Literal["first_step", "best_fit"], typer.Option("--align", help="how the move is laid over the plan")
    ] = "first_step",
    shortest_pulse_us: Annotated[
        float | None, typer.Option("--shortest-pulse", help="shorter pulses are marked [µs]")
    ] = None,
    format: Format = "table",
) -> None:
    """Show the steps that a logic analyser captured, next to a design's. CSV has a row for each step."""
    if file == design == "-":
        raise Rejected([Rejection("--design", design, "a file, since FILE is standard input")])
    planned = None if design is None else design_of(design, "--design")
    answer = where.client.capture(
        bytes_of(file, "FILE"),
        planned,
        step_channel=step_channel,
        direction_channel=direction_channel,
        edge=edge,
        move_number=move_number,
        alignment=alignment,
        shortest_pulse_us=shortest_pulse_us,
    )
    warn(answer.remarks)
    columns = ("move", "steps", "begins [s]", "duration [s]")
    moves = Rows(
        columns,
        [(each.move, each.steps, each.begin_s, each.duration_s) for each in answer.moves],
        f"{answer.steps:,} steps of channel {answer.step_channel}, edge {answer.edge}",
    )
    move = answer.move
    if move is None:
        show(format, answer, moves, listed=Rows(("step", "time_s"), []))
        return
    names = ("step", "time_s", "interval_us", "speed_steps_per_s")
    values = [getattr(move, name) for name in names]
    deviation = move.deviation
    if deviation is not None:
        values.append(deviation.deviation_us)
    listed = Rows((*names, *(["deviation_us"] if deviation else [])), zip(*values, strict=True))
    show(format, answer, moves, listed=listed)
    if deviation is not None:
        told = deviation.figures
        tell(
            f"move {move.move}: {deviation.matched_steps:,} of {deviation.planned_steps:,} planned steps, "
            f"{deviation.missing.count:,} missing, {deviation.extra.count:,} besides; largest deviation "
            f"{told.largest_us:,.4g} µs at step {told.largest_at_step:,}, rms {told.rms_us:,.4g} µs"
        )
