"""What the route takes for captured files, and what it answers."""

from typing import Annotated, Any, Literal, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from stepramp.capture.analysis import Analysis, MeasuredMove, Wanted
from stepramp.capture.deviation import Alignment, Deviation, Figures
from stepramp.capture.recording import MOST_EDGES, UNKNOWN, FormatName
from stepramp.capture.steps import Edge
from stepramp.design import MOST_STEPS, Design
from stepramp.http_api.answer import Answer, Numbers, NumbersOrNull, WholeNumbers
from stepramp.numerics.compiled import counted
from stepramp.ramp.profile import Phase
from stepramp.ramp.thinning import kept_steps_of_all
from stepramp.units import MICROSECONDS_PER_SECOND
from stepramp.validation import Document, Within

MOST_LISTED = 1000
"""So many moves, and so many steps of a kind, are listed; all are counted."""
POINTS = 2000

"""Python's own reading also takes blanks, `1_000`, `nan` and other scripts' digits."""


class CapturePayload(Document):
    """What is wanted of a captured file: the parameters of the request, since the file is its body."""

    design: Design | None = Field(
        None, description="A design document as JSON, whose planned move the measured one is held against"
    )
    step_channel: str | None = Field(None, description="Name of the channel that steps; left out: the likeliest")
    direction_channel: str | None = Field(
        None, description="Name of the channel that says in what direction; empty: none; left out: if a name says so"
    )
    edge: Edge | None = Field(None, description="Which edges step; left out: rising, or both where the name says so")
    move_number: Annotated[int, Within(1, MOST_EDGES)] | None = Field(
        None,
        description="Which of the moves, counted from 1; left out: the one nearest to the design's, or the longest",
    )
    alignment: Alignment = Field(
        "first_step",
        description="first_step: the first measured step lies on the first planned one. best_fit: all are shifted so "
        "that the sum of the squared deviations is least; the capture may also begin within the move",
    )
    shortest_pulse_us: Annotated[float, Within(0, 1_000_000, "µs")] | None = Field(
        None, description="Shorter pulses are marked [µs]"
    )
    longest_wait_us: Annotated[float, Within(1, 1_000_000_000, "µs")] | None = Field(
        None,
        description="A longer wait is between two moves [µs]; left out: 3 times the design's longest interval, but at "
        "least 20 ms; without a design 0.2 s",
    )
    max_points: Annotated[int, Within(10, MOST_STEPS, "points", ", or null for every step")] | None = Field(
        POINTS, description="Thin the arrays to about so many steps that keep the curves' shapes; null: every step"
    )

    @property
    def wanted(self) -> Wanted:
        """What is wanted, without the design."""
        return Wanted(
            self.step_channel,
            self.direction_channel,
            self.edge,
            self.move_number,
            self.alignment,
            self.shortest_pulse_us,
            self.longest_wait_us,
        )


def _described() -> list[dict[str, Any]]:
    """Return the parameters of a request as OpenAPI describes them."""
    described = CapturePayload.model_json_schema(ref_template="#/components/schemas/{model}")["properties"]
    design = {"type": "string", "description": described["design"]["description"]}
    described["design"] = design
    return [
        {"name": name, "in": "query", "required": False, "description": schema.pop("description"), "schema": schema}
        for name, schema in described.items()
    ]


PARAMETERS = _described()


class ChannelAnswer(Answer):
    """A channel of the file."""

    name: str
    edges: int = Field(description="How often its level changes")


class CapturedMoveAnswer(Answer):
    """A move that was captured: steps without a pause or a change of direction between them."""

    move: int = Field(description="Its number, counted from 1")
    steps: int = Field(description="How many steps it has [steps]")
    begin_s: float = Field(description="Instant of its first step in the file [s]")
    duration_s: float = Field(
        description="From its first step to its last; a profile's duration_s also has the wait after that [s]"
    )
    direction_level: Literal[0, 1] | None = Field(
        description="Level of the direction channel, 0 low, 1 high; null without one"
    )


class MarkedStepsAnswer(Answer):
    """Steps that something is wrong with: how many, and the first of them."""

    count: int = Field(description="How many [steps]")
    step: WholeNumbers = Field(description=f"The first {MOST_LISTED:,}, counted from 1 [steps]")
    time_s: Numbers = Field(description="When they were made, or were to be made; as the move's time_s [s]")


