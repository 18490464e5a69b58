"""The controller through frames, with hardware made of variables."""

import random
import re
import struct
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import pytest

from firmware import protocol as p
from firmware.controller_host import Driver, missing_compiler
from firmware.protocol import (
    Hello,
    Ramp,
    Report,
    Settings,
    Status,
    Trace,
    decode_frame,
    encode_frame,
    for_axes,
    is_whole,
)
from tools import require

RAMP = Ramp([(20_000, 1, 0), (14_142, 2, -2595), (10_000, 300, -20)], 2000, [(20_000, 2, -5858), (11_547, 40, -200)])
OTHER = Ramp([(5000, 60, -30)], 3000, [(5000, 60, -30)])
OLDER = Ramp([(9000, 7, -11), (7000, 9, -300)], 1234, [(8000, 5, -7)])
TWO_AXES = p.image_of([RAMP.packed(), OTHER.packed()], [0, 1])
FOUR_AXES = Ramp([(2000, 50, -20)], 1000, []).image(4)
SESSION = 0xBEEF
FOR_AXES = {p.MOVE_BY: 5, p.MOVE_TO: 5, p.RUN: 5, p.LINE: 6, p.SET_POSITION: 5, p.ZERO: 3}
"""Lengths of the requests for axes that name one axis."""
NOTICES = (p.REPORT_NOTICE, p.TRACE_NOTICE)
CHANGES = {p.BEGIN: 4, p.DATA: 3, p.END: 0, p.COMMIT: 0, p.TRY: 0, p.ROLL_BACK: 0, p.WRITE_SETTINGS: 12}
LENGTHS = {p.HELLO: 1, p.STATUS: 1, p.REPORT: 1, p.TRACE: 3, p.READ: 4, p.READ_SETTINGS: 0} | CHANGES | FOR_AXES
BYTE_US = 1389 / 16
"""What a round of the driver takes."""
LONGEST_WAIT = 4
"""Rounds until a frame that is going out has been cut, and the next one begins."""
WHOLE_COMMIT = 50_000
"""Rounds that are enough for the largest commit."""


@dataclass(frozen=True)
class Limits:
    """What limits.h says."""

    shortest: tuple[int, ...]
    shortest_line: tuple[int, ...]
    shortest_formula: int


def read_limits() -> Limits:
    text = (Path(__file__).parent.parent.parent / "firmware" / "src" / "limits.h").read_text()
    said = {name: int(value) for name, value in re.findall(r"#define (\w+) (\d+)u\n", text)}
    return Limits(
        tuple(said[f"SHORTEST_INTERVAL_{name}_TICKS"] for name in ("1_AXIS", "2_AXES", "3_AXES", "4_AXES")),
        tuple(said[f"SHORTEST_INTERVAL_LINE_{axes}_TICKS"] for axes in (2, 3, 4)),
        said["SHORTEST_FORMULA_INTERVAL_TICKS"],
    )


LIMITS = read_limits()


class Controller:
    """Frames to a controller on this machine."""

    def __init__(self, driver: Driver) -> None:
        self.driver = driver
        self.tag = 0
        self.notices: list[bytes] = []
        self.half_frame = b""

    def frame(self, kind: int, body: bytes = b"", *, session: int = SESSION, tag: int | None = None) -> bytes:
        """Return a request as a frame; one with a new tag unless it is given."""
        if tag is None:
            self.tag = tag = (self.tag + 1) & 0xFF
        return encode_frame(struct.pack("<BHB", kind, session, tag) + body)

    def replies_to(self, data: bytes) -> list[bytes]:
        """Send bytes; return the messages of the replies. Notices are kept."""
        messages = messages_of(self.driver.send(data))
        self.notices += [message for message in messages if message[0] in NOTICES]
        return [message for message in messages if message[0] not in NOTICES]

    def send(self, kind: int, body: bytes = b"", *, session: int = SESSION, tag: int | None = None) -> bytes:
        """Send a request; return the reply's status and body."""
        frame = self.frame(kind, body, session=session, tag=tag)
        (reply,) = self.replies_to(frame)
        assert reply[:4] == struct.pack("<BHB", kind | 0x80, session, self.tag if tag is None else tag)
        return reply[4:]

    def ok(self, kind: int, body: bytes = b"") -> bytes:
        reply = self.send(kind, body)
        assert reply[0] == p.OK, reply.hex()
        return reply[1:]

    def refused(self, kind: int, body: bytes = b"", **options: int) -> tuple[int, int]:
        """Return status and detail."""
        return struct.unpack("<BH", self.send(kind, body, **options))

    def deliver(self, image: bytes) -> None:
        self.ok(p.BEGIN, struct.pack("<HH", len(image), p.crc16(image)))
        for part in p.image_parts(image):
            reply = self.ok(p.DATA, part)
            assert struct.unpack("<H", reply)[0] == struct.unpack("<H", part[:2])[0] + len(part) - 2

    def check(self, image: bytes) -> None:
        self.deliver(image)
        assert self.ok(p.END) == image[2:4]

    def push(self, ramp: Ramp | bytes) -> None:
        self.check(ramp.image() if isinstance(ramp, Ramp) else ramp)
        self.ok(p.COMMIT)
        self.run(WHOLE_COMMIT)

    def run(self, rounds: int) -> None:
        self.driver.ask("poll", rounds)

    def hello(self) -> Hello:
        return Hello.unpack(self.ok(p.HELLO, b"\2"))

    def status(self, axis: int = 0) -> Status:
        return Status.unpack(self.ok(p.STATUS, bytes([axis])))

    def read(self, source: int = p.STORED) -> bytes:
        data = b""
        while part := self.ok(p.READ, struct.pack("<BHB", source, len(data), 48))[2:]:
            data += part
        return data

    def settings(self) -> bytes:
        return self.ok(p.READ_SETTINGS)

    def steps(self) -> list[int]:
        """Return where the pins say that the motors are."""
        return [int(word) for word in self.driver.ask("steps").split()]

    def run_until_idle(self) -> Status:
        for _ in range(1000):
            self.run(2000)
            status = self.status()
            if status.state == p.IDLE:
                return status
        raise AssertionError("It moves on and on.")


def messages_of(sent: bytes) -> list[bytes]:
    assert sent == b"" or sent.endswith(b"\0")
    return [decode_frame(frame + b"\0") for frame in sent.split(b"\0")[:-1]]


def started(driver: Driver) -> Controller:
    """Switch the controller on and begin a session."""
    driver.ask("begin")
    controller = Controller(driver)
    controller.hello()
    return controller


@pytest.fixture
def driver() -> Iterator[Driver]:
    require(*missing_compiler())
    with Driver() as running:
        yield running


@pytest.fixture
def controller(driver: Driver) -> Controller:
    return started(driver)


# ---- sessions, kinds, lengths, repeats


