import struct

import pytest

from firmware import protocol as p
from firmware.controller.client import BYTE_US, SESSION, Controller, timed_messages
from firmware.controller.ramps import TWO_AXES
from firmware.protocol import Ramp, encode_frame, for_axes

LONGEST_WAIT = 4
"""Rounds until a frame that is going out has been cut, and the next one begins."""


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