class ShortPulsesAnswer(MarkedStepsAnswer):
    """Measured steps whose pulses are too short."""

    pulse_us: Numbers = Field(description="How long their pulses are [µs]")


class DeviationFiguresAnswer(Answer):
    """How far the steps are from the planned ones, in a few figures."""

    largest_us: float = Field(description="The largest, without its sign [µs]")
    largest_at_step: int = Field(description="Of which measured step, counted from 1")
    mean_us: float = Field(description="The mean; positive is later than planned [µs]")
    rms_us: float = Field(description="The root of the mean square [µs]")
    clock_ppm: float | None = Field(
        description="Rise of the straight line through the deviations: by how many millionths the move is slower than "
        "planned, as when the controller's clock is slow; null where they are on no such line [1e-6]"
    )
    no_clock: str = Field(description="Why clock_ppm is null, as a sentence; else empty")


class DeviationAnswer(Answer):
    """A measured move laid over the planned one."""

    planned_steps: int = Field(description="Length of the planned move [steps]")
    planned_duration_s: float = Field(description="From the planned move's first step to its last, as duration_s [s]")
    matched_steps: int = Field(description="How many measured steps are planned ones [steps]")
    shift_s: float = Field(description="What was added to the time since the move's first step to align it [s]")
    figures: DeviationFiguresAnswer
    missing: MarkedStepsAnswer = Field(description="Planned steps that were not made, by their numbers in the plan")
    extra: MarkedStepsAnswer = Field(
        description="Measured steps that were not planned, by their numbers in the capture's move"
    )
    planned_step: WholeNumbers = Field(description="Of each listed step, which planned one it is; 0: none [steps]")
    deviation_us: NumbersOrNull = Field(description="How much later than planned it was made; null: not planned [µs]")


class MeasuredMoveAnswer(CapturedMoveAnswer):
    """The move that was chosen, step by step, thinned for plots."""

    step: WholeNumbers = Field(description="Which steps the arrays are of, counted from 1 [steps]")
    time_s: Numbers = Field(
        description="When they were made, laid over the planned move, whose first step is at 0; without a design from "
        "the first step on [s]"
    )
    interval_us: NumbersOrNull = Field(description="Wait until the next step; null for the last [µs]")
    speed_steps_per_s: NumbersOrNull = Field(description="One step in that wait; null when there is none [steps/s]")
    short_pulses: ShortPulsesAnswer | None = Field(description="null unless a shortest pulse is given")
    deviation: DeviationAnswer | None = Field(description="null without a design")

    @classmethod
    def of_move(cls, analysis: Analysis, move: MeasuredMove, payload: CapturePayload) -> Self:
        """Return a measured move as an answer."""
        deviation = analysis.deviation
        time_s = move.time_s if deviation is None else move.time_s + deviation.shift_s
        interval_s = np.append(np.diff(move.time_s), np.nan)
        kept = _kept(interval_s, deviation, payload.max_points)
        listed = move.short_pulses[:MOST_LISTED]
        interval_s = interval_s[kept]
        speed = np.divide(1.0, interval_s, out=np.full(kept.size, np.nan), where=interval_s > 0)
        short = ShortPulsesAnswer(
            count=move.short_pulses.size,
            step=listed + 1,
            time_s=time_s[listed],
            pulse_us=move.short_pulse_us[:MOST_LISTED],
        )
        return cls(
            move=move.number,
            steps=move.time_s.size,
            begin_s=move.begin_s,
            duration_s=float(move.time_s[-1]),
            direction_level=_level(move.direction_level),
            step=kept + 1,
            time_s=time_s[kept],
            interval_us=interval_s * MICROSECONDS_PER_SECOND,
            speed_steps_per_s=speed,
            short_pulses=None if payload.shortest_pulse_us is None else short,
            deviation=None if deviation is None else _deviation(deviation, time_s, kept),
        )


