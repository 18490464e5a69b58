"""A Tic at the end of a line that loses bytes, damages them, or delivers them late."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from controllers.bench import at, by, to
from controllers.slow_line import SlowLine
from controllers.tic.bench import Bench
from controllers.tic.damage import flipping, losing
from controllers.tic.emulator import READ, VELOCITY, TicEmulator
from designs import design
from stepramp.controllers.tic import conversation
from stepramp.controllers.tic.controller import TicController
from stepramp.controllers.tic.variables import TARGET_VELOCITY, UP_TIME
from stepramp.errors import DeviceLost, Refused
from stepramp.link import hearing

ANSWER_S = 0.2
TRAVEL_S = 0.01

DAMAGED = "is its serial line disturbed"


@pytest.mark.parametrize("lost", range(30))
def test_a_push_gets_through_though_a_byte_is_lost(bench: Bench, lost: int) -> None:
    bench.controller.connect()
    push = bench.controller.prepare_push([design()], 0, "try")
    bench.tic.on_the_way_in = losing(lost)
    assert push().verified
    assert bench.tic.ramp == [0, 10_000_000, 500_000, 500_000]


@pytest.mark.parametrize("way", ["on_the_way_in", "on_the_way_out"])
@pytest.mark.parametrize("lost", range(0, 90, 3))
def test_a_move_gets_through_though_a_byte_is_lost_or_says_why_not(
    bench: Bench, controller: TicController, way: str, lost: int
) -> None:
    """A Tic that moves and misses a byte slows down: that can't be helped."""
    setattr(bench.tic, way, losing(lost))
    controller.move_by(by(700))
    status = bench.rest()
    assert status.axes[0].position_steps == bench.tic.position
    if bench.tic.position != 700:
        assert way == "on_the_way_in"
        assert status.trouble is not None
        assert "bytes on its serial line were damaged or lost (serial error)" in status.trouble


@pytest.mark.parametrize("bit", range(7))
@pytest.mark.parametrize("byte", range(1, 6))
def test_a_target_that_arrives_damaged_is_never_set_out_for(
    bench: Bench, controller: TicController, byte: int, bit: int
) -> None:
    bench.lasts_s = 0.02

    def flip(data: bytes) -> bytes:
        if data[0] == 0xE0:
            bench.tic.on_the_way_in = lambda data: data
            return flipping(byte, bit)(data)
        return data

    bench.tic.on_the_way_in = flip
    controller.move_to(to(300))
    assert bench.rest().axes[0].position_steps == 300
    assert (min(bench.way), max(bench.way)) == (0, 300)


def test_noise_before_between_and_in_answers(bench: Bench) -> None:
    noise = iter(range(10**6))

    def add(data: bytes) -> bytes:
        # Every fifth answer comes with a byte that nobody sent.
        return data[:2] + b"\xa5" + data[2:] if next(noise) % 5 == 0 else data

    bench.tic.on_the_way_out = add
    bench.controller.connect()
    bench.controller.prepare_push([design()], 0, "try")()
    bench.controller.move_by(by(321))
    assert bench.rest().axes[0].position_steps == 321


@pytest.mark.parametrize("bit", [0, 6])
@pytest.mark.parametrize("place", range(0, 150, 2))
def test_a_move_counts_from_where_the_motor_is_though_an_answer_was_damaged(
    bench: Bench, controller: TicController, place: int, bit: int
) -> None:
    controller.set_position(to(5000))
    bench.tic.on_the_way_out = flipping(place, bit)
    refused = False
    try:
        controller.move_by(by(70))
    except (Refused, DeviceLost):
        refused = True
    bench.tic.on_the_way_out = lambda data: data
    bench.pass_time(2)
    assert bench.tic.position == (5000 if refused else 5070)


@pytest.mark.parametrize("late_s", [0.1, 0.195, 0.2, 0.25, 0.39, 0.45, 0.6, 0.75])
def test_an_answer_that_comes_late_is_not_taken_for_the_next_one(
    monkeypatch: pytest.MonkeyPatch, late_s: float
) -> None:
    """Those of target velocity and up time are of the same length."""
    line = SlowLine(TicEmulator, TRAVEL_S)
    line.board.has_been_up(60)
    monkeypatch.setattr(conversation, "ANSWER_S", ANSWER_S)
    monkeypatch.setattr(hearing, "monotonic", lambda: line.now_s)
    talk = conversation.Conversation(line, lambda _: None)
    talk.begin()
    line.answers_after_s = iter([late_s])
    (target_velocity,), (up_time_ms,) = talk.read(TARGET_VELOCITY), talk.read(UP_TIME)
    assert target_velocity == 0
    assert 60_000 <= up_time_ms <= 60_000 + line.now_s * 1000


def test_crcs_of_answers_are_checked(bench: Bench) -> None:
    bench.tic.crc_for_commands = bench.tic.crc_for_responses = True
    bench.controller.connect()
    answers = iter(range(10**6))
    bench.tic.on_the_way_out = lambda data: flipping(3, 5)(data) if next(answers) % 3 == 0 else data
    bench.controller.prepare_push([design()], 0, "try")()
    bench.controller.move_by(by(321))
    assert bench.rest().axes[0].position_steps == 321


@pytest.mark.parametrize(
    ("in_the_way", "words"),
    [
        (lambda _: b"", "does not answer"),
        (lambda data: data[:-1], "does not answer"),
        (lambda data: b"\x05" + data[1:], "answers without sense"),
    ],
)
def test_a_tic_that_falls_silent_or_talks_nonsense_is_lost(
    bench: Bench, controller: TicController, in_the_way: Callable[[bytes], bytes], words: str
) -> None:
    bench.tic.on_the_way_out = in_the_way
    with pytest.raises(DeviceLost, match=words):
        controller.status()


def test_a_disturbed_line_is_told(bench: Bench, controller: TicController) -> None:
    bench.tic.on_the_way_in = lambda data: data if data[0] in READ else b""
    for ask in (
        controller.prepare_push([design(ramp__slew_speed_steps_per_s=20)], 0, "try"),
        lambda: controller.set_position(to(5)),
        lambda: controller.move_to(to(5)),
        lambda: controller.run(at(5)),
    ):
        with pytest.raises(Refused, match=DAMAGED):
            ask()


@pytest.mark.parametrize("target", [0xE0, 0xE3])
@pytest.mark.parametrize("place", [0, 6, 12, 18])
def test_a_command_of_a_ramp_that_arrives_as_that_of_a_motion_is_taken_back(
    bench: Bench, controller: TicController, target: int, place: int
) -> None:
    controller.move_by(by(10))
    bench.rest()

    def damage(data: bytes) -> bytes:
        if data[0] != 0xE5:
            return data
        bench.tic.on_the_way_in = lambda data: data
        return data[:place] + bytes([target]) + data[place + 1 :]

    push = controller.prepare_push([design(ramp__base_speed_steps_per_s=20)], 0, "try")
    bench.tic.on_the_way_in = damage
    with pytest.raises(Refused, match=r"^A damaged command has set the motor moving, and it was stopped: "):
        push()
    bench.pass_time(2)
    assert bench.tic.told == (VELOCITY, 0)
    assert bench.tic.velocity == 0
    assert abs(bench.tic.position - 10) < 50
    assert push().verified
