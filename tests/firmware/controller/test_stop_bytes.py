"""A stop, or a halt, of a byte twice, in place of a frame."""

import struct

import pytest

from firmware import protocol as p
from firmware.controller.client import Controller, messages_of
from firmware.controller.ramps import FOUR_AXES
from firmware.controller_host import Driver
from firmware.protocol import Ramp, for_axes

SLOW = Ramp([(60_000, 300, -190)], 3000, [(60_000, 300, -190)])
STOP_BYTE, HALT_BYTE = b"\xff\xff\0", b"\xfe\xfe\0"
REPLIES = {
    STOP_BYTE: struct.pack("<BHBB", p.STOP | 0x80, 0, 0, p.OK),
    HALT_BYTE: struct.pack("<BHBB", p.HALT | 0x80, 0, 0, p.OK),
}


@pytest.mark.parametrize("byte", REPLIES)
def test_before_anything_else_was_said(driver: Driver, byte: bytes) -> None:
    driver.ask("begin")
    assert messages_of(driver.send(byte)) == [REPLIES[byte]]
    assert messages_of(driver.send(b"\0" + byte)) == [REPLIES[byte]]


def test_a_stop_slows_all_axes_down_and_a_halt_ends_all(controller: Controller) -> None:
    controller.push(SLOW.image(4))
    for byte, reply in REPLIES.items():
        controller.ok(p.RUN, for_axes(dict.fromkeys(range(4), 3000)))
        controller.run(9000)
        assert controller.replies_to(byte) == [reply]
        assert controller.status().axis_state == (p.STOPPING if byte == STOP_BYTE else p.IDLE)
        there = controller.steps()
        assert controller.run_until_idle().state == p.IDLE
        assert [now != before for now, before in zip(controller.steps(), there, strict=True)] == [byte == STOP_BYTE] * 4
        assert [controller.status(axis).position for axis in range(4)] == controller.steps()


@pytest.mark.parametrize("byte", REPLIES)
def test_after_half_a_frame_and_a_zero_and_before_a_whole_one(controller: Controller, byte: bytes) -> None:
    half = controller.frame(p.STATUS, b"\0")[:-3]
    whole = controller.frame(p.STATUS, b"\0")
    replies = controller.replies_to(half + b"\0" + byte + whole)
    assert [reply[0] for reply in replies] == [REPLIES[byte][0], p.STATUS | 0x80]


def test_within_a_frame_they_are_bytes_like_any_other(controller: Controller) -> None:
    controller.push(FOUR_AXES)
    controller.ok(p.RUN, for_axes({0: 1000}))
    controller.run(4000)
    # Positions of which all bytes are FF, or FE.
    controller.ok(p.MOVE_TO, for_axes({1: -1, 2: -0x01010102}))
    assert controller.status().axis_state == p.IN_MOTION
    body = b"\xff" * 48
    assert controller.frame(p.DATA, body)[1:].count(b"\xff") > 40
    assert controller.refused(p.DATA, body)[0] == p.MOVING


def test_what_waits_does_not_begin(controller: Controller) -> None:
    """A move right before the byte: either it was begun and is stopped, or it is dropped."""
    controller.push(FOUR_AXES)
    for byte in REPLIES:
        controller.driver.send(controller.frame(p.MOVE_BY, for_axes({0: 3000})) + byte)
        assert controller.run_until_idle().position < 3000


def test_what_only_looks_like_one_is_none(controller: Controller) -> None:
    """The beginning of a frame that was lost may look so."""
    for more in (b"\xff\0", b"\xfe\0", b"\xff\xfe\0", b"\xfe\xff\0", b"\xff\xff\xff\0", b"\xfd\xfd\0"):
        assert controller.replies_to(b"\0" + more) == []
    assert controller.status().state == p.IDLE
