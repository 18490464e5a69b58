"""A Marlin on a line that damages or swallows much of what is said either way: stops are final, ways are right."""

from __future__ import annotations

import random
import re
from collections.abc import Callable
from contextlib import suppress

import pytest

from controllers.bench import at, by
from controllers.marlin.bench import Bench
from designs import design
from stepramp.controllers.contract import AnswerUnknown
from stepramp.errors import DeviceLost, Refused

SHARE = 0.05
"""Of what is lost each way; as much again is damaged."""
TURNS = 20


class Line:
    """Damages pieces of what is said, by chance."""

    def __init__(self, bench: Bench, chance: random.Random) -> None:
        self._bench, self._chance = bench, chance

    def disturb(self) -> None:
        self._bench.marlin.on_the_way_in = self._damaged
        self._bench.marlin.on_the_way_out = lambda said: b"" if self._chance.random() < SHARE else said

    def leave_alone(self) -> None:
        self._bench.marlin.on_the_way_in = self._bench.marlin.on_the_way_out = lambda data: data

    def _damaged(self, data: bytes) -> bytes:
        hows: list[Callable[[bytes], bytes]] = [
            lambda _: b"",
            lambda _: b"",
            lambda sent: sent[: len(sent) // 2],
            lambda sent: sent[:-1],
            lambda sent: sent[:1] + b"\x7f" + sent[2:],
            lambda sent: sent + sent,
        ]
        return self._chance.choice(hows)(data) if self._chance.random() < 2 * SHARE else data


@pytest.mark.parametrize("seed", range(6))
def test_stops_are_final_and_ways_are_right_on_a_bad_line(bench: Bench, seed: int) -> None:
    chance, marlin = random.Random(seed), bench.marlin
    marlin.has_emergency_parser, marlin.says_ok_after_resend = seed % 2 == 0, seed % 3 == 0
    marlin.tells = chance.choice(["targets", "places", "places at rest"])
    bench.lasts_s = 0.001
    bench.controller.connect()
    line = Line(bench, chance)
    line.disturb()
    for turn in range(TURNS):
        before, steps = marlin.position[0], chance.choice([-1, 1]) * chance.randint(6, 20_000)
        stop_after = chance.randint(0, 300) if chance.random() < 0.5 else None
        try:
            if chance.random() < 0.3:
                bench.controller.run(at(steps / 4 if abs(steps) > 400 else 100))
                bench.ask_for(0.6)
                stopped(bench, (seed, turn))
            elif moved_until_stopped(bench, steps, stop_after):
                stays(bench, (seed, turn))
            else:
                status = bench.rest()
                assert not marlin._is_relative, (seed, turn)
                assert status.axes[0].position_steps == marlin.position[0] == before + steps, (seed, turn)
        except (DeviceLost, Refused):
            line.leave_alone()
            bench.pass_time(6)
            bench.port.close()
            bench.reopen()
            bench.controller.connect()
            line.disturb()


def moved_until_stopped(bench: Bench, steps: int, stop_after: int | None) -> bool:
    """Begin to move; return whether a stop came, once it had given way so often."""
    passed, was_stopped, is_inside = 0, False, False

    def interrupt() -> None:
        nonlocal passed, was_stopped, is_inside
        passed += not is_inside
        if is_inside or stop_after is None or passed != stop_after + 1:
            return
        is_inside = True
        bench.controller.stop()
        was_stopped = True
        assert not bench.marlin.is_moving
        is_inside = False

    bench.interrupt = interrupt
    try:
        with suppress(AnswerUnknown):
            bench.controller.move_by(by(steps))
    finally:
        bench.interrupt = lambda: None
    return was_stopped


def stopped(bench: Bench, where: object) -> None:
    bench.controller.stop()
    assert not bench.marlin.is_moving, where
    stays(bench, where)


def stays(bench: Bench, where: object) -> None:
    steps = bench.marlin.steps
    bench.pass_time(1.3)
    assert (bench.marlin.steps, bench.marlin.is_moving) == (steps, False), where
    bench.controller.status()
    assert not bench.marlin._is_relative, where


@pytest.mark.parametrize("has_parser", [False, True])
def test_a_number_that_has_lost_a_digit_has_no_line_carried_out_twice(bench: Bench, has_parser: bool) -> None:
    """The question after a way is damaged, and so is the number of the line that Marlin then asks for again."""
    bench.marlin.has_emergency_parser = has_parser
    bench.controller.connect()
    bench.controller.move_by(by(8000))
    bench.rest()
    lost: list[bytes] = []

    def way_in(said: bytes) -> bytes:
        if b"M119" not in said or lost:
            return said
        lost.append(said)
        return said.replace(b"M119", b"M11\x7f")

    def way_out(said: bytes) -> bytes:
        if b"Resend:" not in said or len(lost) != 1:
            return said
        lost.append(said)
        return re.sub(rb"Resend: (\d)\d+", rb"Resend: \1", said)

    bench.marlin.on_the_way_in, bench.marlin.on_the_way_out = way_in, way_out
    bench.marlin.lines.clear()
    bench.controller.move_by(by(800))
    status = bench.rest()
    assert len(lost) == 2
    assert [line for line in bench.marlin.lines if line.startswith("G1")] == ["G1 X10.00000 F60000"]
    assert status.axes[0].position_steps == bench.marlin.position[0] == 8800


def test_a_place_that_has_lost_a_letter_is_asked_again(bench: Bench) -> None:
    """It was taken for that of a machine whose motors aren't its axes, and the stop refused."""
    controller, marlin = bench.controller, bench.marlin
    controller.connect()
    controller.run(at(400))
    left = [1]

    def lose_a_letter(said: bytes) -> bytes:
        place = said.find(b" Y:", said.find(b"Count"))
        if b"Count" not in said or place < 0 or not left:
            return said
        left.pop()
        return said[: place + 1] + said[place + 2 :]

    marlin.on_the_way_out = lose_a_letter
    controller.stop()
    assert not left
    assert not marlin.is_moving


def test_one_that_loses_its_power_while_it_stores_is_not_waited_for_time_and_again(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Storing is given long; it was told four times, which took half a minute."""
    controller, marlin = bench.controller, bench.marlin
    controller.connect()
    told: list[bytes] = []
    write = bench.port.write

    def note(data: bytes) -> None:
        told.append(data)
        write(data)

    monkeypatch.setattr(bench.port, "write", note)
    marlin.dies_at_write = marlin.eeprom.writes + 1
    with pytest.raises(DeviceLost, match="does not answer"):
        controller.prepare_push([design()], 0)()
    assert sum(b"M500" in data for data in told) == 2