class CaptureAnswer(Answer):
    """What a captured file shows."""

    format: FormatName
    channels: list[ChannelAnswer]
    step_channel: str = Field(description="The channel that was taken for the steps")
    direction_channel: str | None = Field(description="The channel that was taken for the direction; null: none")
    edge: Edge = Field(description="The edge that was taken for a step")
    sample_rate_hz: float | None = Field(description="How often the analyser looked, where the file says so [Hz]")
    tick_s: float = Field(description="Finest difference between two instants of the file [s]")
    duration_s: float = Field(description="From the file's first instant to its last [s]")
    longest_wait_us: float = Field(description="Longer waits are between two moves [µs]")
    remarks: list[str] = Field(description="What is odd about the file, as sentences")
    steps: int = Field(description="Steps of all moves together [steps]")
    move_count: int = Field(description="How many moves there are")
    moves: list[CapturedMoveAnswer] = Field(description=f"The first {MOST_LISTED:,} of them")
    move: MeasuredMoveAnswer | None = Field(description="The move that was chosen; null when there is no step")

    @classmethod
    def of(cls, analysis: Analysis, payload: CapturePayload) -> Self:
        """Return what a recording shows as an answer."""
        recording, choice, moves = analysis.recording, analysis.choice, analysis.moves
        edges = recording.edges_of().tolist()
        span = (recording.end_ticks - recording.begin_ticks) * recording.tick_s
        rate = recording.sample_rate_hz
        return cls(
            format=recording.format,
            channels=[
                ChannelAnswer(name=name, edges=count) for name, count in zip(recording.channels, edges, strict=True)
            ],
            step_channel=recording.channels[choice.step],
            direction_channel=None if choice.direction is None else recording.channels[choice.direction],
            edge=choice.edge,
            sample_rate_hz=None if rate is None else float(rate),
            tick_s=float(recording.tick_s),
            duration_s=float(span),
            longest_wait_us=analysis.pause_s * MICROSECONDS_PER_SECOND,
            remarks=list(recording.remarks),
            steps=analysis.steps.ticks.size,
            move_count=moves.first.size,
            moves=[_listed(analysis, number) for number in range(min(MOST_LISTED, moves.first.size))],
            move=None if analysis.move is None else MeasuredMoveAnswer.of_move(analysis, analysis.move, payload),
        )


def _listed(analysis: Analysis, number: int) -> CapturedMoveAnswer:
    ticks, tick_s = analysis.steps.ticks, analysis.recording.tick_s
    first, steps = int(analysis.moves.first[number]), int(analysis.moves.steps[number])
    return CapturedMoveAnswer(
        move=number + 1,
        steps=steps,
        begin_s=float(int(ticks[first]) * tick_s),
        duration_s=float(int(ticks[first + steps - 1] - ticks[first]) * tick_s),
        direction_level=_level(int(analysis.steps.direction_levels[first])),
    )


def _level(level: int) -> Literal[0, 1] | None:
    return None if level == UNKNOWN else 1 if level else 0


def _kept(interval_s: NDArray[np.float64], deviation: Deviation | None, most: int | None) -> NDArray[np.int64]:
    """Return which steps are told of, counted from 0."""
    if most is None or interval_s.size <= most:
        return counted(0, interval_s.size)
    curves = [interval_s] if deviation is None else [interval_s, deviation.deviation_us]
    phases = (Phase("slew", 1, interval_s.size),)
    return kept_steps_of_all([np.nan_to_num(each) for each in curves], phases, most)


def _deviation(deviation: Deviation, time_s: NDArray[np.float64], kept: NDArray[np.int64]) -> DeviationAnswer:
    extra, missing = deviation.extra[:MOST_LISTED], deviation.missing[:MOST_LISTED]
    return DeviationAnswer(
        planned_steps=deviation.planned_s.size,
        planned_duration_s=float(deviation.planned_s[-1] - deviation.planned_s[0]),
        matched_steps=time_s.size - deviation.extra.size,
        shift_s=deviation.shift_s,
        figures=_figures(deviation.figures),
        missing=MarkedStepsAnswer(count=deviation.missing.size, step=missing + 1, time_s=deviation.planned_s[missing]),
        extra=MarkedStepsAnswer(count=deviation.extra.size, step=extra + 1, time_s=time_s[extra]),
        planned_step=deviation.planned_step[kept] + 1,
        deviation_us=deviation.deviation_us[kept],
    )


def _figures(figures: Figures) -> DeviationFiguresAnswer:
    return DeviationFiguresAnswer(
        largest_us=figures.largest_us,
        largest_at_step=figures.largest_at_step + 1,
        mean_us=figures.mean_us,
        rms_us=figures.rms_us,
        clock_ppm=figures.clock_ppm,
        no_clock=figures.no_clock,
    )
