"""A judge of motors in flight: says what is wrong with what a controller did and said while requests changed its moves.

It knows the edges of the pins, the frames on the line and the ramps that were delivered, not how the firmware plays
them. What it asks for stands in docs/serial_protocol.md. Times are cycles of 1/16 µs.
"""

import struct
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from firmware.checker import CYCLES_PER_S, CYCLES_PER_US, Axis, Cycles, Edges, axis_of
from firmware.protocol import (
    HALT,
    LINE,
    MOVE_BY,
    MOVE_TO,
    MOVING,
    OK,
    REPORT_NOTICE,
    RUN,
    STATUS,
    STOP,
    TOO_FAST,
    Settings,
    Status,
    decode_frame,
)
from simulator.avr import Conversation, Frame

Ticks = npt.NDArray[np.float64]

BLOCKED_US, LOADING_US, LONGEST_INTERRUPT_US = 5.0, 11.0, 32.5
"""What a step may have to wait for: a blocked section (firmware/avr/engine.c), another axis that loads a segment (94
and 85 cycles: firmware/avr/engine.S), the two axes of the other channel (520 cycles: budget.toml)."""
LATE_US = (
    3.1,
    BLOCKED_US + LOADING_US,
    BLOCKED_US + LONGEST_INTERRUPT_US,
    BLOCKED_US + LONGEST_INTERRUPT_US + LOADING_US,
)
"""How late a step may be when 1, 2, 3, 4 axes move; alone: firmware/README.md."""
WIDEST_DEAF_US = 10
"""Wider pulses let the serial port's interrupts in, which nothing interrupts then."""
BESIDE_WIDE_PULSES_US = 1.6
"""Their 75 cycles rather than 3.1 us."""
LINE_LATE_US = 4.5
TOGETHER_US = 1.0
"""So near to the leader's steps of a line are those of its other axes."""
LEAST_PULSE_US = 1.0
WINDOWS = (1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 128, 256, 512)
"""Steps over which a change of speed is looked at."""

ANSWER_MS, STOP_MS, LAST_STEP_AFTER_HALT_MS = 100.0, 10.0, 2.0
AHEAD_MS, AHEAD_STEPS = 20.0, 24
"""A request has come into effect after so long and so many more steps: what is queued is played before."""
BITS_OF_BYTE, BAUD = 10, 115_200
IN_TRANSMITTER_CYCLES = 2 * BITS_OF_BYTE * CYCLES_PER_S / BAUD
"""The last two bytes may still be on their way when the last one has been given to the transmitter."""

NO_ANSWER = 255
ORDERS = (MOVE_BY, MOVE_TO, RUN, LINE)


# ---- what was asked for


@dataclass(frozen=True)
class Slopes:
    """How fast the speed of an axis may change: intervals from rest on, the longest first [ticks]."""

    up: Ticks
    down: Ticks
    slew: int
    places: int = 0
    """An interval that lies between two of a list may count as one so many places on."""
    last_places: int = 1
    """So many intervals of the way down may be left out or unseen before rest: no step follows the last one."""


@dataclass(frozen=True)
class Setting:
    """What a flight must keep to."""

    slopes: Sequence[Slopes]
    """Of each axis."""
    cycles_per_tick: int
    settings: Settings

    @property
    def late_cycles(self) -> float:
        """How late a step may be: what is stated, and the pulses of the others [cycles]."""
        others = len(self.slopes) - 1
        late_us = LATE_US[others] + (BESIDE_WIDE_PULSES_US if self.settings.pulse_width_us > WIDEST_DEAF_US else 0)
        return (late_us + others * self.settings.pulse_width_us) * CYCLES_PER_US + self.cycles_per_tick


