"""What a client can have computed: a design in, what the API answers out."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Literal
from urllib.parse import quote

from stepramp.client.calls import PLANNING_S, PUSHING_S, Call, Pause, Script, get, payload, post
from stepramp.client.refusals import error_of_items
from stepramp.design import Design, MethodName
from stepramp.errors import Refused, Rejected, Rejection
from stepramp.http_api.capture_models import CaptureAnswer, CapturePayload
from stepramp.http_api.exports_models import ExportPayload
from stepramp.http_api.jobs_models import JobAnswer
from stepramp.http_api.motor_fastest_models import FastestAnswer, FastestPayload
from stepramp.http_api.motor_models import SimulateAnswer, SimulatePayload, TorqueAnswer, TorquePayload
from stepramp.http_api.motor_presets_models import MotorPresetsAnswer
from stepramp.http_api.planning_models import (
    CurveName,
    ErrorsAnswer,
    ErrorsPayload,
    ExamplesAnswer,
    HealthAnswer,
    ProfileAnswer,
    ProfilePayload,
)
from stepramp.http_api.schedule_models import ScheduleAnswer, SchedulePayload
from stepramp.http_api.stall_map_models import MapPayload, StallMapAnswer, StartedAnswer
from stepramp.http_api.tables_models import FitAnswer, FitPayload, PlayAnswer, PlayPayload
from stepramp.motor.map_points import Over

ADesign = Design | Mapping[str, object]
"""A design, or its document."""
ASKED_EVERY_S = 0.2
"""How often it is asked how far a job is [s]."""
MOST_FILE_BYTES = 2**28
"""Size of the largest file that a server takes [bytes]."""


def health() -> Call[HealthAnswer]:
    """Return that the server works, and its version."""
    return get("health", HealthAnswer)


def examples() -> Call[ExamplesAnswer]:
    """Return designs to start from."""
    return get("examples", ExamplesAnswer)


def motor_presets() -> Call[MotorPresetsAnswer]:
    """Return motors that many people have."""
    return get("motor/presets", MotorPresetsAnswer)


def profile(design: ADesign, *, max_points: int | None = None) -> Call[ProfileAnswer]:
    """Plan a design's move: its steps, phases and a summary. max_points: about so many steps; None: all."""
    body = payload(ProfilePayload, design=design, max_points=max_points)
    return post("profile", ProfileAnswer, body, patience_s=PLANNING_S)


def errors(
    design: ADesign,
    methods: Sequence[MethodName],
    *,
    reference: MethodName | None = None,
    curves: Sequence[CurveName] | None = None,
    segment_bound_ticks: int | None = None,
    max_points: int | None = None,
) -> Call[ErrorsAnswer]:
    """Compare methods with a reference, step by step."""
    body = payload(
        ErrorsPayload,
        design=design,
        methods=list(methods),
        reference=reference,
        curves=None if curves is None else list(curves),
        segment_bound_ticks=segment_bound_ticks,
        max_points=max_points,
    )
    return post("errors", ErrorsAnswer, body, patience_s=PLANNING_S)


def fit(
    design: ADesign,
    *,
    rows: int | None = None,
    largest_relative_error: float | None = None,
    bytes: int | None = None,  # as the API calls it
    row_kind: Literal["constant", "linear"] | None = None,
    interval_unit: Literal["us", "ticks"] | None = None,
    fit_to: Literal["played", "ramp_index"] | None = None,
) -> Call[FitAnswer]:
    """Fit a lookup table to a design's ramp, by exactly one of rows, largest_relative_error and bytes."""
    body = payload(
        FitPayload,
        design=design,
        rows=rows,
        largest_relative_error=largest_relative_error,
        bytes=bytes,
        row_kind=row_kind,
        interval_unit=interval_unit,
        fit_to=fit_to,
    )
    return post("table/fit", FitAnswer, body, patience_s=PLANNING_S)


def play(table: Mapping[str, object], range_steps: int, targets: Sequence[tuple[int, int]]) -> Call[PlayAnswer]:
    """Play a table as a gauge library does. targets: when [µs] and where to [steps], in order of time."""
    asked = [{"at_us": at_us, "target": target} for at_us, target in targets]
    body = payload(PlayPayload, table=table, range_steps=range_steps, targets=asked)
    return post("table/play", PlayAnswer, body, patience_s=PLANNING_S)


def schedule(
    designs: Sequence[ADesign],
    mode: Literal["independent", "line"] = "independent",
    *,
    max_points: int | None = None,
    shortest_spacing_us: float | None = None,
) -> Call[ScheduleAnswer]:
    """Plan up to four axes together."""
    body = payload(
        SchedulePayload,
        designs=list(designs),
        mode=mode,
        max_points=max_points,
        shortest_spacing_us=shortest_spacing_us,
    )
    return post("schedule", ScheduleAnswer, body, patience_s=PLANNING_S)


