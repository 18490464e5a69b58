"""How soon a stop is on its way to a module on a bad line, and what becomes of late answers: by the line's clock."""

from __future__ import annotations

from contextlib import suppress

import pytest

from controllers.slow_line import SlowLine, Urgent
from controllers.tmcl.emulator import MST, TmclEmulator
from stepramp.controllers.contract import AxisCommand
from stepramp.controllers.tmcl import conversation
from stepramp.controllers.tmcl.controller import TmclController
from stepramp.controllers.tmcl.conversation import Conversation
from stepramp.controllers.tmcl.wire import Command
from stepramp.errors import DeviceLost
from stepramp.link import hearing

ANSWER_S = 0.2
TRAVEL_S = 0.02
AT_ONCE_S = 0.06


@pytest.fixture
def line(monkeypatch: pytest.MonkeyPatch) -> SlowLine:
    line = SlowLine(TmclEmulator, TRAVEL_S)
    line.board.has_been_up(60)
    monkeypatch.setattr(conversation, "ANSWER_S", ANSWER_S)
    for module in (conversation, hearing):
        monkeypatch.setattr(module, "monotonic", lambda: line.now_s)
    return line


@pytest.fixture
def urgent(line: SlowLine) -> Urgent:
    return Urgent(line)


@pytest.fixture
def controller(line: SlowLine, urgent: Urgent) -> TmclController:
    """Return a client of a module that runs."""
    controller = TmclController(line, urgent.give_way)
    controller.connect()
    controller.run([AxisCommand(0, 150, "speed_steps_per_s")])
    line.sent.clear()
    return controller


@pytest.mark.parametrize("noise_every_s", [0.03, 0.15])
@pytest.mark.parametrize("stop", ["stop", "halt"])
@pytest.mark.parametrize("after_s", [0.01 + 0.07 * count for count in range(20)])
def test_a_stop_is_sent_at_once_though_noise_never_ends(
    line: SlowLine, urgent: Urgent, controller: TmclController, noise_every_s: float, stop: str, after_s: float
) -> None:
    line.noise_every_s = noise_every_s
    assert until_a_stop_is_sent(line, urgent, controller, stop, after_s) < AT_ONCE_S
    assert rests(line)


@pytest.mark.parametrize("stop", ["stop", "halt"])
@pytest.mark.parametrize("after_s", [0.01 + 0.07 * count for count in range(18)])
def test_a_stop_is_sent_at_once_though_no_answer_comes(
    line: SlowLine, urgent: Urgent, controller: TmclController, stop: str, after_s: float
) -> None:
    line.answers_are_lost = True
    assert until_a_stop_is_sent(line, urgent, controller, stop, after_s) < AT_ONCE_S
    assert rests(line)


def until_a_stop_is_sent(
    line: SlowLine, urgent: Urgent, controller: TmclController, stop: str, after_s: float
) -> float:
    """Return how long it takes from when it is asked for [s], amid questions; the module may be lost then."""
    asked_s = urgent.come(after_s, getattr(controller, stop))
    with suppress(DeviceLost):
        while line.now_s < asked_s:
            controller.status()
        urgent.give_way(0.0)
    return next(at_s for at_s, data in line.sent if data and data[1] == MST) - asked_s


def rests(line: SlowLine) -> bool:
    line.now_s += 3
    line.write(b"")
    return line.board.chip.speed == 0 and line.board.chip.vmax == 0


@pytest.mark.parametrize("late_s", [0.0, 0.1, 0.175, 0.19, 0.25, 0.3, 0.36])
@pytest.mark.parametrize("after_s", [0.0, 0.05, 0.1, 0.19, 0.21, 0.3])
def test_what_is_asked_in_between_is_not_answered_by_what_is_late(
    line: SlowLine, urgent: Urgent, late_s: float, after_s: float
) -> None:
    """Answers tell the command, but not which parameter."""
    talk, urgently = Conversation(line, urgent.give_way), []
    talk.begin()
    line.answers_after_s = iter([late_s])
    urgent.come(after_s, lambda: urgently.append(talk.ask(Command.GAP, 5)))
    assert talk.ask(Command.GAP, 140) == 8
    last = talk.ask(Command.GAP, 5)
    assert {last, *urgently} == {99_884}


def test_a_module_is_not_lost_though_each_of_its_answers_is_dropped_for_a_stop(line: SlowLine, urgent: Urgent) -> None:
    """More often than a question is repeated that is not answered."""
    talk = Conversation(line, urgent.give_way)
    talk.begin()
    left = 10

    def ask_in_between() -> None:
        nonlocal left
        left -= 1
        line.answers_after_s = iter([0.0, 0.15])
        talk.ask(Command.GAP, 5)
        if left:
            urgent.come(0.06, ask_in_between)

    line.answers_after_s = iter([0.15])
    urgent.come(0.06, ask_in_between)
    assert talk.ask(Command.GAP, 140) == 8
    assert left == 0