@dataclass(frozen=True)
class Exchange:
    """A request and its answer."""

    kind: int
    body: bytes
    came: int
    """When its first bit came [cycles]."""
    arrived: int
    """When it was there."""
    answered: int
    """When its answer began."""
    gone: float
    """When its answer had gone."""
    status: int
    reply: bytes
    """The rest of the answer's body."""

    @property
    def is_granted(self) -> bool:
        return self.status == OK

    @property
    def values(self) -> dict[int, int]:
        """Return the number for each axis that it names."""
        axes = [axis for axis in range(4) if self.body[0] >> axis & 1]
        return dict(zip(axes, (v for (v,) in struct.iter_unpack("<i", self.body[-4 * len(axes) :])), strict=True))

    @property
    def targets(self) -> dict[int, int]:
        """Return the targets that it is answered with."""
        return dict(zip(self.values, (v for (v,) in struct.iter_unpack("<i", self.reply)), strict=True))

    def concerns(self, axis: int) -> bool:
        return self.kind in (*ORDERS, STOP, HALT) and (not self.body or bool(self.body[0] >> axis & 1))


def message_of(frame: Frame) -> bytes | None:
    """Return the message of a frame; None of one that was cut short, so that a stop's reply goes at once."""
    try:
        return decode_frame(frame.data)
    except (AssertionError, IndexError):
        assert not frame.is_sent
        return None


def exchanges(frames: Iterable[Frame]) -> list[Exchange]:
    """Return the requests of a conversation; those that were not answered have the status NO_ANSWER."""
    found, asked = list[Exchange](), dict[bytes, Frame]()
    for frame in frames:
        message = message_of(frame)
        if message is None:
            continue
        if frame.is_sent:
            asked[message[:4]] = frame
        elif message[0] < REPORT_NOTICE:
            request = asked.pop(bytes([message[0] & 0x7F]) + message[1:4])
            body = decode_frame(request.data)[4:]
            times = (request.begin, request.end, frame.begin, frame.end + IN_TRANSMITTER_CYCLES)
            found.append(Exchange(message[0] & 0x7F, body, *times, message[4], message[5:]))
    for header, request in asked.items():
        body, end = decode_frame(request.data)[4:], request.end
        found.append(Exchange(header[0], body, request.begin, end, end, end, NO_ANSWER, b""))
    return sorted(found, key=lambda one: one.came)


# ---- the judgement


@dataclass
class Judgement:
    """What is wrong, and what was measured."""

    faults: list[str] = field(default_factory=list)
    latest_us: float = 0.0
    """How much longer an interval was than the ramp allows at its place."""
    slowest_stop_ms: float = 0.0
    """From the first bit of a stop or halt to the last one of its answer."""
    in_flight: int = 0
    """Requests while a motor moved."""
    starved: int = 0

    def add(self, fault: str) -> None:
        self.faults.append(fault)


def at(cycles: float) -> str:
    return f"at {cycles / CYCLES_PER_S * 1e3:.3f} ms"


def us(cycles: float) -> str:
    return f"{cycles / CYCLES_PER_US:.2f} us"


@dataclass(frozen=True)
class Flight:
    """What an axis did, and what it was told."""

    axis: int
    made: Axis
    setting: Setting
    heard: Sequence[Exchange]
    lines: Sequence[tuple[Exchange, float]]
    """Each line with steps, and until when it may move [cycles]."""

    @property
    def orders(self) -> list[Exchange]:
        """Return what has changed its motion."""
        return [one for one in self.heard if one.is_granted and one.concerns(self.axis)]

    def travel(self, cycle: float) -> int:
        """Return where the steps until then have led [steps]."""
        count = int(np.searchsorted(self.made.steps, cycle, side="right"))
        return int(2 * self.made.forward[:count].sum() - count)

    def travels(self, begin: float, end: float) -> range:
        """Return where it has been between two moments."""
        first, last = (int(np.searchsorted(self.made.steps, cycle)) for cycle in (begin, end))
        way = self.travel(begin) + np.concatenate(([0], np.cumsum(2 * self.made.forward[first:last].astype(int) - 1)))
        return range(int(way.min()) - 1, int(way.max()) + 2)


