"""The virtual controller gives the answers of the firmware, which runs on this machine: frame for frame.

What depends on the instant is left to the folder conformance.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from fractions import Fraction

import numpy as np
import pytest

from controllers.conftest import Clock
from designs import design
from firmware.controller_host import Driver, missing_compiler
from stepramp.controllers.stepramp.formula_image import encode_formula
from stepramp.controllers.stepramp.frames import FrameSplitter, crc16, encode_frame
from stepramp.controllers.stepramp.messages.body import Request
from stepramp.controllers.stepramp.messages.kinds import NOTICE_KINDS
from stepramp.controllers.stepramp.messages.message import Message
from stepramp.controllers.stepramp.messages.motion import (
    HaltRequest,
    LineRequest,
    MoveByRequest,
    MoveToRequest,
    RunRequest,
    SetPositionRequest,
    StopRequest,
    ZeroRequest,
)
from stepramp.controllers.stepramp.messages.ramps import BeginRequest, DataRequest, EndRequest, TryRequest
from stepramp.controllers.stepramp.messages.reply import unpack_reply
from stepramp.controllers.stepramp.messages.session import HelloRequest
from stepramp.controllers.stepramp.messages.settings import WriteSettingsRequest
from stepramp.controllers.stepramp.messages.status import (
    AxisState,
    MachineState,
    StatusFlag,
    StatusReply,
    StatusRequest,
)
from stepramp.controllers.stepramp.ramp_image import AxisRamp, FormulaRamp, RampImage, SegmentRamp
from stepramp.controllers.stepramp.settings import StepRampSettings
from stepramp.controllers.virtual.controller import VirtualController
from stepramp.ramp.on_chip import on_chip_ramp
from stepramp.ramp.segments import Segment
from tools import require

SESSION = 0xBEEF
GRANTED, OUT_OF_RANGE, TOO_FAST = 0, 6, 12
ALONE = {1: 106, 2: 246, 3: 388, 4: 533}
ON_A_LINE = {1: 106, 2: 133, 3: 160, 4: 181}
BY_FORMULA = 1600
ROUND_S = 1389 / 16e6
"""What a round of the firmware's driver takes [s]."""


class Both:
    """A session with the firmware and with the virtual controller; they must give the same answers."""

    def __init__(self, driver: Driver) -> None:
        self._driver = driver
        self._clock = Clock()
        self._virtual = VirtualController(self._clock)
        self._tag = 0
        driver.ask("begin")
        # In version 3 a build with inputs says more than one without.
        self._exchange(HelloRequest(2))

    def ask(self, request: Request) -> tuple[int, int]:
        """Return the status and its detail, 0 when the request was granted."""
        by_firmware, by_virtual = self._exchange(request)
        assert by_firmware == by_virtual, request
        return by_firmware.body[0], int.from_bytes(by_firmware.body[1:3], "little") if by_firmware.body[0] else 0

    def ok(self, *requests: Request) -> None:
        for request in requests:
            assert self.ask(request) == (GRANTED, 0), request

    def deliver(self, image: bytes) -> tuple[int, int]:
        """Return what is said of an image."""
        parts = [DataRequest(offset, image[offset : offset + 48]) for offset in range(0, len(image), 48)]
        self.ok(BeginRequest(len(image), crc16(image)), *parts)
        return self.ask(EndRequest())

    def use(self, *ramps: AxisRamp, fast: bool = True) -> None:
        assert self.deliver(RampImage(fast, ramps).encode()) == (GRANTED, 0)
        self.ok(TryRequest())

    def settings(self, **settings: object) -> None:
        self.ok(WriteSettingsRequest(StepRampSettings(**settings).pack()))

    def tried(self, request: Request, axes: int) -> tuple[int, int]:
        """Return what is said to a motion, and end it."""
        said = self.ask(request)
        self.ok(HaltRequest(), SetPositionRequest((1 << axes) - 1, (0,) * axes))
        return said

    def pass_time(self, for_s: float) -> None:
        self._driver.ask("poll", round(for_s / ROUND_S))
        self._clock.now_s += for_s

    def statuses(self, axis: int = 0) -> list[StatusReply]:
        """Return what both say of an axis."""
        replies = [unpack_reply(StatusReply, message.body) for message in self._exchange(StatusRequest(axis))]
        assert all(isinstance(reply, StatusReply) for reply in replies)
        return replies

    def _exchange(self, request: Request) -> tuple[Message, Message]:
        self._tag = (self._tag + 1) % 256
        frame = encode_frame(Message(request.KIND, SESSION, self._tag, request.pack()).pack())
        return _only_reply(self._driver.send(frame)), _only_reply(self._virtual.exchange(frame))