def test_hello_tells_the_limits(controller: Controller) -> None:
    assert controller.hello() == Hello(
        version=2,
        firmware=(0, 2, 0),
        fast_clock_hz=16_000_000,
        slow_clock_hz=2_000_000,
        shortest=LIMITS.shortest,
        shortest_line=LIMITS.shortest_line,
        longest=2**28 - 1,
        shortest_formula=LIMITS.shortest_formula,
        largest_image=440,
        most_segments=250,
        axes=4,
        reset_cause=1,
        sequence=0,
        crc=0,
        in_use=p.NO_RAMP_IN_USE,
    )
    assert len(controller.send(p.HELLO, b"\2")) == 45


def test_hello_refuses_other_versions_and_no_session(controller: Controller) -> None:
    assert controller.refused(p.HELLO, b"\1") == (p.VERSION, 2)
    assert controller.refused(p.HELLO, b"\3") == (p.VERSION, 2)
    assert controller.refused(p.HELLO, b"\2", session=0) == (p.OUT_OF_RANGE, 0)
    assert controller.status().state == p.IDLE


def test_requests_of_another_session_are_stale(controller: Controller) -> None:
    assert controller.refused(p.STATUS, b"\0", session=SESSION + 1) == (p.STALE, 0)
    assert controller.refused(p.MOVE_BY, for_axes({0: 5}), session=0) == (p.STALE, 0)
    controller.send(p.HELLO, b"\2", session=7)
    assert controller.refused(p.STATUS, b"\0") == (p.STALE, 0)
    assert controller.send(p.STATUS, b"\0", session=7)[0] == p.OK


@pytest.mark.parametrize("session", [0, 1, SESSION])
def test_before_a_hello_all_is_stale(driver: Driver, session: int) -> None:
    driver.ask("begin")
    for kind, length in LENGTHS.items():
        if kind != p.HELLO:
            assert Controller(driver).refused(kind, bytes(length), session=session) == (p.STALE, 0)


def test_unknown_kinds(controller: Controller) -> None:
    known = {*LENGTHS, p.STOP, p.HALT}
    looks_like_a_notice = {0x40, 0x41}
    for kind in set(range(128)) - known - looks_like_a_notice:
        assert controller.refused(kind) == (p.UNKNOWN_KIND, kind)


@pytest.mark.parametrize("kind", LENGTHS)
def test_bad_lengths(controller: Controller, kind: int) -> None:
    """Also that of a mask with one bit and no value, or with eight bits, of which some have no axis."""
    good = range(3, 51) if kind == p.DATA else [LENGTHS[kind]]
    for length in set(range(53)) - set(good):
        body = (b"\1" + bytes(52))[:length] if kind in FOR_AXES else bytes(length)
        assert controller.refused(kind, body) == (p.BAD_LENGTH, length)
    if kind in FOR_AXES and kind != p.ZERO:
        extra = int(kind == p.LINE)
        assert controller.refused(kind, b"\xff" + bytes(31 + extra)) == (p.BAD_LENGTH, 32 + extra)
        assert controller.refused(kind, b"\xff" + bytes(32 + extra)) == (p.NO_RAMP, 0)


def test_stop_and_halt_take_a_mask_or_nothing(controller: Controller) -> None:
    controller.push(TWO_AXES)
    for kind in (p.STOP, p.HALT):
        assert controller.refused(kind, bytes(2)) == (p.BAD_LENGTH, 2)
        for mask in (0, 4, 7, 255):
            assert controller.refused(kind, bytes([mask])) == (p.OUT_OF_RANGE, mask)
        for mask in (1, 2, 3):
            controller.ok(kind, bytes([mask]))
        controller.ok(kind)


def test_a_repeat_gets_the_same_reply_and_does_nothing(controller: Controller) -> None:
    controller.push(RAMP)
    first = controller.send(p.MOVE_BY, for_axes({0: 7}), tag=77)
    assert first == b"\0" + struct.pack("<i", 7)
    assert controller.send(p.MOVE_BY, for_axes({0: 7}), tag=77) == first
    assert controller.status().target == 7
    assert controller.send(p.MOVE_BY, for_axes({0: 7}), tag=78) == b"\0" + struct.pack("<i", 14)


def test_a_refusal_is_repeated_too(controller: Controller) -> None:
    assert controller.refused(p.MOVE_BY, for_axes({0: 7}), tag=5) == (p.NO_RAMP, 0)
    controller.push(RAMP)
    assert controller.refused(p.MOVE_BY, for_axes({0: 7}), tag=6, session=1) == (p.STALE, 0)
    assert controller.refused(p.MOVE_BY, for_axes({0: 7}), tag=6, session=1) == (p.STALE, 0)


def test_a_second_hello_with_the_same_tag_is_no_repeat(controller: Controller) -> None:
    assert controller.send(p.HELLO, b"\2", tag=0)[0] == p.OK
    assert controller.refused(p.HELLO, b"\1", tag=0) == (p.VERSION, 2)


# ---- the line


def test_a_frame_that_comes_twice_is_answered_twice_and_done_once(controller: Controller) -> None:
    controller.push(RAMP)
    frame = controller.frame(p.MOVE_BY, for_axes({0: 7}))
    first, second = controller.replies_to(frame + bytes(20) + frame)
    assert first == second
    assert controller.status().target == 7


def test_cut_and_damaged_frames_are_dropped(controller: Controller) -> None:
    frame = controller.frame(p.STATUS, b"\0")
    for length in range(1, len(frame) - 1):
        assert controller.replies_to(frame[:length] + b"\0") == []
    for i in range(len(frame) - 1):
        for bit in range(8):
            damaged = bytearray(frame)
            damaged[i] ^= 1 << bit
            assert controller.replies_to(bytes(damaged) + b"\0") == []
    assert controller.status().state == p.IDLE


def test_frames_that_are_too_long_are_dropped(controller: Controller) -> None:
    for length in (57, 100, 250):
        assert controller.replies_to(encode_frame(bytes([p.STATUS]) * length)) == []
    assert len(controller.replies_to(controller.frame(0x7F, bytes(52)))) == 1


def test_noise_does_not_stop_it(controller: Controller) -> None:
    generator = random.Random(1)
    for _ in range(50):
        noise = generator.randbytes(2000)
        controller.replies_to(noise + b"\0")
    assert controller.status().state == p.IDLE


# ---- delivery


