"""Inputs on the simulated chip: how soon an emergency stop is obeyed at all limits, and to which step axes are homed.

The firmware is the build with inputs. Each conversation plays the same way to the cycle.
"""

import random
import struct
from collections.abc import Callable
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest

from firmware.checker import CYCLES_PER_S
from firmware.emergency_stops import (
    EVERY_MS,
    FIRST_MS,
    GAUGE,
    JITTER_MS,
    PRESSES,
    ROLES,
    STOP_PIN,
    WORK,
    runs,
    stopped,
)
from firmware.flight.exchange import exchanges
from firmware.protocol import (
    ACKNOWLEDGE,
    AT_LIMIT,
    BY_EMERGENCY_STOP,
    COMMIT,
    DRIVER_FAULT,
    HALT,
    HOME,
    LINE,
    LOW_LIMIT,
    MOVE_BY,
    MOVE_TO,
    OK,
    REPORT,
    ROLL_BACK,
    RUN,
    SET_POSITION,
    STATUS,
    STOPPED,
    TRACE,
    WRITE_LIMITS,
    WRITE_SETTINGS,
    ZERO,
    InputSettings,
    InputsStatus,
    Settings,
    Status,
    for_axes,
    values_of,
)
from firmware.rig import RampDesign, image
from firmware.talk import Talk
from simulator.avr import build_firmware, build_harness, converse, missing_tools
from tools import require

MOST_US = 100
"""From the edge of the emergency stop to the last step."""
LOW_PIN, LOW_INPUT = 9, 6
OUTPUT_STATUS_BYTES = 26
LEAST_STACK_BYTES = 48


@pytest.fixture(scope="module", autouse=True)
def tools() -> None:
    require(*missing_tools())
    build_harness()


@pytest.mark.parametrize("name", WORK)
@pytest.mark.parametrize("looks", [4, 10])
def test_an_emergency_stop_halts_all_within_100_us(
    tmp_path: Path, record_property: Callable[..., None], name: str, looks: int
) -> None:
    """At speed, at two dozen moments, with reports: no step comes later, nor any before it was acknowledged."""
    stop = stopped(name, looks, tmp_path)
    played, said = stop.played, stop.said
    assert [each.status for each in said if each.kind == ACKNOWLEDGE] == [OK] * PRESSES
    refused = [each for each in said if each.kind == WORK[name].kind and each.status != OK]
    assert [each.status for each in refused] == [STOPPED] * PRESSES
    record_property("latest_us", stop.latest_us)
    assert stop.latest_us <= MOST_US
    assert played.statistics["untouched_stack_bytes"] >= LEAST_STACK_BYTES
    (last,) = [each for each in exchanges(played.frames) if each.kind == STATUS]
    status, inputs = (
        Status.unpack(last.reply[:OUTPUT_STATUS_BYTES]),
        InputsStatus.unpack(last.reply[OUTPUT_STATUS_BYTES:]),
    )
    assert (status.state, inputs.stopped_by) == (0, 0)


def test_positions_are_those_of_the_pins_after_emergency_stops(tmp_path: Path) -> None:
    work, chance = WORK["four axes"], random.Random(7)
    talk = Talk()
    talk.begin(work.ramps, inputs=InputSettings(roles=ROLES))
    presses = []
    for number in range(PRESSES):
        begin = FIRST_MS + EVERY_MS * number + chance.random() * JITTER_MS
        presses.append((STOP_PIN, begin, begin + 1))
        talk.ask(RUN, work.body)
        talk.ask(STATUS, bytes([number % 4]), wait_ms=25, quiet_ms=6)
        talk.ask(ACKNOWLEDGE)
    played = converse(build_firmware("INPUTS=yes"), tmp_path, talk.asked, presses)
    told = [each for each in exchanges(played.frames) if each.kind == STATUS]
    for number, each in enumerate(told):
        edges = played.edges
        pin = (2, 3, 4, 12)[number % 4]
        made = np.sum((edges["pin"] == pin) & (edges["value"] == 1) & (edges["cycle"] < each.came))
        status = Status.unpack(each.reply[:OUTPUT_STATUS_BYTES])
        assert status.position == made
        assert InputsStatus.unpack(each.reply[OUTPUT_STATUS_BYTES:]).stopped_by == BY_EMERGENCY_STOP


