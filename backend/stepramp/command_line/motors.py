"""Commands about what a motor does with a design's ramp."""

from collections.abc import Sequence
from typing import Annotated, Literal

import typer

from stepramp.command_line.commands import command
from stepramp.command_line.completion import completing
from stepramp.command_line.files import DesignFile, design_of
from stepramp.command_line.output import Format, Rows, progress, show, tell
from stepramp.command_line.where import Where
from stepramp.http_api.error_items import ChangeAnswer

USUAL_SPEEDS_RPM = [0.0, 60.0, 150.0, 300.0, 600.0, 900.0, 1200.0]
VERDICTS = ("safe", "marginal", "stalls", "not possible")
MARKS = "·~#x?"
"""What stands for each of them in a map; the last for what isn't known."""
Ends = Annotated[
    list[float] | None, typer.Option("--range", help="least and most of what the map goes over: give it twice")
]


def add(app: typer.Typer) -> None:
    """Add the commands to the program."""
    command(app, "torque", example="stepramp torque motor.json --speed 300 --speed 600")(torque)
    command(app, "simulate", example="stepramp simulate motor.json --no-proposals")(simulate)
    command(app, "map", example="stepramp map motor.json --cells 8")(stall_map)


def torque(
    where: Where,
    design: DesignFile,
    speeds_rpm: Annotated[
        list[float] | None, typer.Option("--speed", help="speed of the motor's shaft [rpm]; may be repeated")
    ] = None,
    format: Format = "table",
) -> None:
    """Tell the torque that a design's motor has, and the one that its ramp asks for."""
    speeds = speeds_rpm or USUAL_SPEEDS_RPM
    answer = where.client.torque(design_of(design), speeds)
    rows = zip(speeds, answer.pull_out_nm, answer.required_nm, strict=True)
    show(format, answer, Rows(("speed [rpm]", "motor has [Nm]", "ramp asks for [Nm]"), rows))


def simulate(
    where: Where,
    design: DesignFile,
    with_proposals: Annotated[
        bool, typer.Option("--proposals/--no-proposals", help="whether to look for what to change")
    ] = True,
    max_points: Annotated[int | None, typer.Option("--points", help="of the rotor, in CSV and JSON")] = None,
    format: Format = "table",
) -> None:
    """Play a design's move through its motor's model: whether it stalls, why, and what to change."""
    answer = where.client.simulate(design_of(design), max_points=max_points, with_proposals=with_proposals)
    figures = Rows(
        ("figure", "value", "unit"),
        [
            ("verdict", answer.verdict, ""),
            ("cause", answer.cause, ""),
            ("lost", answer.lost_full_steps, "full steps"),
            ("largest load angle", answer.largest_load_angle_deg, "electrical °"),
            ("torque used", None if answer.most_used is None else answer.most_used * 100, "%"),
            ("at", answer.most_used_at_steps_per_s, "steps/s"),
            ("natural frequency", answer.natural_frequency_hz, "Hz"),
            ("can start at", answer.greatest_start_speed_steps_per_s, "steps/s"),
        ],
    )
    proposals = Rows(("safe with", "fields"), [(each.text, _changes(each.changes)) for each in answer.proposals])
    names = ("step", "time_s", "load_angle_deg", "speed_steps_per_s")
    rotor = Rows(names, zip(*(getattr(answer.rotor, name) for name in names), strict=True))
    show(format, answer, figures, *([proposals] if answer.proposals else []), listed=rotor)


def _changes(changes: Sequence[ChangeAnswer]) -> str:
    return ", ".join(f"{each.field} = {each.value}" for each in changes)


def stall_map(
    where: Where,
    design: DesignFile,
    over: Annotated[
        Literal["slew_speed", "load", "supply_voltage"],
        typer.Option("--over", help="what is varied beside the acceleration"),
    ] = "slew_speed",
    range: Ends = None,
    cells: Annotated[
        int | None,
        typer.Option(
            "--cells",
            help="along each side: 8, 16, 32, 64 or 128",
            autocompletion=completing(lambda: ("8", "16", "32", "64", "128")),
        ),
    ] = None,
    format: Format = "table",
) -> None:
    """Have a stall map computed: verdicts over the acceleration and another value. CSV has a row for each point."""
    ends = None if range is None else tuple(range)
    with progress("Stall map") as told:
        # One end alone, or three, are refused as over HTTP.
        answer = where.client.stall_map(design_of(design), over, range=ends, cells=cells, tell=told)  # type: ignore[arg-type]
    accelerations, values = answer.accelerations_steps_per_s2, answer.over_values
    rows = (
        (acceleration, value, VERDICTS[verdict] if verdict >= 0 else "not known")
        for acceleration, verdicts in zip(accelerations, answer.verdicts, strict=True)
        for value, verdict in zip(values, verdicts, strict=True)
    )
    listed = Rows(("acceleration_steps_per_s2", f"{over} [{answer.over_unit}]", "verdict"), rows)
    picture = Rows(
        ("acceleration [steps/s²]", f"{over} from {values[0]:,.4g} to {values[-1]:,.4g} {answer.over_unit}"),
        [
            (acceleration, " ".join(MARKS[verdict] for verdict in verdicts))
            for acceleration, verdicts in reversed(list(zip(accelerations, answer.verdicts, strict=True)))
        ],
    )
    show(format, answer, picture, listed=listed)
    if format == "table":
        tell("  ".join(f"{mark} {name}" for mark, name in zip(MARKS, VERDICTS, strict=False)))
        tell(f"the design itself: {VERDICTS[answer.design_point.verdict]}")
