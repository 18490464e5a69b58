"""Microsteps that somebody else sets meanwhile, at a Tic and a TMCL module: no move goes another way than was shown."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import pytest

from controllers.bench import BoardBench, PlugIn, at, by, to
from controllers.conftest import Clock
from controllers.tic.bench import Bench as TicBench
from controllers.tmcl.bench import Bench as TmclBench
from controllers.tmcl.emulator import RESOLUTION, TmclEmulator
from designs import design
from stepramp.controllers.contract import Controller
from stepramp.controllers.tic import conversation as tic_conversation
from stepramp.controllers.tmcl import conversation as tmcl_conversation
from stepramp.errors import Refused, Rescaled

ANSWER_S = 0.03
HAS_MOVED = 400
"""A Tic ends a run by itself once nobody asks [steps]."""


class Board:
    """A board of either kind. set_mode: has it make so many of a full step, as a power of 2."""

    def __init__(self, bench: BoardBench[Any], set_mode: Callable[[int], None], place: Callable[[], int]) -> None:
        self.bench, self.set_mode, self.place = bench, set_mode, place
        self.controller: Controller = bench.controller

    def told(self) -> tuple[int, int | None]:
        axis = self.controller.status().axes[0]
        return axis.position_steps, axis.microsteps


@pytest.fixture(params=["tic", "tmcl"])
def board(
    request: pytest.FixtureRequest, clock: Clock, plug_in: PlugIn, monkeypatch: pytest.MonkeyPatch
) -> Iterator[Board]:
    monkeypatch.setattr(tic_conversation, "ANSWER_S", ANSWER_S)
    monkeypatch.setattr(tmcl_conversation, "ANSWER_S", ANSWER_S)
    bench: TicBench | TmclBench
    if request.param == "tic":
        bench = TicBench(clock, plug_in)
        tic = bench.tic
        made = Board(bench, lambda power: setattr(tic, "step_mode", power), lambda: tic.position)
    else:
        bench = TmclBench(clock, plug_in, TmclEmulator(clock))
        module = bench.module
        motor = module.motors[0]
        made = Board(bench, lambda power: motor.settings.__setitem__(RESOLUTION, power), lambda: module.chip.position)
    made.set_mode(3)
    bench.controller.connect()
    bench.controller.prepare_push([design()], 0, "try")()
    yield made
    bench.port.close()


BEGUN: dict[str, Callable[[Controller], None]] = {
    "by": lambda controller: controller.move_by(by(800)),
    "to": lambda controller: controller.move_to(to(800)),
    "run": lambda controller: controller.run(at(500)),
    "position": lambda controller: controller.set_position(to(800)),
}


def test_a_status_tells_them(board: Board) -> None:
    assert board.told() == (0, 8)
    board.set_mode(5)
    assert board.told() == (0, 32)
    assert board.controller.status().trouble is None, "0 is the same place with any"


@pytest.mark.parametrize("is_seen", [False, True], ids=["asked at once", "a status looked before"])
@pytest.mark.parametrize("begin", BEGUN)
def test_what_was_asked_for_with_others_is_refused_once(board: Board, begin: str, is_seen: bool) -> None:
    board.told()
    board.set_mode(4)
    if is_seen:
        assert board.told() == (0, 16)
    words = (
        r"makes 16 steps of a full step by now, and made 8 \(.*\): it was changed meanwhile\. Nothing was moved: ask"
    )
    with pytest.raises(Refused, match=words):
        BEGUN[begin](board.controller)
    board.bench.pass_time(2)
    assert board.place() == 0
    assert board.told() == (0, 16)
    BEGUN[begin](board.controller)
    board.bench.pass_time(5)
    assert board.place() >= HAS_MOVED


@pytest.mark.parametrize("is_seen", [False, True], ids=["asked at once", "looked at before"])
@pytest.mark.parametrize("begin", ["by", "to", "run"])
def test_where_it_is_is_to_be_said_once_it_counts_by_others(board: Board, begin: str, is_seen: bool) -> None:
    board.controller.move_by(by(400))
    board.bench.rest()
    board.set_mode(4)
    if is_seen:
        board.told()
    for _ in range(2):
        with pytest.raises(Refused):
            BEGUN[begin](board.controller)
    status = board.controller.status()
    assert "makes 16 steps of a full step by now, and has counted with 8" in (status.trouble or "")
    assert "Set the position here." in (status.trouble or "")
    board.bench.pass_time(2)
    assert board.place() == 400
    board.controller.set_position(to(0))
    assert board.controller.status().trouble is None
    BEGUN[begin](board.controller)
    board.bench.pass_time(5)
    assert board.place() >= HAS_MOVED


@pytest.mark.parametrize("board", ["tic"], indirect=True)
def test_zero_goes_no_way_that_was_made_steps_by_others(board: Board) -> None:
    board.controller.move_by(by(400))
    board.bench.rest()
    board.set_mode(4)
    assert "Set the position here." in (board.controller.status().trouble or "")
    with pytest.raises(Rescaled, match="it was changed meanwhile"):
        board.bench.controller.zero([0], 400)
    board.bench.pass_time(2)
    assert board.place() == 400
    # Asked for again it says itself where the motor is.
    board.bench.controller.zero([0], 800)
    assert board.bench.rest().axes[0].position_steps == board.place() == 0
    assert board.controller.status().trouble is None


def test_one_step_is_told_as_one(board: Board) -> None:
    board.set_mode(0)
    with pytest.raises(Refused, match=r"makes 1 step of a full step by now, and made 8 "):
        board.controller.move_by(by(400))
    report = board.controller.prepare_push([design(axis__microsteps=8)], 0, "try")()
    assert any("The design has 8 steps a full step, the" in words for words in report.warnings)
    board.set_mode(3)
    report = board.controller.prepare_push([design(axis__microsteps=1)], 0, "try")()
    assert any("The design has 1 step a full step, the" in words for words in report.warnings)


def test_a_run_at_no_speed_stops_whatever_was_changed(board: Board) -> None:
    board.controller.run(at(500))
    board.bench.pass_time(0.5)
    board.set_mode(4)
    board.controller.run(at(0))
    place = board.bench.rest().axes[0].position_steps
    board.bench.pass_time(2)
    assert board.place() == place


def test_set_back_it_is_where_it_counts(board: Board) -> None:
    board.controller.move_by(by(400))
    board.bench.rest()
    board.set_mode(4)
    board.told()
    board.set_mode(3)
    assert board.told() == (400, 8)
    assert board.controller.status().trouble is None
    board.controller.move_by(by(400))
    assert board.bench.rest().axes[0].position_steps == 800


def test_a_push_tells_those_that_it_has_by_then(board: Board) -> None:
    send = board.controller.prepare_push([design(axis__microsteps=8)], 0, "try")
    board.set_mode(4)
    assert any("The design has 8 steps a full step, the" in words for words in send().warnings)


def test_of_two_axes_none_moves_when_one_has_others(
    clock: Clock, plug_in: PlugIn, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(tmcl_conversation, "ANSWER_S", ANSWER_S)
    bench = TmclBench(clock, plug_in, TmclEmulator(clock, number=6212, axes=6))
    bench.controller.connect()
    bench.controller.prepare_push([design(), design()], None, "try")()
    bench.module.motors[1].settings[RESOLUTION] = 5
    for ask in (bench.controller.move_by, bench.controller.run):
        bench.module.commands.clear()
        with pytest.raises(Refused, match=r"Axis 1 makes .* steps of a full step by now"):
            ask([*at(100), *at(100, 1)])
        assert not bench.told()
        bench.module.motors[1].settings[RESOLUTION] += 1
    bench.port.close()


def test_a_module_is_asked_for_one_axis_each_time(
    clock: Clock, plug_in: PlugIn, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(tmcl_conversation, "ANSWER_S", ANSWER_S)
    bench = TmclBench(clock, plug_in, TmclEmulator(clock, number=6212, axes=6))
    bench.controller.connect()
    for motor, resolution in enumerate((4, 5, 6)):
        bench.module.motors[motor].settings[RESOLUTION] = resolution
    bench.module.commands.clear()
    for _ in bench.controller.status().axes:
        status = bench.controller.status()
    assert [axis.microsteps for axis in status.axes][:3] == [16, 32, 64]
    asked = [command for command in bench.module.commands if command[1] == RESOLUTION]
    assert len(asked) == len(status.axes) + 1
    # Something that no module has is no reason to lose it, nor does it move by that.
    bench.module.motors[0].settings[RESOLUTION] = 77
    assert [bench.controller.status().axes[0].microsteps for _ in status.axes] == [16] * len(status.axes)
    with pytest.raises(Refused, match="microstep resolution 77"):
        bench.controller.move_by(by(100))
    bench.port.close()