def judge(conversation: Conversation, setting: Setting) -> Judgement:
    """Return what is wrong with a flight. All motors must be at rest at its end."""
    found = Judgement()
    heard = exchanges(conversation.frames)
    axes = [axis_at(conversation.edges, axis, setting) for axis in range(len(setting.slopes))]
    lines = line_windows(heard, np.sort(np.concatenate([axis.steps for axis in axes])))
    flights = [Flight(number, axis, setting, heard, lines) for number, axis in enumerate(axes)]
    for flight in flights:
        _judge_pins(flight, found)
        _judge_halts(flight, found)
        _judge_words(flight, found)
        for piece in _pieces(flight):
            _judge_speed(piece, found)
            _judge_orders(piece, found)
    _judge_lines(flights, found)
    _judge_answers(flights, heard, found)
    if conversation.statistics["lost_bytes"] or conversation.statistics["resets"] > 1:
        found.add(f"{conversation.statistics['lost_bytes']} bytes lost, {conversation.statistics['resets']} resets")
    return found


def axis_at(edges: Edges, axis: int, setting: Setting) -> Axis:
    """Return what the pins of an axis did since they were set up: at their first levels none of them has stepped."""
    settings = setting.settings
    return axis_of(
        edges,
        axis,
        step_inverted=bool(settings.step_inverted >> axis & 1),
        direction_inverted=bool(settings.direction_inverted >> axis & 1),
        both_edges=bool(settings.both_edges >> axis & 1),
    )


# ---- pins


def _judge_pins(flight: Flight, found: Judgement) -> None:
    """Pulses long enough and complete, the direction set in time, and only at rest."""
    made, settings = flight.made, flight.setting.settings
    width = max(settings.pulse_width_us, LEAST_PULSE_US) * CYCLES_PER_US
    if not settings.both_edges >> flight.axis & 1:
        if made.ends.size != made.steps.size or (made.ends <= made.steps).any():
            found.add(f"axis {flight.axis}: a pulse without an end")
        elif made.steps.size:
            pulses, pauses = made.ends - made.steps, made.steps[1:] - made.ends[:-1]
            if pulses.min() < width:
                found.add(f"axis {flight.axis}: a pulse of {us(pulses.min())} {at(made.steps[pulses.argmin()])}")
            if pauses.size and pauses.min() < LEAST_PULSE_US * CYCLES_PER_US:
                found.add(f"axis {flight.axis}: a pause of {us(pauses.min())} {at(made.ends[pauses.argmin()])}")
    for turn in made.turns:
        after = int(np.searchsorted(made.steps, turn))
        if after < made.steps.size and made.steps[after] - turn < settings.direction_setup_us * CYCLES_PER_US:
            found.add(f"axis {flight.axis}: a step {us(made.steps[after] - turn)} after the direction {at(turn)}")


def _judge_halts(flight: Flight, found: Judgement) -> None:
    """No step long after a halt."""
    for number, one in enumerate(flight.orders):
        if one.kind != HALT:
            continue
        later = [other.arrived for other in flight.orders[number + 1 :] if other.kind in ORDERS]
        first, end = np.searchsorted(flight.made.steps, [one.arrived, min(later, default=np.inf)])
        if end > first:
            last_ms = (flight.made.steps[end - 1] - one.arrived) / CYCLES_PER_S * 1e3
            if last_ms > LAST_STEP_AFTER_HALT_MS:
                found.add(f"axis {flight.axis}: a step {last_ms:.2f} ms after a halt {at(one.arrived)}")


# ---- speed


@dataclass(frozen=True)
class Piece:
    """Steps that an axis made from rest, to rest or to a halt, along its own ramp or leading a line."""

    flight: Flight
    begin: int
    end: int
    """Of its steps."""
    slopes: Slopes
    ends_at_rest: bool
    late: float
    """[cycles]"""

    @property
    def steps(self) -> npt.NDArray[np.int64]:
        return self.flight.made.steps[self.begin : self.end]

    @property
    def forward(self) -> npt.NDArray[np.bool_]:
        return self.flight.made.forward[self.begin : self.end]

    def where(self, interval: int) -> str:
        return f"axis {self.flight.axis} {at(self.steps[interval])}"

    def in_cycles(self, ticks: npt.ArrayLike) -> Ticks:
        return np.asarray(ticks, float) * self.flight.setting.cycles_per_tick


