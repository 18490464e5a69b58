"""Noise, damaged and doubled frames on the serial line of the simulated chip while motors move."""

import random
import struct
import time
from collections.abc import Callable

import pytest

from firmware.checker import lateness_us
from firmware.protocol import DATA, HALT, HELLO, MOVE_BY, MOVING, STATUS, STOP, Client, encode_frame, for_axes
from firmware.rig import BusyClient, Make, RampDesign, image, play
from simulator.avr import CLOCK_HZ

FAST = RampDesign(130_000, 6_000_000, 6_000_000)
FOUR = RampDesign(28_000, 600_000, 600_000)
STEPS = 30_000
LATE_US, LATE_OF_FOUR_US = 5.0, 50.0
ANSWER_WITHIN_S = 0.100


def noise(_: Client) -> bytes:
    return random.Random(1).randbytes(1500)


def zeros(_: Client) -> bytes:
    return bytes(1500)


def ones(_: Client) -> bytes:
    return b"\xff" * 1500


def truncated(_: Client) -> bytes:
    whole = encode_frame(struct.pack("<BHB", DATA, 0x1234, 2) + bytes(range(1, 49)))
    return b"".join(whole[:count] + b"\0" for count in range(1, len(whole) - 1))


def damaged(_: Client) -> bytes:
    whole = encode_frame(struct.pack("<BHB", HALT, 0x1234, 99))
    return b"".join(
        bytes(byte ^ (i == at) << bit for i, byte in enumerate(whole)) for at in range(8) for bit in range(8)
    )


def too_long(_: Client) -> bytes:
    return (b"\x05full" * 40 + b"\0") * 6


def of_another_session(_: Client) -> bytes:
    moves = (struct.pack("<BHB", MOVE_BY, 0x4321, tag) + for_axes({0: 9}) for tag in range(60))
    return b"".join(map(encode_frame, moves))


def doubled(_: Client) -> bytes:
    """The request that has begun the move: a repeat, so it is answered and does nothing."""
    return REPEATED * 40


REPEATED = encode_frame(struct.pack("<BHB", MOVE_BY, 0x1234, 200) + for_axes({0: STEPS}))


@pytest.mark.parametrize("what", [noise, zeros, ones, truncated, damaged, too_long, of_another_session, doubled])
def test_the_motor_takes_no_notice(simulated_controller: Make, what: Callable[[Client], bytes]) -> None:
    """Each step comes as planned; and once the line is quiet, requests are answered."""

    def work(client: BusyClient) -> None:
        client.send_raw(REPEATED)
        client.take(0.5)
        client.send_raw(what(client))
        time.sleep(0.3)
        client.forget()
        assert client.hello_until_answered().version == 2

    played = play(simulated_controller, image([FAST]), work)
    played.assert_nothing_lost()
    assert played.statuses[0].position == STEPS
    assert lateness_us(played.steps(), FAST.ramp.intervals(STEPS), 1).max() <= LATE_US


def test_four_axes_in_a_flood(simulated_controller: Make) -> None:
    """The line carries noise without a pause, from before the start until after the end."""

    def work(client: BusyClient) -> None:
        client.expect_ok(MOVE_BY, for_axes(dict.fromkeys(range(4), 8000)))
        client.send_raw(random.Random(2).randbytes(6000))
        time.sleep(1)
        client.forget()
        client.hello_until_answered()

    played = play(simulated_controller, image([FOUR] * 4), work)
    played.assert_nothing_lost()
    for axis in range(4):
        assert lateness_us(played.steps(axis), FOUR.ramp.intervals(8000), 1).max() <= LATE_OF_FOUR_US


def test_everything_is_answered_in_time(simulated_controller: Make, record_property: Callable[..., None]) -> None:
    """On a quiet line, at full load, whatever is asked."""

    def work(client: BusyClient) -> None:
        client.expect_ok(MOVE_BY, for_axes({0: 1_000_000}))
        for kind in range(0x40):
            if kind not in (STOP, HALT, HELLO):
                assert client.request(kind)[0] in range(13)
        assert client.request(DATA, b"\0\0\1")[0] == MOVING
        assert client.request(STATUS, b"\0")[0] == 0
        client.expect_ok(HALT)

    played = play(simulated_controller, image([FAST]), work)
    longest_s = played.statistics["longest_answer_cycles"] / CLOCK_HZ
    record_property("longest_answer_ms", 1e3 * longest_s)
    assert longest_s + 60 * 2 * 10 / 115_200 < ANSWER_WITHIN_S
    assert played.statistics["lost_bytes"] == 0