def test_delivery_is_refused_out_of_order(controller: Controller) -> None:
    image = RAMP.image()
    assert controller.refused(p.DATA, b"\0\0x") == (p.OUT_OF_ORDER, 0)
    for kind in (p.END, p.TRY, p.COMMIT):
        assert controller.refused(kind) == (p.OUT_OF_ORDER, 0)
    assert controller.refused(p.BEGIN, struct.pack("<HH", 441, 0)) == (p.OUT_OF_RANGE, 440)
    controller.ok(p.BEGIN, struct.pack("<HH", len(image), p.crc16(image)))
    controller.ok(p.DATA, b"\0\0" + image[:10])
    assert controller.refused(p.DATA, b"\0\0" + image[:10]) == (p.OUT_OF_ORDER, 10)
    assert controller.refused(p.DATA, b"\x0a\0" + image[10:] + b"x") == (p.OUT_OF_RANGE, len(image))
    for kind in (p.END, p.TRY, p.COMMIT):
        assert controller.refused(kind) == (p.OUT_OF_ORDER, 10)
    controller.ok(p.DATA, b"\x0a\0" + image[10:])
    for kind in (p.TRY, p.COMMIT):
        assert controller.refused(kind) == (p.OUT_OF_ORDER, len(image))
    assert controller.ok(p.END) == controller.ok(p.END) == bytes([1, 1])
    controller.ok(p.TRY)
    for kind in (p.END, p.TRY):
        assert controller.refused(kind) == (p.OUT_OF_ORDER, 0)
    assert controller.refused(p.DATA, struct.pack("<HB", len(image), 0)) == (p.OUT_OF_ORDER, 0)


def test_end_tells_axes_and_ramps(controller: Controller) -> None:
    controller.deliver(p.image_of([RAMP.packed(), OTHER.packed()], [1, 0, 1]))
    assert controller.ok(p.END) == bytes([3, 2])


def test_a_bad_crc_is_refused(controller: Controller) -> None:
    image = RAMP.image()
    controller.ok(p.BEGIN, struct.pack("<HH", len(image), 0))
    for part in p.image_parts(image):
        controller.ok(p.DATA, part)
    assert controller.refused(p.END) == (p.BAD_CRC, p.crc16(image))
    assert controller.refused(p.COMMIT)[0] == p.OUT_OF_ORDER


def test_bad_ramps_are_refused(controller: Controller) -> None:
    too_fast = Ramp([(100, 1, 0), (13, 1, 0)], 100, []).packed()
    for image, ramp, segment in [
        (p.image_of([RAMP.packed(), too_fast], [0, 1]), 1, 1),
        (p.image_of([too_fast]), 0, 1),
        (p.image_of([p.with_header(0, b"")]), 0, 255),
        (p.image_of([p.with_header(7, b"")]), 0, 255),
        (b"\1" + RAMP.image()[1:], 255, 255),
        (RAMP.image() + b"\0", 255, 255),
        (p.image_of([RAMP.packed(), RAMP.packed()], [0, 0]), 255, 255),
        (b"", 255, 255),
    ]:
        controller.deliver(image)
        assert controller.refused(p.END) == (p.BAD_RAMP, ramp << 8 | segment)
        for kind in (p.COMMIT, p.TRY):
            assert controller.refused(kind) == (p.OUT_OF_ORDER, len(image))


def test_reading_what_is_in_ram(controller: Controller) -> None:
    image = RAMP.image()
    length = struct.pack("<H", len(image))
    assert controller.ok(p.READ, struct.pack("<BHB", p.RAM, 0, 48)) == b"\0\0"
    controller.deliver(image)
    assert controller.ok(p.READ, struct.pack("<BHB", p.RAM, 0, 48)) == length + image[:48]
    assert controller.ok(p.READ, struct.pack("<BHB", p.RAM, 30, 48)) == length + image[30:78]
    assert controller.ok(p.READ, struct.pack("<BHB", p.RAM, len(image), 1)) == length
    assert controller.ok(p.READ, struct.pack("<BHB", p.RAM, 65_535, 48)) == length
    for source in (p.STORED, p.PREVIOUS):
        assert controller.ok(p.READ, struct.pack("<BHB", source, 0, 48)) == b"\0\0"
    assert controller.refused(p.READ, struct.pack("<BHB", 3, 0, 48)) == (p.OUT_OF_RANGE, 3)
    assert controller.refused(p.READ, struct.pack("<BHB", 0, 0, 0)) == (p.OUT_OF_RANGE, 0)
    assert controller.refused(p.READ, struct.pack("<BHB", 0, 0, 49)) == (p.OUT_OF_RANGE, 49)


def test_a_move_drops_what_was_delivered(controller: Controller) -> None:
    controller.push(RAMP)
    controller.check(OTHER.image())
    assert (controller.read(p.RAM), controller.status().crc) == (OTHER.image(), p.crc16(RAMP.image()))
    controller.ok(p.MOVE_BY, for_axes({0: 3}))
    controller.run_until_idle()
    assert controller.read(p.RAM) == RAMP.image()
    assert controller.refused(p.TRY) == (p.OUT_OF_ORDER, 0)
    assert (controller.status().position, controller.steps()[0]) == (3, 3)


def test_without_a_stored_ramp_a_delivery_is_not_dropped(controller: Controller) -> None:
    controller.check(RAMP.image())
    assert controller.refused(p.MOVE_BY, for_axes({0: 3})) == (p.NO_RAMP, 0)
    controller.ok(p.TRY)
    controller.ok(p.MOVE_BY, for_axes({0: 3}))


# ---- a ramp on trial, the previous one


def test_a_ramp_on_trial(controller: Controller) -> None:
    controller.push(RAMP)
    controller.check(FOUR_AXES)
    controller.ok(p.TRY)
    hello, status = controller.hello(), controller.status()
    assert (hello.sequence, hello.crc, hello.in_use) == (1, p.crc16(FOUR_AXES), p.TRIAL_IN_USE)
    assert (status.sequence, status.crc, status.flags & p.ON_TRIAL) == (1, p.crc16(FOUR_AXES), p.ON_TRIAL)
    assert (controller.read(p.STORED), controller.read(p.RAM)) == (RAMP.image(), FOUR_AXES)
    controller.ok(p.MOVE_BY, for_axes({0: 5, 3: -9}))
    controller.run_until_idle()
    assert controller.steps() == [5, 0, 0, -9]
    controller.ok(p.ROLL_BACK)
    hello = controller.hello()
    assert (hello.sequence, hello.crc, hello.in_use) == (1, p.crc16(RAMP.image()), p.STORED_IN_USE)
    assert controller.status().flags & p.ON_TRIAL == 0
    assert controller.refused(p.MOVE_BY, for_axes({3: 1})) == (p.OUT_OF_RANGE, 8)
    assert [controller.status(axis).position for axis in range(4)] == [5, 0, 0, -9]


def test_a_ramp_on_trial_is_forgotten_without_power_and_by_a_new_delivery(driver: Driver) -> None:
    controller = started(driver)
    controller.push(RAMP)
    controller.check(OTHER.image())
    controller.ok(p.TRY)
    controller.ok(p.BEGIN, struct.pack("<HH", 10, 0))
    assert (controller.hello().crc, controller.hello().in_use) == (p.crc16(RAMP.image()), p.STORED_IN_USE)
    controller.check(OTHER.image())
    controller.ok(p.TRY)
    controller = started(driver)
    assert controller.hello().crc == p.crc16(RAMP.image())


def test_a_ramp_on_trial_can_be_stored(controller: Controller) -> None:
    controller.check(OTHER.image())
    controller.ok(p.TRY)
    assert controller.hello().sequence == 0
    controller.ok(p.COMMIT)
    controller.run(WHOLE_COMMIT)
    assert (controller.hello().sequence, controller.hello().in_use) == (1, p.STORED_IN_USE)
    assert controller.read() == OTHER.image()