def torque(design: ADesign, speeds_rpm: Sequence[float]) -> Call[TorqueAnswer]:
    """Return the torque that a design's motor has, and the one that its ramp asks for, at speeds of its shaft."""
    body = payload(TorquePayload, design=design, speeds_rpm=list(speeds_rpm))
    return post("motor/torque", TorqueAnswer, body, patience_s=PLANNING_S)


def simulate(design: ADesign, *, max_points: int | None = None, with_proposals: bool = True) -> Call[SimulateAnswer]:
    """Play a design's move through its motor's model: whether it stalls, why, and what to change."""
    body = payload(SimulatePayload, design=design, max_points=max_points, with_proposals=with_proposals)
    return post("motor/simulate", SimulateAnswer, body, patience_s=PLANNING_S)


def fastest(design: ADesign, *, margin: float | None = None) -> Call[FastestAnswer]:
    """Return the fastest safe ramps of a design's motor."""
    return post(
        "motor/fastest", FastestAnswer, payload(FastestPayload, design=design, margin=margin), patience_s=PLANNING_S
    )


def stall_map(
    design: ADesign,
    over: Over = "slew_speed",
    *,
    range: tuple[float, float] | None = None,  # as the API calls it
    accelerations_steps_per_s2: tuple[float, float] | None = None,
    cells: int | None = None,
    tell: Callable[[float], None] = lambda _: None,
) -> Script[StallMapAnswer]:
    """Have a stall map computed, and wait for all of it. tell: called with how far it is, from 0 to 1.

    Whoever gives up waiting has it cancelled.
    """
    body = payload(
        MapPayload,
        design=design,
        over=over,
        range=range,
        accelerations_steps_per_s2=accelerations_steps_per_s2,
        cells=cells,
    )
    started: StartedAnswer = yield post("motor/map", StartedAnswer, body, patience_s=PLANNING_S)
    path = f"jobs/{quote(started.id, safe='')}"
    has_ended = False
    try:
        while True:
            job: JobAnswer = yield get(path, JobAnswer)
            tell(job.progress)
            if job.state not in ("waiting", "running"):
                break
            yield Pause(ASKED_EVERY_S)
        has_ended = True
    finally:
        if not has_ended:
            yield Call("DELETE", path, JobAnswer.model_validate_json)
    if job.errors:
        raise error_of_items(job.errors)
    if job.state != "done" or job.result is None:
        raise Refused(f"The stall map was {job.state} before it was done.")
    return job.result


def export(
    design: ADesign,
    format: str,  # as the API calls it
    *,
    name: str | None = None,
    methods: Sequence[MethodName] | None = None,
    arithmetic: str | None = None,
    segment_bound_ticks: int | None = None,
    axis_letter: str | None = None,
) -> Call[bytes]:
    """Return a design as a file's content: C code, settings of a machine, CSV, a page of plots, a picture."""
    body = payload(
        ExportPayload,
        design=design,
        name=name,
        methods=None if methods is None else list(methods),
        arithmetic=arithmetic,
        segment_bound_ticks=segment_bound_ticks,
        axis_letter=axis_letter,
    )
    return Call("POST", f"export/{quote(format, safe='')}", bytes, body, patience_s=PLANNING_S)


def capture(content: bytes | Path, design: ADesign | None = None, **wanted: str | float | None) -> Call[CaptureAnswer]:
    """Show the steps of a logic analyser's file next to a design's. wanted: other parameters of `POST /capture`.

    Of a file no more is read than a server takes. Raises Rejected where it is larger.
    """
    given = {name: value for name, value in wanted.items() if value is not None}
    checked = CapturePayload.checked(given if design is None else {**given, "design": design})
    parameters = {name: str(value) for name, value in given.items()}
    if checked.design is not None:
        parameters["design"] = checked.design.model_dump_json(by_alias=True)
    return Call(
        "POST",
        "capture",
        CaptureAnswer.model_validate_json,
        _content_of(content) if isinstance(content, Path) else content,
        content_type="application/octet-stream",
        parameters=parameters,
        patience_s=PUSHING_S,
    )


def _content_of(path: Path) -> bytes:
    with path.open("rb") as file:
        content = file.read(MOST_FILE_BYTES + 1)
    if len(content) > MOST_FILE_BYTES:
        raise Rejected([Rejection("content", str(path), f"a file of up to {MOST_FILE_BYTES:,} bytes")])
    return content