def line_windows(heard: Iterable[Exchange], steps: Cycles) -> list[tuple[Exchange, float]]:
    """Return each line with steps, and until when it may move [cycles], by the steps of all axes."""
    motions = [one for one in heard if one.kind in ORDERS and one.is_granted]
    ends = [_rest_before(one, steps) for one in motions[1:]] + [np.inf]
    pairs = zip(motions, ends, strict=True) if motions else ()
    return [(one, end) for one, end in pairs if one.kind == LINE and any(one.values.values())]


def _rest_before(one: Exchange, steps: Cycles) -> float:
    """Return when motors rested before a request was granted: it may have waited while a line came to its end."""
    first, last = np.searchsorted(steps, [one.arrived, one.answered])
    moments = np.concatenate(([one.arrived], steps[first:last], [one.answered]))
    longest = int(np.diff(moments).argmax())
    return float(moments[longest] + moments[longest + 1]) / 2


def leader_of(line: Exchange) -> int:
    values = line.values
    return max(values, key=lambda axis: (abs(values[axis]), -axis))


def _pieces(flight: Flight) -> Iterator[Piece]:
    """Yield the axis' pieces: cut at halts and lines. In a line only its leader plays a ramp."""
    steps = flight.made.steps
    cuts = {0: True, steps.size: True}
    halts = [one.answered for one in flight.heard if one.is_granted and one.kind == HALT]
    lines = flight.lines
    for halt in halts:
        in_line = any(line.arrived < halt < end for line, end in lines)
        if in_line or any(one.answered == halt for one in flight.orders):
            cuts[int(np.searchsorted(steps, halt))] = False
    for line, end in lines:
        for moment in (line.arrived, end):
            cuts.setdefault(int(np.searchsorted(steps, moment)), True)
    ordered = sorted(cuts)
    for begin, end in pairwise(ordered):
        slopes, late = flight.setting.slopes[flight.axis], flight.setting.late_cycles
        its_line = [line for line, until in lines if line.arrived <= steps[begin] < until]
        if its_line:
            if leader_of(its_line[0]) != flight.axis:
                continue
            slopes = flight.setting.slopes[its_line[0].body[1]]
            late = LINE_LATE_US * CYCLES_PER_US + flight.setting.cycles_per_tick
        yield Piece(flight, begin, end, slopes, cuts[end], late)


def _judge_speed(piece: Piece, found: Judgement) -> None:
    """From step to step, and over more of them, the speed changes no faster than the ramp's; and never beyond it."""
    intervals = np.diff(piece.steps).astype(float)
    slew = float(piece.in_cycles(piece.slopes.slew))
    if intervals.size and intervals.min() < slew - piece.late:
        found.add(f"{piece.where(int(intervals.argmin()))}: {us(intervals.min())}, the slew interval is {us(slew)}")
    with_rests = np.concatenate(([np.inf], intervals, [np.inf] if piece.ends_at_rest else []))
    for count in WINDOWS:
        if count < with_rests.size:
            before, after = with_rests[:-count], with_rests[count:]
            good_so_far = len(found.faults)
            _judge_rise(piece, count, before, after, found)
            _judge_fall(piece, count, before, after, found)
            if len(found.faults) > good_so_far:
                break
    _judge_turns(piece, intervals, found)


def _judge_rise(piece: Piece, count: int, before: Ticks, after: Ticks, found: Judgement) -> None:
    slopes, up = piece.slopes, piece.in_cycles([*piece.slopes.up, piece.slopes.slew])
    place = np.searchsorted(-up, -(before - piece.late), side="right") - 1
    place += count + slopes.places
    too_short = up[np.minimum(place, up.size - 1)] - piece.late - after
    worst = int(too_short.argmax())
    if too_short[worst] > 0:
        over = "" if count == 1 else f" over {count} steps"
        found.add(
            f"{piece.where(max(worst + count - 1, 0))}: the speed rises too fast{over}: {us(before[worst])}, then "
            f"{us(after[worst])}, {us(too_short[worst])} too short"
        )


