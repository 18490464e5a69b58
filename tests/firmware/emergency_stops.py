"""Emergency stops of the controller with motors at their limits, and how soon each is obeyed."""

import random
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
import numpy.typing as npt

from firmware.flight.exchange import Exchange, exchanges
from firmware.protocol import (
    ACKNOWLEDGE,
    EMERGENCY_STOP,
    LINE,
    REPORT,
    RUN,
    STATUS,
    InputSettings,
    Ramp,
    Settings,
    for_axes,
    values_of,
)
from firmware.rig import RampDesign, image
from firmware.talk import CYCLES_PER_MS, CYCLES_PER_US, Talk
from simulator.avr import Conversation, build_firmware, converse

STOP_PIN, STOP_INPUT = 14, 0
ROLES = {STOP_INPUT: EMERGENCY_STOP}
PRESSES = 24
FIRST_MS, EVERY_MS, JITTER_MS = 700.0, 90.0, 7.0
GAUGE = Ramp([(8000, 6, 0), (5000, 20, 0)], 3200, [(8000, 6, 0), (5000, 20, 0)])


@dataclass(frozen=True)
class Work:
    """Motors at the limits of what they may do at the same time."""

    ramps: bytes
    kind: int
    body: bytes
    axes: int
    settings: Settings = field(default_factory=Settings)
    is_gauge: bool = False


def runs(count: int, speed: int, settings: Settings | None = None) -> Work:
    """Return runs of so many axes [steps/s]."""
    plan = RampDesign(speed, 40 * speed, 40 * speed)
    body = for_axes(dict.fromkeys(range(count), plan.slew))
    return Work(image([plan] * count), RUN, body, count, settings or Settings())


def line(count: int, speed: int) -> Work:
    """Return a line of so many axes [steps/s]."""
    plan = RampDesign(speed, 40 * speed, 40 * speed)
    steps = values_of({axis: 900_000 - 70_001 * axis for axis in range(count)})
    return Work(image([plan] * count), LINE, bytes([(1 << count) - 1, 0]) + steps, count)


def gauges() -> Work:
    """Return runs of three gauges."""
    return Work(GAUGE.image(3), RUN, for_axes(dict.fromkeys(range(3), 3200)), 3, Settings(outputs=1), is_gauge=True)


WORK = {
    "one axis": runs(1, 150_000),
    "two axes": runs(2, 65_000),
    "four axes": runs(4, 30_000),
    "a line of two": line(2, 117_000),
    "a line of four": line(4, 86_000),
    "pulses of 8 us": runs(4, 10_000, Settings(pulse_width_us=8)),
    "pulses of 12 us": runs(4, 7500, Settings(pulse_width_us=12)),
    "pulses of 100 us": runs(4, 1150, Settings(pulse_width_us=100)),
    "each edge a step": runs(4, 30_000, replace(Settings(), both_edges=15)),
    "gauges": gauges(),
}


@dataclass(frozen=True)
class Stopped:
    """What came of two dozen presses. latest_us: of all, from the edge of the input to the last step [µs]."""

    played: Conversation
    said: list[Exchange]
    latest_us: float


def stopped(name: str, looks: int, folder: Path) -> Stopped:
    """Press at two dozen moments, at speed and with reports. AssertionError when nothing moves before one."""
    work, chance = WORK[name], random.Random(f"{name} {looks}")
    talk = Talk()
    talk.begin(work.ramps, work.settings, InputSettings(looks=looks, roles=ROLES))
    talk.ask(REPORT, bytes([50]))
    presses = []
    for number in range(PRESSES):
        begin = FIRST_MS + EVERY_MS * number + chance.random() * JITTER_MS
        presses.append((STOP_PIN, begin, begin + chance.choice([0.06, 0.5, 3.0]) + 0.004 * looks))
        talk.ask(work.kind, work.body)
        talk.ask(work.kind, work.body, wait_ms=25, quiet_ms=20)
        talk.ask(ACKNOWLEDGE)
    talk.ask(STATUS, b"\0")
    played = converse(build_firmware("INPUTS=yes"), folder, talk.asked, presses)
    steps, said = rises(played, work), exchanges(played.frames)
    acknowledged = [each for each in said if each.kind == ACKNOWLEDGE]
    late_us = []
    for (_, begin_ms, _), each in zip(presses, acknowledged, strict=True):
        pressed = begin_ms * CYCLES_PER_MS
        before = steps[(steps > pressed - 10 * CYCLES_PER_MS) & (steps <= pressed)]
        assert before.size > 0, "nothing moved"
        after = steps[(steps > pressed) & (steps < each.came)]
        late_us.append(float(after.max() - pressed) / CYCLES_PER_US if after.size else 0.0)
    return Stopped(played, said, max(late_us))


def rises(conversation: Conversation, work: Work) -> npt.NDArray[np.int64]:
    """Return when steps are made [cycles]: rising edges, or all where each of them is a step, and of coils all."""
    edges = conversation.edges
    pins = list(range(2, 14)) if work.is_gauge else [2, 3, 4, 12]
    chosen = np.isin(edges["pin"], pins)
    if not (work.is_gauge or work.settings.both_edges):
        chosen &= edges["value"] == 1
    return edges["cycle"][chosen]