def test_rolling_back_a_trial_with_nothing_stored(controller: Controller) -> None:
    controller.check(RAMP.image())
    controller.ok(p.TRY)
    controller.ok(p.WRITE_SETTINGS, Settings(pulse_width_us=9).packed())
    controller.ok(p.ROLL_BACK)
    assert (controller.hello().in_use, controller.settings()) == (p.NO_RAMP_IN_USE, Settings().packed())
    assert controller.refused(p.ROLL_BACK) == (p.NO_RAMP, 0)
    assert controller.refused(p.MOVE_BY, for_axes({0: 1})) == (p.NO_RAMP, 0)


def test_rolling_back_to_the_previous_ramp_and_its_settings(driver: Driver) -> None:
    controller = started(driver)
    controller.push(RAMP)
    assert controller.refused(p.ROLL_BACK) == (p.NO_RAMP, 0)
    controller.ok(p.WRITE_SETTINGS, Settings(pulse_width_us=5).packed())
    controller.push(OTHER)
    assert controller.read(p.PREVIOUS) == RAMP.image()
    for sequence, ramp, width in [(3, RAMP, 0), (4, OTHER, 5), (5, RAMP, 0)]:
        controller.ok(p.ROLL_BACK)
        assert controller.status().state == p.WRITING
        assert controller.refused(p.MOVE_BY, for_axes({0: 1})) == (p.BUSY, 0)
        controller.run(WHOLE_COMMIT)
        for _ in range(2):
            assert (controller.read(), controller.read(p.RAM)) == (ramp.image(), ramp.image())
            assert controller.settings() == Settings(pulse_width_us=width).packed()
            assert (controller.status().sequence, controller.status().flags & ~p.ENABLED) == (sequence, 0)
            controller = started(driver)
    assert controller.read(p.PREVIOUS) == OTHER.image()
    controller.ok(p.MOVE_BY, for_axes({0: 3}))


def test_rolling_back_drops_a_delivery_first(controller: Controller) -> None:
    controller.push(RAMP)
    controller.push(OTHER)
    controller.deliver(RAMP.image())
    controller.ok(p.ROLL_BACK)
    assert (controller.status().state, controller.read(p.RAM)) == (p.IDLE, OTHER.image())
    controller.ok(p.ROLL_BACK)
    controller.run(WHOLE_COMMIT)
    assert controller.read() == RAMP.image()


# ---- settings


def test_settings_are_used_stored_and_rolled_back(driver: Driver) -> None:
    controller = started(driver)
    assert controller.settings() == Settings().packed()
    controller.push(RAMP)
    changed = Settings(both_edges=3, enable_lead_ms=500).packed()
    controller.ok(p.WRITE_SETTINGS, changed)
    assert (controller.settings(), controller.status().flags & p.ON_TRIAL) == (changed, p.ON_TRIAL)
    assert controller.hello().in_use == p.STORED_IN_USE
    controller.ok(p.ROLL_BACK)
    assert (controller.settings(), controller.status().flags & p.ON_TRIAL) == (Settings().packed(), 0)
    controller.ok(p.WRITE_SETTINGS, changed)
    controller.ok(p.COMMIT)
    controller.run(WHOLE_COMMIT)
    controller = started(driver)
    assert (controller.settings(), controller.read(), controller.status().sequence) == (changed, RAMP.image(), 2)
    assert controller.status().flags & p.ON_TRIAL == 0


def test_settings_stay_on_trial_through_a_delivery_that_is_dropped(controller: Controller) -> None:
    controller.push(RAMP)
    changed = Settings(direction_inverted=1).packed()
    controller.deliver(OTHER.image())
    controller.ok(p.WRITE_SETTINGS, changed)
    controller.ok(p.MOVE_BY, for_axes({0: 1}))
    assert controller.settings() == changed


def test_bad_settings_are_refused(controller: Controller) -> None:
    for bad, detail in [
        (Settings(outputs=2), 0),
        (Settings(direction_inverted=16), 3),
        (Settings(direction_setup_us=19), 6),
        (Settings(enable_lead_ms=1001), 8),
    ]:
        assert controller.refused(p.WRITE_SETTINGS, bad.packed()) == (p.OUT_OF_RANGE, detail)
    assert controller.settings() == Settings().packed()
    assert controller.status().flags == 0


# ---- writing and moving


def test_while_writing_what_would_disturb_is_refused(controller: Controller) -> None:
    controller.push(OTHER)
    controller.check(RAMP.image())
    controller.ok(p.COMMIT)
    assert controller.status().state == p.WRITING
    for kind, length in (CHANGES | FOR_AXES).items():
        assert controller.refused(kind, (b"\1" + bytes(length))[:length]) == (p.BUSY, 0)
    controller.ok(p.STOP)
    controller.ok(p.HALT)
    assert (controller.read(p.STORED), controller.read(p.RAM), controller.read(p.PREVIOUS)) == (
        OTHER.image(),
        RAMP.image(),
        b"",
    )
    controller.run(WHOLE_COMMIT)
    assert controller.status().state == p.IDLE
    assert (controller.read(p.STORED), controller.read(p.PREVIOUS)) == (RAMP.image(), OTHER.image())


def test_while_moving_what_would_disturb_is_refused(controller: Controller) -> None:
    controller.push(RAMP)
    controller.ok(p.MOVE_BY, for_axes({0: 100}))
    for kind, length in (CHANGES | FOR_AXES).items():
        if kind not in (p.MOVE_BY, p.MOVE_TO, p.RUN):
            assert controller.refused(kind, (b"\1" + bytes(length))[:length]) == (p.MOVING, 0)
    assert controller.read() == RAMP.image()
    assert controller.settings() == Settings().packed()
    assert controller.ok(p.MOVE_BY, for_axes({0: 11})) == struct.pack("<i", 111)
    assert controller.ok(p.MOVE_TO, for_axes({0: 120})) == struct.pack("<i", 120)
    assert controller.run_until_idle().position == 120
    assert controller.steps()[0] == 120


def test_on_a_line_nothing_may_move(controller: Controller) -> None:
    controller.push(TWO_AXES)
    assert controller.ok(p.LINE, bytes([3, 0]) + p.values_of({0: 50, 1: -20})) == struct.pack("<ii", 50, -20)
    for kind in (p.MOVE_BY, p.MOVE_TO, p.RUN, p.LINE):
        assert controller.refused(kind, (b"\1" + bytes(FOR_AXES[kind]))[: FOR_AXES[kind]]) == (p.MOVING, 0)
    assert controller.run_until_idle().position == 50
    assert controller.steps()[:2] == [50, -20]


# ---- moves