def _judge_fall(piece: Piece, count: int, before: Ticks, after: Ticks, found: Judgement) -> None:
    slopes, down = piece.slopes, piece.in_cycles(piece.slopes.down)
    place = np.searchsorted(-down, -(before + piece.late), side="left") - count
    may_rest = place <= slopes.last_places - 1
    longest = np.where(may_rest, np.inf, down[np.maximum(place - slopes.places, 0)] if down.size else np.inf)
    with np.errstate(invalid="ignore"):
        too_long = np.where(may_rest, -np.inf, after - longest)
    worst = int(too_long.argmax())
    if np.isfinite(too_long[worst]):
        found.latest_us = max(found.latest_us, too_long[worst] / CYCLES_PER_US)
    if too_long[worst] > piece.late:
        over = "" if count == 1 else f" over {count} steps"
        found.add(
            f"{piece.where(max(worst + count - 2, 0))}: a pause at speed{over}: {us(before[worst])}, then "
            f"{us(after[worst])}, {us(too_long[worst])} too long"
        )


def _may_rest(piece: Piece, interval: float) -> bool:
    """Whether the motor may come to rest after such an interval."""
    down = piece.in_cycles(piece.slopes.down)
    return int((down > interval + piece.late).sum()) <= piece.slopes.last_places


def _judge_turns(piece: Piece, intervals: Ticks, found: Judgement) -> None:
    """The direction changes at rest, after the last interval has passed."""
    down = piece.in_cycles(piece.slopes.down)
    for turn in np.flatnonzero(np.diff(piece.forward.astype(int))):
        before = intervals[turn - 1] if turn else np.inf
        if not _may_rest(piece, before):
            found.add(f"{piece.where(turn)}: the direction changes at speed, after {us(before)}")
        least = (down[0] if down.size else min(before, intervals[turn])) if piece.slopes.places == 0 else 0
        least = least + piece.flight.setting.settings.direction_setup_us * CYCLES_PER_US - piece.late
        if intervals[turn] < least:
            found.add(f"{piece.where(turn)}: {us(intervals[turn])} from a step to one back, not {us(least)}")


# ---- what was ordered


def _judge_orders(piece: Piece, found: Judgement) -> None:
    """The speed dips for an order only, doesn't rise after a stop, and stays at that of a run."""
    intervals = np.diff(piece.steps).astype(float)
    flight = piece.flight
    orders = flight.orders
    _judge_dips(piece, intervals, [one for one in orders if one.kind in ORDERS], found)
    for number, one in enumerate(orders):
        until = orders[number + 1].arrived if number + 1 < len(orders) else np.inf
        first = int(np.searchsorted(piece.steps, one.answered + AHEAD_MS * CYCLES_PER_S / 1e3))
        first += AHEAD_STEPS
        part = intervals[first : max(int(np.searchsorted(piece.steps, until)) - 1, 0)]
        if one.kind not in (STOP, RUN) or part.size == 0:
            continue
        wanted = one.values[flight.axis] if one.kind == RUN else 0
        part = part[: _steps_in_direction(piece.forward[first:], wanted)]
        away = _goes_away(part, float(piece.in_cycles(abs(wanted))) if wanted else np.inf) - 2 * piece.late
        if part.size and away.max() > 0:
            what = f"a run at {us(float(piece.in_cycles(abs(wanted))))}" if wanted else "a stop"
            worst = int(away.argmax())
            found.add(
                f"{piece.where(first + worst)}: {us(part[worst])}, {us(away[worst])} off after {what} {at(one.arrived)}"
            )


