"""How soon a stop is on its way to a Tic on a bad line, and what becomes of late answers: by the line's clock."""

from __future__ import annotations

from contextlib import suppress

import pytest

from controllers.slow_line import SlowLine, Urgent
from controllers.tic.emulator import HALTED, VELOCITY, TicEmulator
from stepramp.controllers.contract import AxisCommand
from stepramp.controllers.tic import conversation
from stepramp.controllers.tic.controller import TicController
from stepramp.controllers.tic.conversation import Conversation
from stepramp.controllers.tic.variables import TARGET_VELOCITY, UP_TIME
from stepramp.errors import DeviceLost
from stepramp.link import hearing

ANSWER_S = 0.2
TRAVEL_S = 0.01
AT_ONCE_S = 0.06
LOST_AFTER_S = 1.3
"""So long a Tic that answers no more is at least asked again [s]."""
MOST_INACCURATE_MS = 5
"""The emulator's time goes in steps."""
STOPS = (b"\xe3\0\0\0\0\0", b"\x89")


@pytest.fixture
def line(monkeypatch: pytest.MonkeyPatch) -> SlowLine:
    line = SlowLine(TicEmulator, TRAVEL_S)
    line.board.has_been_up(60)
    monkeypatch.setattr(conversation, "ANSWER_S", ANSWER_S)
    monkeypatch.setattr(hearing, "monotonic", lambda: line.now_s)
    return line


@pytest.fixture
def urgent(line: SlowLine) -> Urgent:
    return Urgent(line)


@pytest.fixture
def controller(line: SlowLine, urgent: Urgent) -> TicController:
    """Return a client of a Tic that runs."""
    controller = TicController(line, urgent.give_way)
    controller.connect()
    controller.run([AxisCommand(0, 150, "speed_steps_per_s")])
    return controller


@pytest.mark.parametrize("noise_every_s", [0.03, 0.15])
@pytest.mark.parametrize("stop", ["stop", "halt"])
@pytest.mark.parametrize("after_s", [0.01 + 0.07 * count for count in range(30)])
def test_a_stop_is_sent_at_once_though_noise_never_ends(
    line: SlowLine, urgent: Urgent, controller: TicController, noise_every_s: float, stop: str, after_s: float
) -> None:
    line.noise_every_s = noise_every_s
    assert until_a_stop_is_sent(line, urgent, controller, stop, after_s) < AT_ONCE_S
    rests_without_a_target(line)


@pytest.mark.parametrize("stop", ["stop", "halt"])
@pytest.mark.parametrize("after_s", [0.01 + 0.07 * count for count in range(int(LOST_AFTER_S / 0.07))])
def test_a_stop_is_sent_at_once_though_no_answer_comes(
    line: SlowLine, urgent: Urgent, controller: TicController, stop: str, after_s: float
) -> None:
    line.answers_are_lost = True
    assert until_a_stop_is_sent(line, urgent, controller, stop, after_s) < AT_ONCE_S
    rests_without_a_target(line)


def until_a_stop_is_sent(line: SlowLine, urgent: Urgent, controller: TicController, stop: str, after_s: float) -> float:
    """Return how long it takes from when it is asked for [s], in the midst of questions; the Tic may be lost then."""
    asked_s = urgent.come(after_s, getattr(controller, stop))
    with suppress(DeviceLost):
        while line.now_s < asked_s:
            controller.status()
        urgent.give_way(0.0)
    return next(at_s for at_s, data in line.sent if data in STOPS) - asked_s


def rests_without_a_target(line: SlowLine) -> None:
    line.now_s += 3
    line.write(b"")
    assert line.board.velocity == 0
    assert line.board.told in ((VELOCITY, 0), (HALTED, 0))


@pytest.mark.parametrize("late_s", [0.0, 0.1, 0.195, 0.2, 0.25, 0.3, 0.38])
@pytest.mark.parametrize("after_s", [0.0, 0.05, 0.1, 0.19, 0.21, 0.3])
def test_what_is_asked_in_between_is_not_answered_by_what_is_late(
    line: SlowLine, urgent: Urgent, late_s: float, after_s: float
) -> None:
    """Answers with target velocity and up time are of the same length."""
    talk, urgently = Conversation(line, urgent.give_way), []
    talk.begin()
    line.answers_after_s = iter([late_s])
    urgent.come(after_s, lambda: urgently.append(talk.read(UP_TIME)))
    least_ms = round((60 + line.now_s) * 1000) - MOST_INACCURATE_MS
    assert talk.read(TARGET_VELOCITY) == (0,)
    for (value,) in [*urgently, talk.read(UP_TIME)]:
        assert least_ms <= value < least_ms + 5000


def test_a_tic_is_not_lost_though_each_of_its_answers_is_dropped_for_a_stop(line: SlowLine, urgent: Urgent) -> None:
    """More often than a question is repeated that is not answered."""
    talk = Conversation(line, urgent.give_way)
    talk.begin()
    left = 10

    def ask_in_between() -> None:
        nonlocal left
        left -= 1
        line.answers_after_s = iter([0.0, 0.15])
        talk.read(UP_TIME)
        if left:
            urgent.come(0.06, ask_in_between)

    line.answers_after_s = iter([0.15])
    urgent.come(0.06, ask_in_between)
    assert talk.read(TARGET_VELOCITY) == (0,)
    assert left == 0


def test_the_line_of_these_tests(line: SlowLine) -> None:
    """A Tic on it goes on with its time."""
    assert isinstance(line.board, TicEmulator)
    line.now_s += 5
    line.write(bytes([0xA1, 0x35, 4]))
    assert int.from_bytes(line.read(1.0), "little") == pytest.approx(65_000, abs=MOST_INACCURATE_MS)