def _only_reply(said: bytes) -> Message:
    messages = [Message.unpack(frame) for frame in FrameSplitter().feed(said)]
    (reply,) = (message for message in messages if message is not None and message.kind not in NOTICE_KINDS)
    return reply


@pytest.fixture
def both() -> Iterator[Both]:
    require(*missing_compiler())
    with Driver() as driver:
        yield Both(driver)


# ---- ramp images ----


@pytest.mark.parametrize(
    "number",
    [
        bytes.fromhex(number)
        for number in (
            "d807",
            "d88700",
            "d887808000",
            "d88780808000",
            "ffffffff07",
            "8080808008",
            "ffffffff0f",
            "8080808010",
        )
    ],
)
@pytest.mark.parametrize("place", [0, 1, 2])
def test_numbers_of_a_segment(both: Both, place: int, number: bytes) -> None:
    """As short as can be or not, up to 2³¹ and beyond."""
    segment = [b"\x01", b"\x90\x4e", b"\x00"]
    segment[place] = number
    lists = b"".join(segment)
    body = b"\x00\x01\x00\xd0\x07\x00\x00" + bytes([len(lists), 0]) + lists
    status, _ = both.deliver(b"\x02\x00\x01\x01\x00\x00" + bytes([len(body), 0]) + body)
    assert (status == GRANTED) == (len(number) <= 5 and number[0] == 0xD8)


@pytest.mark.parametrize("seed", range(4))
def test_damaged_images(both: Both, seed: int) -> None:
    """Of ramps by segments: constants of formulas that contradict each other are the client's affair."""
    random = np.random.default_rng(seed)
    falling = (Segment(5000, 3, -100), Segment(4700, 200, -20))
    whole = RampImage(seed % 2 == 1, (segments(500), SegmentRamp(falling, 700, falling[:1]))).encode()
    for _ in range(60):
        damaged = bytearray(whole)
        for place in random.integers(0, len(damaged), random.integers(1, 4)):
            damaged[place] ^= 1 << random.integers(8)
        both.deliver(bytes(damaged))


# ---- how fast ----


def segments(slew: int) -> SegmentRamp:
    return SegmentRamp((Segment(40_000, 20, -100),), slew, (Segment(40_000, 20, -100),))


def formula() -> FormulaRamp:
    """Return a ramp by formula that comes to the shortest interval: 1600 fast ticks, 10,000 steps/s."""
    quick = design(
        method__name="newton",
        method__arithmetic="fixed",
        timer__frequency_hz=16_000_000,
        ramp__slew_speed_steps_per_s=10_000,
        ramp__acceleration_steps_per_s2=100_000,
    )
    return FormulaRamp(encode_formula(on_chip_ramp(quick)))


def hand_share(intervals: Sequence[int], computed: Sequence[bool], width_us: int) -> Fraction:
    """Return what the rule says that axes take, from their intervals [fast ticks]."""
    own, pulse = Fraction(ALONE[len(intervals)], len(intervals)), 32 * width_us
    return sum(
        ((BY_FORMULA if by_formula else own) + pulse) / Fraction(interval)
        for interval, by_formula in zip(intervals, computed, strict=True)
    )


def surely_too_much(axes: int) -> Fraction:
    """Return what is refused in any case: each share is counted in whole 4096ths, rounded down."""
    return 1 + Fraction(axes, 4096)


WIDTHS_US = (0, 1, 7, 50, 99, 100)