def test_masks_name_axes_that_the_ramp_has(controller: Controller) -> None:
    for kind, length in FOR_AXES.items():
        assert controller.refused(kind, (b"\1" + bytes(length))[:length]) == (p.NO_RAMP, 0)
    controller.push(TWO_AXES)
    for kind in set(FOR_AXES) - {p.ZERO}:
        extra = int(kind == p.LINE)
        for mask in (0, 4, 5, 128, 255):
            body = bytes([mask]) + bytes(extra + 4 * mask.bit_count())
            assert controller.refused(kind, body) == (p.OUT_OF_RANGE, mask)
    assert controller.refused(p.ZERO, b"\4\1\0") == (p.OUT_OF_RANGE, 4)


def test_values_go_to_their_axes(controller: Controller) -> None:
    controller.push(FOUR_AXES)
    assert controller.ok(p.MOVE_BY, for_axes({1: 7, 3: -4})) == struct.pack("<ii", 7, -4)
    controller.run_until_idle()
    assert [controller.status(axis).position for axis in range(4)] == [0, 7, 0, -4]
    assert controller.ok(p.MOVE_TO, for_axes({0: 1, 1: 2, 2: -3, 3: 4})) == struct.pack("<4i", 1, 2, -3, 4)
    controller.run_until_idle()
    assert controller.steps() == [controller.status(axis).position for axis in range(4)] == [1, 2, -3, 4]
    assert controller.refused(p.STATUS, b"\4") == (p.OUT_OF_RANGE, 4)


@pytest.mark.parametrize("target", [-(2**31), 2**31 - 1])
def test_the_farthest_targets(controller: Controller, target: int) -> None:
    controller.push(RAMP)
    assert controller.ok(p.MOVE_TO, for_axes({0: target})) == struct.pack("<i", target)
    status = controller.status()
    assert (status.state, status.axis_state, status.target) == (p.IN_MOTION, p.IN_MOTION, target)
    controller.ok(p.HALT)
    assert controller.status().state == p.IDLE


def test_a_target_beyond_32_bits_is_refused(controller: Controller) -> None:
    controller.push(TWO_AXES)
    controller.ok(p.SET_POSITION, for_axes({1: 2**31 - 5}))
    assert controller.refused(p.MOVE_BY, for_axes({0: 5, 1: 5})) == (p.OUT_OF_RANGE, 1)
    assert controller.refused(p.LINE, b"\3\0" + p.values_of({0: 5, 1: 5})) == (p.OUT_OF_RANGE, 1)
    controller.ok(p.SET_POSITION, for_axes({0: -(2**31), 1: 0}))
    assert controller.refused(p.MOVE_BY, for_axes({0: -1})) == (p.OUT_OF_RANGE, 0)
    assert controller.status().state == p.IDLE
    assert controller.ok(p.MOVE_BY, for_axes({0: 2**31 - 1})) == struct.pack("<i", -1)


def test_positions_are_set_and_zeroed(controller: Controller) -> None:
    controller.push(TWO_AXES)
    controller.ok(p.SET_POSITION, for_axes({0: -70, 1: 1234}))
    assert (controller.status(0).position, controller.status(1).position) == (-70, 1234)
    controller.ok(p.ZERO, struct.pack("<BH", 2, 30))
    assert controller.status(1).state == p.IN_MOTION
    controller.run_until_idle()
    assert (controller.status(0).position, controller.status(1).position) == (-70, 0)
    assert controller.steps() == [0, -30, 0, 0]


def test_a_line_needs_an_axis_whose_ramp_it_plays(controller: Controller) -> None:
    controller.push(TWO_AXES)
    assert controller.refused(p.LINE, b"\3\2" + p.values_of({0: 5, 1: 5})) == (p.OUT_OF_RANGE, 2)
    assert controller.ok(p.LINE, b"\1\1" + p.values_of({0: 5})) == struct.pack("<i", 5)
    assert controller.run_until_idle().position == 5


def test_a_run_is_not_faster_than_the_ramp_nor_too_slow(controller: Controller) -> None:
    controller.push(TWO_AXES)
    for interval in (1999, -1999, 2**28, -(2**28), -(2**31)):
        assert controller.refused(p.RUN, for_axes({0: interval})) == (p.OUT_OF_RANGE, 0)
    assert controller.refused(p.RUN, for_axes({0: 5000, 1: -2999})) == (p.OUT_OF_RANGE, 1)
    assert controller.status().state == p.IDLE
    controller.ok(p.RUN, for_axes({0: 5000, 1: -3000}))
    controller.run(1000)
    assert controller.status(0).state == controller.status(1).axis_state == p.IN_MOTION
    controller.ok(p.RUN, for_axes({0: 0, 1: 0}))
    controller.run_until_idle()
    positions = [controller.status(axis).position for axis in range(2)]
    assert controller.steps()[:2] == positions
    assert positions[0] > 0 > positions[1]


SILENT = 20_000
"""Rounds, of a byte's time at 115200 baud each: 1.7 s."""