def _steps_in_direction(forward: npt.NDArray[np.bool_], wanted: int) -> int:
    """Return how many intervals there are before the motor turns; none when it has yet to turn."""
    if wanted and forward[0] != (wanted > 0):
        return 0
    turns = np.flatnonzero(forward != forward[0])
    return int(turns[0]) - 1 if turns.size else forward.size


def _goes_away(intervals: Ticks, wanted: float) -> Ticks:
    """Return by how much intervals are farther from the one wanted than one before them, on the same side of it."""
    nearest_above = np.maximum(np.minimum.accumulate(intervals), wanted)
    nearest_below = np.minimum(np.maximum.accumulate(intervals), wanted)
    with np.errstate(invalid="ignore"):
        return np.maximum(np.where(np.isfinite(nearest_above), intervals - nearest_above, 0), nearest_below - intervals)


def _judge_dips(piece: Piece, intervals: Ticks, orders: Sequence[Exchange], found: Judgement) -> None:
    """Where the motor has slowed down and rises again before rest, an order has told it to."""
    for first, last in dips(intervals, 2 * piece.late):
        interval = intervals[first]
        if _may_rest(piece, interval) or _may_rest(piece, intervals[first - 1]):
            continue
        begin = piece.steps[first] - AHEAD_MS * CYCLES_PER_S / 1e3 - AHEAD_STEPS * interval
        if not any(begin <= one.answered and one.arrived <= piece.steps[last + 1] for one in orders):
            found.add(f"{piece.where(first)}: the speed dips to {us(interval)} with no order")


def dips(intervals: Ticks, least: float) -> list[tuple[int, int]]:
    """Return the first and last place of each slowest speed, from which it has fallen and rises by at least so much."""
    found, first, last, is_falling = list[tuple[int, int]](), 0, 0, False
    extreme = intervals[0] if intervals.size else 0.0
    for place in (np.flatnonzero(np.diff(intervals)) + 1).tolist():
        interval = intervals[place]
        if is_falling:
            if interval > extreme:
                first, extreme = place, interval
            if interval >= extreme - least:
                last = place
            else:
                found.append((first, last))
                is_falling, extreme = False, interval
        elif interval > extreme + least:
            first, last, is_falling, extreme = place, place, True, interval
        else:
            extreme = min(extreme, interval)
    return found


# ---- lines


