import random

from firmware import protocol as p
from firmware.controller.client import Controller
from firmware.controller.ramps import RAMP
from firmware.protocol import encode_frame, for_axes


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