def test_a_run_ends_when_nobody_asks_for_anything(controller: Controller) -> None:
    controller.push(TWO_AXES)
    controller.ok(p.RUN, for_axes({0: 5000, 1: 5000}))
    for _ in range(5):
        controller.run(SILENT // 2)
        assert controller.status(0).axis_state == p.IN_MOTION
    # Axis 1 has got a target to end at, so it needs nobody.
    controller.ok(p.MOVE_TO, for_axes({1: 100_000}))
    at = controller.status(0).position
    controller.run(SILENT)
    assert controller.status(0).axis_state == p.IDLE
    # An interval takes 3.6 rounds here: that many steps are 1.0 to 1.3 s.
    assert 3200 <= controller.status(0).position - at <= 4200
    assert controller.status(1).axis_state == p.IN_MOTION


def test_what_is_refused_changes_nothing_of_that(controller: Controller) -> None:
    controller.push(TWO_AXES)
    controller.ok(p.RUN, for_axes({0: 5000}))
    controller.ok(p.MOVE_TO, for_axes({1: 100_000}))
    assert controller.refused(p.MOVE_BY, for_axes({0: 2**31 - 1})) == (p.OUT_OF_RANGE, 0)
    assert controller.refused(p.RUN, for_axes({1: 1})) == (p.OUT_OF_RANGE, 1)
    controller.run(SILENT)
    assert controller.status(0).axis_state == p.IDLE
    assert controller.status(1).axis_state == p.IN_MOTION


@pytest.mark.parametrize("next_one", [p.ZERO, p.LINE, p.MOVE_BY])
def test_what_comes_after_a_run_needs_nobody(controller: Controller, next_one: int) -> None:
    controller.push(TWO_AXES)
    controller.ok(p.RUN, for_axes({1: 5000}))
    controller.ok(p.STOP, b"")
    controller.run_until_idle()
    bodies = {p.ZERO: struct.pack("<BH", 2, 60_000), p.LINE: b"\2\1" + p.values_of({1: 60_000}),
              p.MOVE_BY: for_axes({1: 60_000})}  # fmt: skip
    controller.ok(next_one, bodies[next_one])
    controller.run(SILENT)
    status = controller.status(1)
    assert (status.axis_state, status.steps_made > 4000) == (p.IN_MOTION, True)


def test_what_is_too_fast_together_is_refused(controller: Controller) -> None:
    fast = LIMITS.shortest[0] + 40
    controller.push(Ramp([(4000, 20, -150)], fast, []).image(2, fast=True))
    status, share = controller.refused(p.MOVE_BY, for_axes({0: 100, 1: 100}))
    assert (status, share > 100) == (p.TOO_FAST, True)
    assert controller.status().state == p.IDLE
    controller.ok(p.MOVE_BY, for_axes({0: 100}))


# ---- reports and traces


def timed_messages(controller: Controller, rounds: int, data: bytes = b"") -> list[tuple[int, bytes]]:
    """Return what is sent in so many rounds, while bytes come in at the first of them: messages, and the round of the
    last byte of each."""
    messages, frame = [], controller.half_frame
    for word in controller.driver.ask("run", rounds, data.hex()).split():
        at, byte = word.split(":")
        frame += bytes.fromhex(byte)
        if byte == "00":
            messages.append((int(at), frame))
            frame = b""
    controller.half_frame = frame
    return [(at, decode_frame(frame)) for at, frame in messages if is_whole(frame)]


def test_reports_come_as_often_as_asked(controller: Controller) -> None:
    controller.push(TWO_AXES)
    controller.ok(p.SET_POSITION, for_axes({0: -5, 1: 77}))
    a_second = round(1e6 / BYTE_US)
    for rate in (50, 10, 1):
        controller.ok(p.REPORT, bytes([rate]))
        reports = [message for _, message in timed_messages(controller, a_second)]
        assert len(reports) in (rate - 1, rate, rate + 1)
        assert all(each[0] == p.REPORT_NOTICE and each[1:3] == struct.pack("<H", SESSION) for each in reports)
        assert [each[3] - reports[0][3] & 255 for each in reports] == list(range(len(reports)))
        said = [Report.unpack(each[4:]) for each in reports]
        assert {(each.positions, each.intervals, each.states) for each in said} == {((-5, 77), (0, 0), (0, 0, 0, 0))}
        times = [each.time_ms for each in said]
        assert all((b - a & 0xFFFF) - 1000 // rate in (-1, 0, 1) for a, b in pairwise(times))
    assert controller.refused(p.REPORT, b"\x33") == (p.OUT_OF_RANGE, 51)
    controller.ok(p.REPORT, b"\0")
    assert timed_messages(controller, a_second) == []


def test_reports_follow_a_move(controller: Controller) -> None:
    controller.push(TWO_AXES)
    controller.ok(p.REPORT, b"\x32")
    controller.notices.clear()
    frame = controller.frame(p.MOVE_BY, for_axes({1: 300}))
    sent = timed_messages(controller, round(1e6 / BYTE_US), frame)
    said = [Report.unpack(message[4:]) for _, message in sent if message[0] == p.REPORT_NOTICE]
    positions = [each.positions[1] for each in said]
    assert positions == sorted(positions)
    assert (positions[-1], said[-1].states) == (300, (0, 0, 0, 0))
    assert {each.states for each in said} == {(0, 0, 0, 0), (0, 1, 0, 0)}
    assert any(3000 <= each.intervals[1] <= 5000 for each in said)


def test_a_hello_ends_reports_and_traces(controller: Controller) -> None:
    controller.push(RAMP)
    controller.ok(p.REPORT, b"\x32")
    controller.ok(p.TRACE, b"\0\1\0")
    controller.hello()
    controller.ok(p.MOVE_BY, for_axes({0: 50}))
    assert timed_messages(controller, 10_000) == []


def traced(controller: Controller, every: int, move: bytes, rounds: int = 20_000) -> list[Trace]:
    """Return the trace frames of a move of axis 0."""
    controller.ok(p.TRACE, struct.pack("<BH", 0, every))
    sent = timed_messages(controller, rounds, move)
    return [Trace.unpack(message[4:]) for _, message in sent if message[0] == p.TRACE_NOTICE]


def test_the_values_of_a_trace_are_the_times_of_the_steps(controller: Controller) -> None:
    """Ten steps apart, on a slow ramp, the differences are sums of ten intervals."""
    ramp = Ramp([(4000, 40, -50)], 2000, [(4000, 40, -50)])
    controller.push(ramp)
    said = traced(controller, 10, controller.frame(p.MOVE_BY, for_axes({0: 300})))
    values: dict[int, int] = {}
    for each in said:
        assert (each.axis, each.every) == (0, 10)
        values |= each.by_step()
    assert [each.is_last for each in said] == [False] * (len(said) - 1) + [True]
    assert list(values) == list(range(1, 301, 10))
    intervals = ramp.intervals(300)
    for step in list(values)[1:]:
        assert values[step] - values[step - 10] & 0xFFFF == sum(intervals[step - 11 : step - 1]) & 0xFFFF


def test_a_trace_goes_on_when_another_axis_sets_out(controller: Controller) -> None:
    controller.push(RAMP.image(2))
    controller.ok(p.TRACE, b"\0\x07\0")
    controller.ok(p.MOVE_BY, for_axes({0: 300}))
    sent = timed_messages(controller, 1500)
    for _ in range(3):
        sent += timed_messages(controller, 500, controller.frame(p.MOVE_BY, for_axes({1: 3})))
    sent += timed_messages(controller, 20_000)
    said = [Trace.unpack(message[4:]) for _, message in sent if message[0] == p.TRACE_NOTICE]
    values: dict[int, int] = {}
    for each in said:
        values |= each.by_step()
    assert list(values) == list(range(1, 301, 7))
    intervals = RAMP.intervals(300)
    for step in list(values)[1:]:
        assert values[step] - values[step - 7] & 0xFFFF == sum(intervals[step - 8 : step - 1]) & 0xFFFF


def test_what_the_line_cannot_carry_leaves_gaps(controller: Controller) -> None:
    controller.push(Ramp([(4000, 20, -150)], 250, []).image(fast=False))
    said = traced(controller, 1, controller.frame(p.MOVE_BY, for_axes({0: 20_000})), 40_000)
    steps = [step for each in said for step in each.by_step()]
    assert said[-1].is_last
    assert steps == sorted(set(steps))
    assert 1000 < len(steps) < 20_000
    assert controller.status().position == 20_000


def test_the_controller_chooses_how_much_it_traces(controller: Controller) -> None:
    """About 1000 values a second at slew speed."""
    controller.push(p.image_of([Ramp([], 250, []).packed(), Ramp([], 20_000, []).packed()], [0, 1]))
    assert controller.ok(p.TRACE, b"\0\0\0") == struct.pack("<H", 8)
    assert controller.ok(p.TRACE, b"\1\0\0") == struct.pack("<H", 1)
    assert controller.ok(p.TRACE, b"\1\x07\0") == struct.pack("<H", 7)
    assert controller.refused(p.TRACE, b"\2\0\0") == (p.OUT_OF_RANGE, 2)
    controller.ok(p.TRACE, b"\xff\0\0")
    controller.check(Ramp([], 1000, []).image(fast=True))
    controller.ok(p.TRY)
    assert controller.ok(p.TRACE, b"\0\0\0") == struct.pack("<H", 16)


def test_each_move_has_its_trace(controller: Controller) -> None:
    controller.push(RAMP)
    for steps in (40, -40):
        said = traced(controller, 10, controller.frame(p.MOVE_BY, for_axes({0: steps})), 40_000)
        assert [step for each in said for step in each.by_step()] == [1, 11, 21, 31]
        assert said[-1].is_last


@pytest.mark.parametrize("kind", [p.STOP, p.HALT])
@pytest.mark.parametrize("session", [0, SESSION - 1])
def test_stop_and_halt_are_obeyed_whoever_asks(controller: Controller, kind: int, session: int) -> None:
    controller.push(TWO_AXES)
    controller.ok(p.RUN, for_axes({0: 5000, 1: 5000}))
    controller.run(2000)
    assert controller.send(kind, session=session) == bytes([p.OK])
    assert controller.status(0).axis_state == (p.STOPPING if kind == p.STOP else p.IDLE)
    assert controller.run_until_idle().position == controller.steps()[0]
    assert controller.refused(kind, b"\4", session=session) == (p.OUT_OF_RANGE, 4)
    assert controller.refused(p.MOVE_BY, for_axes({0: 1}), session=session) == (p.STALE, 0)


@pytest.mark.parametrize("kind", [p.STOP, p.HALT])
def test_stop_and_halt_are_obeyed_each_time(controller: Controller, kind: int) -> None:
    """Also with the header of the last request."""
    controller.push(TWO_AXES)
    for _ in range(2):
        controller.ok(p.RUN, for_axes({0: 5000}))
        controller.run(2000)
        assert controller.status(0).axis_state == p.IN_MOTION
        assert controller.send(kind, tag=99) == controller.send(kind, tag=99) == bytes([p.OK])
        controller.run_until_idle()


@pytest.mark.parametrize("kind", [p.STOP, p.HALT])
@pytest.mark.parametrize("session", [0, SESSION])
def test_stop_and_halt_are_obeyed_while_a_reply_is_being_sent(controller: Controller, kind: int, session: int) -> None:
    """At any byte of it. What was being sent ends early; what comes after it is whole."""
    controller.push(TWO_AXES)
    for sent_bytes in range(40):
        controller.ok(p.RUN, for_axes({0: 5000, 1: 5000}))
        controller.run(2000)
        status, stop = controller.frame(p.STATUS, b"\0"), controller.frame(kind, session=session)
        sent = timed_messages(controller, len(status) + sent_bytes, status)
        sent += timed_messages(controller, 100, stop)
        assert sent[-1][1] == struct.pack("<BHBB", kind | 0x80, session, controller.tag, p.OK)
        assert sent[-1][0] <= len(stop) + LONGEST_WAIT + len(encode_frame(sent[-1][1]))
        assert controller.status(0).axis_state == (p.STOPPING if kind == p.STOP else p.IDLE)
        controller.run_until_idle()


@pytest.mark.parametrize("kind", [p.STOP, p.HALT])
@pytest.mark.parametrize("body", [b"", b"\3"])
def test_stop_and_halt_are_obeyed_whenever_the_request_before_them_is_answered(
    controller: Controller, kind: int, body: bytes
) -> None:
    """Before them, or at any byte of them, also without a reply awaited."""
    controller.push(TWO_AXES)
    for known_bytes in range(12):
        controller.ok(p.RUN, for_axes({0: 5000, 1: 5000}))
        controller.run(2000)
        status, stop = controller.frame(p.STATUS, b"\0"), b"\0" + controller.frame(kind, body)
        controller.driver.ask("hand", (status + stop[:known_bytes]).hex())
        sent = timed_messages(controller, 2)
        controller.driver.ask("hand", stop[known_bytes:].hex() or "-")
        sent += timed_messages(controller, 40)
        assert sent[-1][1] == struct.pack("<BHBB", kind | 0x80, SESSION, controller.tag, p.OK)
        assert controller.status(0).axis_state == (p.STOPPING if kind == p.STOP else p.IDLE)
        controller.run_until_idle()


@pytest.mark.parametrize("kind", [p.STOP, p.HALT])
def test_stop_and_halt_are_answered_within_10_ms_on_a_full_line(controller: Controller, kind: int) -> None:
    controller.push(Ramp([(4000, 20, -150)], 250, []).image(4))
    controller.ok(p.REPORT, b"\x32")
    controller.ok(p.TRACE, b"\0\1\0")
    controller.ok(p.RUN, for_axes({0: 2000}))
    timed_messages(controller, 5000)
    for delay in range(0, 150, 3):
        timed_messages(controller, delay)
        frame = controller.frame(kind)
        sent = timed_messages(controller, 300, frame)
        (answered,) = [at for at, message in sent if message[0] == kind | 0x80]
        assert (answered - len(frame)) * BYTE_US < 10_000


# ---- EEPROM


def slot(sequence: int, image: bytes, settings: Settings | None = None) -> bytes:
    content = (settings or Settings()).packed() + image
    header = struct.pack("<BBHIH", 0x53, 2, len(content), sequence, p.crc16(content))
    return (header + struct.pack("<H", p.crc16(header)) + content).ljust(512, b"\xff")


def test_slots_lie_in_eeprom_as_documented(controller: Controller) -> None:
    controller.push(RAMP)
    controller.ok(p.WRITE_SETTINGS, Settings(pulse_width_us=3).packed())
    controller.push(TWO_AXES)
    assert (
        controller.driver.ask("eeprom") == (slot(1, RAMP.image()) + slot(2, TWO_AXES, Settings(0, 0, 0, 0, 0, 3))).hex()
    )


def test_the_newer_ramp_is_found_at_start(driver: Driver) -> None:
    controller = started(driver)
    for sequence, ramp in enumerate([RAMP, OTHER, RAMP, OTHER, OTHER], 1):
        controller.push(ramp)
        controller = started(driver)
        status = controller.status()
        assert (status.sequence, status.crc) == (sequence, p.crc16(ramp.image()))
        assert controller.read() == ramp.image()


BAD_CONTENTS = [
    slot(9, b"\1" + OTHER.image()[1:]),
    slot(9, b""),
    slot(9, OTHER.image(), Settings(outputs=7)),
    slot(9, OTHER.image())[:30] + b"\0" + slot(9, OTHER.image())[31:],
    b"\0" * 512,
    b"\x53\2" + b"\xff" * 510,
    b"\x53\1" + slot(9, OTHER.image())[2:],
    b"\x53\2\0\0" + slot(9, OTHER.image())[4:],
]


@pytest.mark.parametrize("bad", BAD_CONTENTS)
def test_a_slot_that_is_not_sound_is_not_used(driver: Driver, bad: bytes) -> None:
    for content in (slot(1, RAMP.image()) + bad, bad + slot(1, RAMP.image())):
        driver.ask("eeprom", content.hex())
        controller = started(driver)
        hello = controller.hello()
        assert (hello.sequence, hello.crc) == (1, p.crc16(RAMP.image()))
        assert (controller.read(), controller.read(p.PREVIOUS)) == (RAMP.image(), b"")
        assert controller.refused(p.ROLL_BACK) == (p.NO_RAMP, 0)
    driver.ask("eeprom", (bad + bad).hex())
    assert started(driver).hello().in_use == p.NO_RAMP_IN_USE


def test_a_slot_with_a_header_cut_while_rolling_back_is_the_older_one(driver: Driver) -> None:
    torn = bytearray(slot(8, OTHER.image()))
    torn[4:8] = b"\xff\0\0\0"
    driver.ask("eeprom", (bytes(torn) + slot(5, RAMP.image())).hex())
    controller = started(driver)
    assert (controller.hello().sequence, controller.read(p.PREVIOUS)) == (5, OTHER.image())
    controller.ok(p.ROLL_BACK)
    controller.run(WHOLE_COMMIT)
    assert (controller.hello().sequence, controller.read()) == (6, OTHER.image())
    driver.ask("eeprom", torn.hex())
    controller = started(driver)
    assert (controller.hello().sequence, controller.read()) == (1, OTHER.image())


def test_bytes_that_are_there_already_are_not_written(controller: Controller) -> None:
    controller.push(RAMP)
    controller.push(RAMP)
    before = int(controller.driver.ask("writes"))
    controller.push(RAMP)
    changed = {i for i, (a, b) in enumerate(zip(slot(1, RAMP.image()), slot(3, RAMP.image()), strict=True)) if a != b}
    assert int(controller.driver.ask("writes")) - before == len(changed | {0}) + 1


KEPT = {
    "one ramp": slot(1, RAMP.image()),
    "two ramps": slot(4, OLDER.image()) + slot(5, RAMP.image()),
}
CUT_LEAVES = (0xFF, 0x00, 0x53, 0xA5, -1)
"""What a power cut leaves of the byte that is being written; -1: what was there."""


@pytest.mark.parametrize("kept", KEPT)
@pytest.mark.parametrize("left", CUT_LEAVES)
def test_a_power_cut_at_any_write_of_a_commit(driver: Driver, kept: str, left: int) -> None:
    """Leaves the old ramp with its settings, or the new one with its own."""
    sequence = 5 if len(KEPT[kept]) > 512 else 1
    old = (sequence, RAMP.image(), Settings().packed())
    changed = Settings(pulse_width_us=8).packed()
    outcomes = []
    for cut in range(1, 200):
        driver.ask("eeprom", KEPT[kept].hex())
        controller = started(driver)
        controller.ok(p.WRITE_SETTINGS, changed)
        driver.ask("cut", cut, left)
        controller.push(OTHER)
        after, is_done = after_power_cut(driver, cut)
        outcomes.append(after)
        if is_done:
            break
    new = (sequence + 1, OTHER.image(), changed)
    count_old = outcomes.index(new)
    assert outcomes[:count_old] == [old] * count_old
    assert outcomes[count_old:] == [new] * (len(outcomes) - count_old)
    assert len(outcomes) >= 20
    assert len(outcomes) - count_old <= 2


@pytest.mark.parametrize("left", CUT_LEAVES)
def test_a_power_cut_at_any_write_of_a_roll_back(driver: Driver, left: int) -> None:
    """Leaves the one ramp or the other, and the other one can still be rolled back to. Sequence numbers whose bytes are
    written one by one may come out mixed; they only have to tell which one is newer."""
    outcomes = set()
    for old_sequence in (1, 254, 255, 256, 65_535, 2**24 - 1):
        for cut in range(1, 20):
            kept = slot(old_sequence, OLDER.image(), Settings(0, 1)) + slot(old_sequence + 1, RAMP.image())
            driver.ask("eeprom", kept.hex())
            controller = started(driver)
            driver.ask("cut", cut, left)
            controller.ok(p.ROLL_BACK)
            controller.run(WHOLE_COMMIT)
            (_, image, settings), is_done = after_power_cut(driver, cut)
            outcomes.add((image, settings))
            assert image == OLDER.image() or not is_done
            other = started(driver)
            assert {image, other.read(p.PREVIOUS)} == {RAMP.image(), OLDER.image()}
            other.ok(p.ROLL_BACK)
            other.run(WHOLE_COMMIT)
            assert {image, other.read()} == {RAMP.image(), OLDER.image()}
            if is_done:
                break
        assert is_done
    assert outcomes == {(OLDER.image(), Settings(0, 1).packed()), (RAMP.image(), Settings().packed())}


def after_power_cut(driver: Driver, cut: int) -> tuple[tuple[int, bytes, bytes], bool]:
    """Switch on again; return sequence number, image and settings, and whether all was written before the cut."""
    is_done = int(driver.ask("writes")) < cut
    driver.ask("eeprom", driver.ask("eeprom"))
    controller = started(driver)
    return (controller.hello().sequence, controller.read(), controller.settings()), is_done


def test_a_write_that_fails_keeps_the_ramp(controller: Controller) -> None:
    controller.push(RAMP)
    writes = int(controller.driver.ask("writes"))
    controller.driver.ask("cut", writes + 20)
    controller.push(OTHER)
    status = controller.status()
    assert (status.state, status.write_failed, status.sequence) == (p.IDLE, True, 1)
    assert (controller.read(), controller.read(p.PREVIOUS)) == (RAMP.image(), b"")
    controller.driver.ask("cut", 0)
    controller.ok(p.COMMIT)
    controller.run(WHOLE_COMMIT)
    assert (controller.status().write_failed, controller.read()) == (False, OTHER.image())


def test_a_roll_back_that_fails_keeps_the_ramp(controller: Controller) -> None:
    controller.push(RAMP)
    controller.push(OTHER)
    writes = int(controller.driver.ask("writes"))
    controller.driver.ask("cut", writes + 2)
    controller.ok(p.ROLL_BACK)
    controller.run(WHOLE_COMMIT)
    status = controller.status()
    assert (status.state, status.write_failed, status.sequence) == (p.IDLE, True, 2)
    assert controller.read() == controller.read(p.RAM) == OTHER.image()
    assert status.crc == p.crc16(OTHER.image())


def test_a_previous_ramp_that_has_gone_bad_is_not_rolled_back_to(controller: Controller) -> None:
    """Its bytes change after the start, when it was still good."""
    controller.push(RAMP)
    controller.push(OTHER)
    content = bytearray.fromhex(controller.driver.ask("eeprom"))
    content[40] ^= 1
    controller.driver.ask("eeprom", content.hex())
    assert controller.refused(p.ROLL_BACK) == (p.NO_RAMP, 0)
    assert controller.read(p.RAM) == OTHER.image()
    controller.ok(p.MOVE_BY, for_axes({0: 1}))
