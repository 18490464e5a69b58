"""What becomes of commands and answers on a line that loses and damages them."""

from __future__ import annotations

import random

import pytest

from controllers.bench import at, by, to
from controllers.tic.damage import flipping, losing
from controllers.tmcl.bench import Bench
from controllers.tmcl.emulator import FACTORY
from designs import design
from stepramp.controllers.tmcl.controller import TmclController
from stepramp.errors import DeviceLost

OTHERS = bytes.fromhex("02 05 64 06 00 00 00 07 78")
"""What a module with another address says on the same line."""


@pytest.mark.parametrize("damage", [losing, lambda place: flipping(place, 6)], ids=["lost", "damaged"])
@pytest.mark.parametrize("way", ["on_the_way_in", "on_the_way_out"])
@pytest.mark.parametrize("place", range(0, 60, 7))
def test_a_move_arrives_as_it_was_asked(
    bench: Bench, controller: TmclController, way: str, damage: object, place: int
) -> None:
    setattr(bench.module, way, damage(place))
    controller.move_to(to(300))
    assert bench.rest().axes[0].position_steps == bench.module.chip.position == 300
    assert bench.module.chip.steps == 300


@pytest.mark.parametrize("way", ["on_the_way_in", "on_the_way_out"])
@pytest.mark.parametrize("place", range(0, 300, 23))
def test_a_push_arrives_whole(bench: Bench, way: str, place: int) -> None:
    bench.controller.connect()
    setattr(bench.module, way, losing(place))
    report = bench.controller.prepare_push([design()], 0, "keep")()
    assert (report.verified, report.kept) == (True, True)
    stored = {number: bench.module.motors[0].stored[number] for number in FACTORY}
    assert stored == {4: 1048, 5: 42, 17: 42, 19: 0, 20: 10, 15: 42, 16: 0, 18: 42}


def test_a_converter_that_hears_itself_and_others_on_the_line(bench: Bench) -> None:
    bench.module.echoes, bench.module.answers_before = True, OTHERS
    bench.controller.connect()
    bench.controller.prepare_push([design()], 0, "keep")()
    bench.controller.run(at(500))
    bench.pass_time(0.3)
    bench.controller.stop()
    bench.rest()
    bench.controller.move_to(to(20))
    assert bench.rest().axes[0].position_steps == 20


def test_what_is_lost_at_random_is_made_up_for(bench: Bench, controller: TmclController) -> None:
    """One exchange in twelve, either way, byte by byte."""
    chance = random.Random(7)

    def spoil(data: bytes) -> bytes:
        if chance.random() > 1 / 12:
            return data
        place = chance.randrange(len(data))
        return data[:place] + data[place + 1 :] if chance.random() < 0.5 else data[:place] + b"\xff" + data[place + 1 :]

    bench.module.on_the_way_in = bench.module.on_the_way_out = spoil
    for target in (120, -40):
        controller.move_to(to(target))
        assert bench.rest().axes[0].position_steps == bench.module.chip.position == target


def test_a_module_that_falls_silent_is_lost(bench: Bench, controller: TmclController) -> None:
    bench.module.is_dead = True
    for ask in (controller.status, lambda: controller.move_by(by(5)), controller.stop):
        with pytest.raises(DeviceLost, match="does not answer"):
            ask()