def _judge_lines(flights: Sequence[Flight], found: Judgement) -> None:
    for line, end in flights[0].lines:
        leader, values = leader_of(line), line.values
        if leader >= len(flights):
            continue
        its = _between(flights[leader], line.arrived, end)
        for axis, steps in values.items():
            made = _between(flights[axis], line.arrived, end)
            if (made.forward != (steps > 0)).any():
                found.add(f"axis {axis}: steps of a line {at(line.arrived)} in the wrong direction")
            if axis == leader or steps == 0:
                continue
            most, own = abs(values[leader]), abs(steps)
            places = -(-most * (2 * np.arange(1, own + 1) - 1) // (2 * own))
            wanted = its.steps[places[places <= its.steps.size] - 1]
            if wanted.size != made.steps.size:
                found.add(f"axis {axis}: {made.steps.size} steps of a line {at(line.arrived)} instead of {wanted.size}")
            elif wanted.size and np.abs(wanted - made.steps).max() > TOGETHER_US * CYCLES_PER_US:
                found.add(f"axis {axis}: a step of a line {us(np.abs(wanted - made.steps).max())} from the leader's")


def _between(flight: Flight, begin: float, end: float) -> Axis:
    first, last = np.searchsorted(flight.made.steps, [begin, end])
    made = flight.made
    return Axis(made.steps[first:last], made.ends[first:last], made.turns, made.forward[first:last])


# ---- what was said


@dataclass
class Words:
    """What has been said of an axis: a target that has been told is where it comes to rest."""

    flight: Flight
    found: Judgement
    target: int | None = 0
    """None: it has not been told."""
    runs: bool = False

    def been(self, one: Exchange) -> range:
        """Return where the axis was when a request was answered; a step and its count are not of one instant."""
        return self.flight.travels(one.arrived - 10 * CYCLES_PER_US, one.answered + 10 * CYCLES_PER_US)

    def add(self, one: Exchange, fault: str) -> None:
        self.found.add(f"axis {self.flight.axis} {at(one.arrived)}: {fault}")

    def hear(self, one: Exchange) -> None:
        axis = self.flight.axis
        if one.kind == STATUS and one.body[0] == axis:
            self.hear_status(one, Status.unpack(one.reply))
        elif one.kind in (MOVE_BY, MOVE_TO, LINE) and axis in one.values:
            self.hear_target(one, one.values[axis], one.targets[axis])
        elif one.kind == RUN and axis in one.values:
            self.target, self.runs = None, one.values[axis] != 0
        elif one.kind in (STOP, HALT) and (one.concerns(axis) or _on_a_line(self.flight, one)):
            self.target, self.runs = None if one.kind == STOP else self.flight.travel(one.answered), False

    def hear_status(self, one: Exchange, status: Status) -> None:
        """Positions are those of the edges."""
        been, rests = self.been(one), status.axis_state == 0
        if status.position not in (been[1:-1] if rests else been):
            self.add(one, f"the position is {status.position}, the edges say {been}")
        if self.runs and not rests:
            return
        if self.target not in (None, status.target):
            self.add(one, f"the target is {status.target}, it was {self.target}")
        if rests and status.position != status.target:
            self.add(one, f"at rest at {status.position}, the target is {status.target}")
        self.target, self.runs = status.target, False

    def hear_target(self, one: Exchange, value: int, told: int) -> None:
        """From its position in a run, else from its target."""
        begins = [0] if one.kind == MOVE_TO else self.been(one) if self.runs else [self.target]
        if begins != [None] and told - value not in begins:
            whence = "a run" if self.runs else begins[0]
            self.add(one, f"{told} is told as the target, {value} from {whence}")
        self.target, self.runs = told, False


def _judge_words(flight: Flight, found: Judgement) -> None:
    words = Words(flight, found)
    for one in flight.heard:
        if one.is_granted:
            words.hear(one)


def _on_a_line(flight: Flight, one: Exchange) -> bool:
    return any(line.arrived < one.arrived < end for line, end in flight.lines)


def _judge_answers(flights: Sequence[Flight], heard: Sequence[Exchange], found: Judgement) -> None:
    """Every answer in time, refusals for a reason, and nothing starved."""
    for one in heard:
        ms = (one.gone - one.came) / CYCLES_PER_S * 1e3
        if one.kind in (STOP, HALT):
            found.slowest_stop_ms = max(found.slowest_stop_ms, ms)
        most = STOP_MS if one.kind in (STOP, HALT) else ANSWER_MS
        if ms > most:
            found.add(f"an answer to {one.kind:#x} after {ms:.2f} ms {at(one.came)}")
        if one.status == NO_ANSWER:
            found.add(f"no answer to {one.kind:#x} {at(one.came)}")
        elif one.status not in (OK, TOO_FAST, MOVING):
            found.add(f"{one.kind:#x} {at(one.came)} is refused with status {one.status}")
    final = [Status.unpack(one.reply) for one in heard if one.kind == STATUS and one.is_granted][-len(flights) :]
    if any(status.axis_state for status in final):
        found.add("not at rest at the end")
    found.starved = max(status.starved for status in final)
    if found.starved:
        found.add(f"starved {found.starved} times")
    found.in_flight = _in_flight(flights, heard)


def _in_flight(flights: Sequence[Flight], heard: Sequence[Exchange]) -> int:
    """Return how many requests came while a motor was between two steps of a move."""
    count = 0
    steps = np.sort(np.concatenate([flight.made.steps for flight in flights]))
    for one in heard:
        place = int(np.searchsorted(steps, one.arrived))
        count += 0 < place < steps.size and steps[place] - steps[place - 1] < 0.1 * CYCLES_PER_S
    return count