@pytest.mark.parametrize("slow_steps_per_s", [100, 500])
def test_homing_comes_to_the_same_step_each_time(tmp_path: Path, slow_steps_per_s: int) -> None:
    plan = RampDesign(8000, 40_000, 40_000)
    talk = Talk()
    talk.begin(image([plan]), inputs=InputSettings(roles={LOW_INPUT: LOW_LIMIT}))
    talk.ask(REPORT, bytes([50]))
    homings = 6
    body = struct.pack("<BIH", 1, CYCLES_PER_S // slow_steps_per_s, 30) + values_of({0: -8 * plan.slew})
    for number in range(homings):
        talk.ask(MOVE_BY, for_axes({0: 700 + 111 * number}))
        talk.ask(HOME, body, wait_ms=400)
        for _ in range(24):
            talk.ask(STATUS, b"\0", wait_ms=150)
    played = converse(build_firmware("INPUTS=yes"), tmp_path, talk.asked, switches=["9:0<-250"])
    assert played.statistics["untouched_stack_bytes"] >= LEAST_STACK_BYTES
    edges = played.edges
    ends = [each for each in exchanges(played.frames) if each.kind == STATUS][23::24]
    homes = [each for each in exchanges(played.frames) if each.kind == HOME]
    assert [each.status for each in homes] == [OK] * homings
    places = []
    for each in ends:
        inputs = InputsStatus.unpack(each.reply[OUTPUT_STATUS_BYTES:])
        assert (inputs.homing, inputs.known & 1) == (0, 1)
        until = edges[edges["cycle"] < each.came]
        places.append(position(until) - Status.unpack(each.reply[:OUTPUT_STATUS_BYTES]).position)
    # The switch is inactive at -249, active at -250.
    assert len(places) == homings
    assert set(places) <= {-250, -249, -248}
    assert max(places) - min(places) <= 1


def test_four_axes_are_homed_at_once(tmp_path: Path) -> None:
    """With wide pulses, reports and a trace: what takes most of the stack."""
    limits = {1: LOW_LIMIT + 3, LOW_INPUT: LOW_LIMIT, LOW_INPUT + 1: LOW_LIMIT + 1, LOW_INPUT + 2: LOW_LIMIT + 2}
    switches = ["9:0<-250", "10:1<-300", "11:2<-10", "15:3<-777"]
    plan, axes = RampDesign(2000, 20_000, 20_000), dict.fromkeys(range(4), 0)
    talk = Talk()
    talk.begin(image([plan] * 4), Settings(pulse_width_us=40), InputSettings(roles=limits))
    talk.ask(REPORT, bytes([50]))
    talk.ask(TRACE, b"\0\1\0")
    intervals = values_of({axis: -(plan.slew + 1000 * axis) for axis in axes})
    talk.ask(HOME, struct.pack("<BIH", 15, CYCLES_PER_S // 400, 30) + intervals, wait_ms=400)
    for _ in range(24):
        talk.ask(STATUS, b"\0", wait_ms=150)
    played = converse(build_firmware("INPUTS=yes"), tmp_path, talk.asked, switches=switches)
    assert played.statistics["untouched_stack_bytes"] >= LEAST_STACK_BYTES
    last = [each for each in exchanges(played.frames) if each.kind == STATUS][-1]
    inputs = InputsStatus.unpack(last.reply[OUTPUT_STATUS_BYTES:])
    assert (inputs.homing, inputs.known) == (0, 15)


@pytest.mark.parametrize("outputs", [0, 1], ids=["axes", "gauges"])
def test_refusals_storing_and_rolling_back_leave_the_stack_its_margin(tmp_path: Path, outputs: int) -> None:
    """What calls deepest: motions that are refused by a stop or at a switch, in flight too, lines, and loading."""
    ramps = GAUGE.image(3) if outputs else image([RampDesign(9000, 90_000, 90_000)] * 4)
    axes, roles = range(ramps[2]), ROLES | {1: DRIVER_FAULT, 2: LOW_LIMIT + 2}
    far, near = dict.fromkeys(axes, 3000), dict.fromkeys(axes, -3000)
    talk = Talk()
    talk.begin(ramps, Settings(outputs=outputs), InputSettings(roles=roles))
    talk.ask(REPORT, bytes([50]))
    talk.ask(TRACE, b"\0\1\0")
    talk.ask(COMMIT)
    for _ in range(8):
        talk.ask(STATUS, b"\0", wait_ms=350)
    talk.ask(WRITE_SETTINGS, Settings(outputs=outputs).packed() + InputSettings(looks=5, roles=roles).packed())
    talk.ask(ROLL_BACK)
    deep = [
        (MOVE_TO, for_axes(near)),
        (ZERO, struct.pack("<BH", 2, 100)),
        (HOME, struct.pack("<BIH", 4, 20_000, 30) + values_of({2: -9000})),
        (RUN, for_axes(dict.fromkeys(axes, -9000))),
        (LINE, bytes([3, 0]) + values_of({0: 30, 1: 40})),
    ]
    begin_ms, presses = 4300.0, []
    for number in range(12):
        at_ms = begin_ms + 260 * number
        pin = 16 if number % 3 == 0 else STOP_PIN + number % 2
        presses.append((pin, at_ms + 40, at_ms + 200 - 7 * number))
        talk.ask(MOVE_BY, for_axes({0: 3000}))
        for axis in (1, 2):
            talk.ask(MOVE_BY, for_axes({axis: 3000}), wait_ms=5)
            talk.ask(RUN, for_axes({axis: 0}))  # before its first step
        talk.ask(MOVE_BY, for_axes(far), wait_ms=9)
        for kind, body in deep * 3:
            talk.ask(kind, body, wait_ms=1.3)
        talk.ask(HALT)
        talk.ask(ACKNOWLEDGE, wait_ms=60)
        talk.ask(LINE, bytes([3, 0]) + values_of({0: 30, 1: 40}), wait_ms=20)
    played = converse(build_firmware("INPUTS=yes"), tmp_path, talk.asked, presses)
    said = {(each.kind, each.status) for each in exchanges(played.frames)}
    assert {(ROLL_BACK, OK), (MOVE_TO, STOPPED), (ZERO, STOPPED), (HOME, STOPPED), (MOVE_TO, AT_LIMIT)} <= said
    assert played.statistics["untouched_stack_bytes"] >= LEAST_STACK_BYTES


def position(edges: npt.NDArray[np.void]) -> int:
    """Return where axis 0 is by its pins."""
    at, is_forward = 0, False
    for edge in edges[np.isin(edges["pin"], [2, 5])]:
        if edge["pin"] == 5:
            is_forward = bool(edge["value"])
        elif edge["value"]:
            at += 1 if is_forward else -1
    return at


def test_runs_of_all_axes_end_at_their_soft_limits(tmp_path: Path) -> None:
    """Four at the limits of what may move at the same time."""
    work, talk = runs(4, 30_000), Talk()
    talk.begin(work.ramps, inputs=InputSettings(roles=ROLES))
    highest = [20_000, 20_001, 17_345, 15_000]
    for axis, most in enumerate(highest):
        talk.ask(WRITE_LIMITS, struct.pack("<Bii", axis, -5, most))
    talk.ask(SET_POSITION, for_axes(dict.fromkeys(range(4), 0)))
    talk.ask(REPORT, bytes([50]))
    talk.ask(RUN, work.body)
    for axis in (0, 0, 0, 0, 1, 2, 3):
        talk.ask(STATUS, bytes([axis]), wait_ms=250)
    talk.ask(RUN, work.body)
    played = converse(build_firmware("INPUTS=yes"), tmp_path, talk.asked)
    told = exchanges(played.frames)
    ends = [Status.unpack(each.reply[:OUTPUT_STATUS_BYTES]) for each in told if each.kind == STATUS][3:]
    assert [end.position for end in ends] == highest
    assert [end.starved for end in ends] == [0] * 4
    edges = played.edges
    made = [np.sum((edges["pin"] == pin) & (edges["value"] == 1)) for pin in (2, 3, 4, 12)]
    assert made == highest
    assert [each.status for each in told if each.kind == RUN] == [OK, AT_LIMIT]
