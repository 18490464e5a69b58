import struct

import pytest

from firmware import protocol as p
from firmware.controller.client import SESSION, Controller
from firmware.controller.lengths import FOR_AXES, LENGTHS
from firmware.controller.limits import LIMITS
from firmware.controller.ramps import RAMP, TWO_AXES
from firmware.controller_host import Driver
from firmware.protocol import Hello, for_axes


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
    assert controller.refused(p.HELLO, b"\1") == (p.VERSION, 3)
    assert controller.refused(p.HELLO, b"\4") == (p.VERSION, 3)
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
    assert controller.refused(p.HELLO, b"\1", tag=0) == (p.VERSION, 3)
