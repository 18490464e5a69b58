"""Answers: in time, and no refusals without a reason."""

from collections.abc import Sequence

import numpy as np

from firmware.checker import CYCLES_PER_S
from firmware.flight.exchange import NO_ANSWER, Exchange
from firmware.flight.judgement import Judgement, at
from firmware.flight.motion import Flight
from firmware.protocol import HALT, MOVING, OK, STATUS, STOP, TOO_FAST, Status

ANSWER_MS, STOP_MS = 100.0, 10.0


def judge_answers(flights: Sequence[Flight], heard: Sequence[Exchange], found: Judgement) -> None:
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