@pytest.mark.parametrize("width_us", WIDTHS_US)
@pytest.mark.parametrize("axes", [1, 2, 3, 4])
@pytest.mark.parametrize("fast", [True, False])
def test_runs_just_below_and_just_above_the_limit(both: Both, axes: int, width_us: int, fast: bool) -> None:
    """The rule by hand: n axes alike need limit[n] + n · 32 · width fast ticks each."""
    ticks = 1 if fast else 8
    both.use(*(segments(106 if fast else 14),) * axes, fast=fast)
    both.settings(pulse_width_us=width_us)
    shortest = -(-(ALONE[axes] + axes * 32 * width_us) // ticks)
    said = {
        interval: both.tried(RunRequest((1 << axes) - 1, (interval,) * axes), axes)
        for interval in range(shortest - 4, shortest + 3)
        if interval >= (106 if fast else 14)
    }
    assert all(said[interval] == (GRANTED, 0) for interval in range(shortest, shortest + 3))
    for interval, (status, _) in said.items():
        share = hand_share((interval * ticks,) * axes, (False,) * axes, width_us)
        assert share < surely_too_much(axes) or status == TOO_FAST
    far = both.tried(RunRequest((1 << axes) - 1, (106 if fast else 14,) * axes), axes)
    assert far[0] == (TOO_FAST if width_us or axes > 1 else GRANTED)


@pytest.mark.parametrize("width_us", WIDTHS_US)
@pytest.mark.parametrize("axes", [1, 2, 3, 4])
def test_lines_just_below_and_just_above_the_limit(both: Both, axes: int, width_us: int) -> None:
    shortest = ON_A_LINE[axes] + 32 * width_us
    slews = [max(106, shortest + each) for each in (-2, -1, 0, 1)]
    both.use(*map(segments, slews))
    both.settings(pulse_width_us=width_us)
    steps = tuple(900 if axis < axes else 0 for axis in range(4))
    for ramp_axis, slew in enumerate(slews):
        status, _ = both.tried(LineRequest(15, ramp_axis, steps), 4)
        assert status == (GRANTED if slew >= shortest else TOO_FAST)
    assert both.tried(LineRequest(15, 0, (0,) * 4), 4) == (GRANTED, 0)


@pytest.mark.parametrize("width_us", WIDTHS_US)
def test_a_formula_just_below_and_just_above_the_limit(both: Both, width_us: int) -> None:
    both.use(formula(), segments(106))
    both.settings(pulse_width_us=width_us)
    shortest = BY_FORMULA + 32 * width_us
    assert both.tried(RunRequest(1, (shortest,)), 2) == (GRANTED, 0)
    if width_us:
        assert both.tried(RunRequest(1, (math.floor(shortest * 0.999),)), 2)[0] == TOO_FAST
        assert both.tried(MoveToRequest(1, (900,)), 2)[0] == TOO_FAST
    # Next to it, at twice that interval, another one has half of the processor.
    other = 246 + 2 * 32 * width_us
    assert both.tried(RunRequest(3, (2 * shortest, other + 2)), 2) == (GRANTED, 0)
    assert both.tried(RunRequest(3, (2 * shortest, math.floor(other * 0.99))), 2)[0] == TOO_FAST


@pytest.mark.parametrize("seed", range(8))
def test_any_axes_near_the_limit(both: Both, seed: int) -> None:
    random = np.random.default_rng(seed)
    for _ in range(12):
        axes, width_us = int(random.integers(1, 5)), int(random.choice([0, 1, 3, 20, 100]))
        computed = [bool(each) for each in random.random(axes) < 0.3]
        both.use(*(formula() if each else segments(106) for each in computed))
        both.settings(pulse_width_us=width_us)
        parts = random.dirichlet(np.ones(axes)) + 0.001
        for near in random.uniform(0.97, 1.03, 4):
            intervals = [int(1000 / part) for part in parts]
            share = hand_share(intervals, computed, width_us)
            intervals = [
                min(2**20, max(1600 if by_formula else 106, math.ceil(interval * share * Fraction(near))))
                for interval, by_formula in zip(intervals, computed, strict=True)
            ]
            share = hand_share(intervals, computed, width_us)
            status, percent = both.tried(RunRequest((1 << axes) - 1, tuple(intervals)), axes)
            assert share > 1 or status == GRANTED
            assert status == GRANTED or 100 <= percent <= 100 * share
            assert status == TOO_FAST or share < surely_too_much(axes) or max(intervals) > 65_535


def test_axes_that_move_already_take_their_share(both: Both) -> None:
    both.use(*(segments(600),) * 4)
    both.settings(pulse_width_us=3, enable_lead_ms=1000)
    # Two need 246 + 2 · 96 = 438 fast ticks, three 388 + 3 · 96 = 676.
    both.ok(RunRequest(3, (600, 600)))
    assert both.ask(RunRequest(4, (600,))) == (TOO_FAST, 676 * 100 // 600)
    # Two of 600 ticks have 2 · 676 / (3 · 600) of it.
    assert both.ask(RunRequest(4, (895,)))[0] == TOO_FAST
    assert both.ask(MoveToRequest(4, (900,)))[0] == TOO_FAST
    both.ok(RunRequest(4, (910,)))


@pytest.mark.parametrize("width_us", [0, 100])
def test_gauges_have_a_limit_of_their_own(both: Both, width_us: int) -> None:
    both.use(*map(segments, (3200, 3199, 3200, 3200)))
    both.settings(outputs="gauges", pulse_width_us=width_us)
    assert both.tried(MoveToRequest(0b0101, (900, 900)), 4) == (GRANTED, 0)
    both.tried(MoveToRequest(0b0111, (900,) * 3), 4)
    both.use(*map(segments, (3200, 3190, 3200, 3200)))
    assert both.tried(MoveToRequest(0b0111, (900,) * 3), 4) == (TOO_FAST, 100)


@pytest.mark.parametrize(
    "request_",
    [
        MoveByRequest(8, (900,)),
        MoveToRequest(0b1001, (900, 900)),
        RunRequest(8, (5000,)),
        RunRequest(0b1001, (0, 0)),
        ZeroRequest(8, 900),
        LineRequest(0b1001, 0, (900, 900)),
        LineRequest(3, 1, (900, 900)),
    ],
)
def test_what_gauges_can_not_do(both: Both, request_: Request) -> None:
    both.use(*(segments(5000),) * 4)
    both.settings(outputs="gauges")
    assert both.tried(request_, 4)[0] == OUT_OF_RANGE


# ---- before the motors hold ----


WAITS = (
    MoveByRequest(1, (-5000,)),
    RunRequest(1, (5000,)),
    LineRequest(3, 0, (4000, -2000)),
)


@pytest.mark.parametrize("waits", WAITS)
def test_motors_are_given_time_to_hold(both: Both, waits: Request) -> None:
    both.use(segments(5000), segments(5000))
    both.settings(enable_lead_ms=300)
    both.ask(waits)
    both.pass_time(0.2)
    for status in both.statuses():
        assert (status.state, status.axis_state) == (MachineState.MOVING, AxisState.MOVING)
        assert (status.position_steps, status.steps_made) == (0, 0)
    both.pass_time(0.3)
    assert all(status.steps_made > 0 for status in both.statuses())
    both.ok(HaltRequest(), SetPositionRequest(3, (0, 0)))
    both.ask(waits)
    both.pass_time(0.1)
    assert all(status.steps_made > 0 for status in both.statuses())


@pytest.mark.parametrize(
    ("waits", "ends"),
    [
        *itertools.product(WAITS, [StopRequest(), StopRequest(b"\1"), HaltRequest()]),
        *((waits, RunRequest(1, (0,))) for waits in WAITS[:2]),
    ],
)
@pytest.mark.parametrize("after_s", [0.0, 0.1])
def test_what_is_stopped_before_it_sets_out_stays_where_it_is(
    both: Both, waits: Request, ends: Request, after_s: float
) -> None:
    both.use(segments(5000), segments(5000))
    both.settings(enable_lead_ms=300)
    both.ok(SetPositionRequest(3, (70, -70)))
    both.ask(waits)
    both.pass_time(after_s)
    both.ok(ends)
    for _ in range(2):
        for axis, position in ((0, 70), (1, -70)):
            for status in both.statuses(axis):
                assert (status.axis_state, status.steps_made) == (AxisState.IDLE, 0)
                assert (status.position_steps, status.target_steps) == (position, position)
        both.pass_time(0.6)


@pytest.mark.parametrize(
    "request_",
    [RunRequest(1, (0,)), MoveToRequest(1, (0,)), MoveByRequest(1, (0,)), LineRequest(1, 0, (0,)), ZeroRequest(1, 0)],
)
def test_what_moves_nothing_switches_no_motor_on(both: Both, request_: Request) -> None:
    both.use(segments(5000))
    both.ask(request_)
    both.pass_time(0.01)
    assert not any(status.flags & StatusFlag.ENABLED for status in both.statuses())
    both.ask(MoveByRequest(1, (5000,)))
    both.pass_time(0.01)
    assert all(status.flags & StatusFlag.ENABLED for status in both.statuses())


def test_a_target_that_changes_before_it_sets_out(both: Both) -> None:
    both.use(segments(5000))
    both.settings(enable_lead_ms=300)
    both.ask(MoveToRequest(1, (-5000,)))
    both.ask(MoveToRequest(1, (30,)))
    both.pass_time(2.0)
    for status in both.statuses():
        assert (status.axis_state, status.position_steps, status.target_steps) == (AxisState.IDLE, 30, 30)
