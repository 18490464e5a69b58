"""An axis whose ramp is computed while it is played: whole moves, and what may happen on the way."""

import struct
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from firmware.host import Host, missing_compiler
from firmware.motion import OK, Machine, Report, build
from ramp.test_on_chip import METHODS, slopes
from stepramp.controllers.stepramp.formula_image import encode_formula
from stepramp.ramp.on_chip import OnChipRamp
from tools import require


@dataclass(frozen=True)
class Ramp:
    """Of v² / 2 a = index steps up to slew speed and index · a / d down."""

    method: str
    index: float
    ratio: float
    slew: float = 9000.0

    @property
    def on_chip(self) -> OnChipRamp:
        return OnChipRamp.of(*slopes(2e6, self.slew, 0, self.index, self.ratio), self.method)

    def move(self, steps: int) -> list[int]:
        found: list[int] = self.on_chip.move(steps).tolist()
        return found

    @property
    def image(self) -> bytes:
        return image_of_formula(self.on_chip, fast=False)


def image_of_formula(ramp: OnChipRamp, *, fast: bool) -> bytes:
    """Return the ramp image of one axis."""
    constants = encode_formula(ramp)
    return bytes([2, fast, 1, 1, 0, 1]) + struct.pack("<H", len(constants)) + constants


RAMPS = [Ramp(method, index, ratio) for method in METHODS for index, ratio in [(60.5, 1), (90.5, 0.3), (200.5, 3.5)]]
EASY = [Ramp(method, 150.5, ratio, 2000.0) for method in METHODS for ratio in (1, 0.4, 2.5)]


@pytest.fixture(scope="module")
def host(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Host]:
    require(*missing_compiler())
    with Host(build(tmp_path_factory.mktemp("formula_moves"))) as running:
        yield running


def played(machine: Machine) -> tuple[list[int], Report]:
    """Let the motor come to rest; return its intervals and the report."""
    machine.rest()
    intervals, report = machine.steps().intervals, machine.report()
    assert report.starved == 0
    return intervals, report


def within_ramp(intervals: Sequence[int], ramp: Ramp) -> bool:
    return all(ramp.on_chip.slew_interval <= interval <= ramp.on_chip.creep_interval for interval in intervals)


@pytest.mark.parametrize("ramp", RAMPS, ids=str)
def test_moves_from_rest_are_those_of_the_definition(host: Host, ramp: Ramp) -> None:
    whole = ramp.on_chip.up.steps + ramp.on_chip.down.steps
    for steps in (1, 2, 3, 7, whole // 3, whole - 1, whole, whole + 1, whole + 500):
        machine = Machine(host, ramp.image)
        assert machine.move(-steps) == (OK, 0)
        intervals, report = played(machine)
        assert report.position == -steps
        assert intervals == ramp.move(steps)[:-1]


@given(ramp=st.sampled_from(RAMPS), steps=st.integers(1, 1500), round_ticks=st.sampled_from([20, 100, 150]))
@settings(max_examples=60)
def test_any_move_is_that_of_the_definition(host: Host, ramp: Ramp, steps: int, round_ticks: int) -> None:
    machine = Machine(host, ramp.image, round_ticks=round_ticks)
    machine.move(steps)
    intervals, report = played(machine)
    assert (intervals, report.position) == (ramp.move(steps)[:-1], steps)


@pytest.mark.parametrize(("speed", "ratio"), [(50, 1), (120, 1), (80, 2)])
def test_steps_that_are_held_for_long_are_held_so_long(host: Host, speed: float, ratio: float) -> None:
    """A run at 50 steps/s of a ramp whose first interval is 22 ms: each of its intervals is waited for as a whole."""
    ramp = OnChipRamp.of(*slopes(16e6, 1000, 0, 500, ratio), "newton")
    machine = Machine(host, image_of_formula(ramp, fast=True), round_ticks=4000)
    wanted = round(16e6 / speed)
    machine.ask("run", 1, wanted)
    machine.do("wait", 20 * wanted)
    machine.do("halt", 1)
    intervals = machine.steps().intervals
    first_faster = next(i for i, interval in enumerate(ramp.move(1000)) if interval < wanted)
    assert intervals[first_faster:] == [wanted] * (len(intervals) - first_faster)
    assert len(intervals) >= 15


def test_a_short_move_that_creeps_keeps_its_intervals(host: Host) -> None:
    """Two steps, each followed by the longest interval: there is no room to go up."""
    ramp = OnChipRamp.of(*slopes(16e6, 1000, 0, 500, 0.5), "newton")
    for steps in (2, 3, 5):
        machine = Machine(host, image_of_formula(ramp, fast=True), round_ticks=4000)
        machine.move(steps)
        machine.rest()
        assert machine.steps().intervals == ramp.move(steps).tolist()[:-1]


def test_a_short_move_creeps_whatever_was_played_before(host: Host) -> None:
    ramp = OnChipRamp.of(*slopes(16e6, 1000, 0, 500, 0.5), "newton")
    machine = Machine(host, image_of_formula(ramp, fast=True), round_ticks=4000)
    machine.move(900)
    machine.rest()
    machine.steps()
    machine.move(902)
    machine.rest()
    assert machine.steps().intervals == ramp.move(2).tolist()[:-1]


@pytest.mark.parametrize("ramp", [ramp for ramp in EASY if ramp.ratio <= 1], ids=str)
@pytest.mark.parametrize("after", [100, 120])
def test_a_run_that_is_slowed_down_while_it_rises_goes_down_the_ramp(host: Host, ramp: Ramp, after: int) -> None:
    """To a third of the speed: no interval is longer than the one before by more than on the way to rest."""
    whole = ramp.move(10_000)
    wanted = 3 * whole[after]
    machine = Machine(host, ramp.image)
    machine.ask("run", 1, ramp.on_chip.slew_interval)
    machine.do("wait", 1000 + sum(whole[:after]))
    machine.ask("run", 1, wanted)
    machine.do("wait", 300 * wanted)
    machine.do("halt", 1)
    intervals = machine.steps().intervals
    assert intervals[-30:] == [wanted] * 30
    down = intervals[intervals.index(min(intervals)) : intervals.index(wanted)]
    assert len(down) > 5
    growth = max(b / a for a, b in pairwise(whole[-ramp.on_chip.down.steps :]) if b <= wanted)
    assert all(b <= 1.05 * growth * a for a, b in pairwise(down))


@pytest.mark.parametrize("ramp", EASY, ids=str)
def test_a_run_keeps_pace_where_a_round_takes_longer_than_a_step(host: Host, ramp: Ramp) -> None:
    """Up to a speed below slew speed, and down to a lower one: several intervals are computed at a time."""
    machine = Machine(host, ramp.image, round_ticks=2000)
    before = machine.report().starved
    for wanted in (1200, 6000, 1500):
        machine.ask("run", 1, wanted)
        machine.do("wait", 2_000_000)
        assert machine.report().interval == wanted
    assert machine.report().starved == before
    machine.do("halt", 1)


def changes_of_direction(intervals: Sequence[int]) -> int:
    """Return how often a run of intervals begins to rise or to fall."""
    signs = [(b > a) - (b < a) for a, b in pairwise(intervals) if a != b]
    return sum(a != b for a, b in pairwise(signs))


targets = st.lists(st.tuples(st.integers(0, 200_000), st.integers(-900, 900)), min_size=1, max_size=4)


@given(ramp=st.sampled_from(EASY), retargets=targets)
@settings(max_examples=100)
def test_retargets(host: Host, ramp: Ramp, retargets: list[tuple[int, int]]) -> None:
    """It comes to rest exactly there, and never goes faster than the ramp, nor back and forth in speed by itself."""
    machine = Machine(host, ramp.image)
    machine.move(400)
    for wait, target in retargets:
        machine.do("wait", wait)
        assert machine.move(target) == (OK, 0)
    machine.rest()
    made = machine.steps()
    assert made.travel == machine.report().position == retargets[-1][1]
    assert machine.report().starved == 0
    creep = ramp.on_chip.creep_interval
    for run in made.runs(creep):
        assert within_ramp(run, ramp)
        # Up and down once, and once more for each new target. Newton's method needs a step or two to settle.
        turns = changes_of_direction(run)
        assert turns <= 1 + 2 * len(retargets) + (4 * len(retargets) if ramp.method == "newton" else 0)


@pytest.mark.parametrize("ramp", EASY, ids=str)
def test_a_target_further_on_makes_it_rise_again(host: Host, ramp: Ramp) -> None:
    machine = Machine(host, ramp.image)
    machine.move(150)
    machine.do("wait", 60_000 + sum(ramp.move(150)[:110]))
    machine.move(1500)
    intervals, report = played(machine)
    assert report.position == 1500
    assert within_ramp(intervals, ramp)
    assert min(intervals) == ramp.on_chip.slew_interval
    assert min(intervals[:140]) > ramp.on_chip.slew_interval


@given(ramp=st.sampled_from(EASY), wait=st.integers(0, 600_000))
@settings(max_examples=60)
def test_stop(host: Host, ramp: Ramp, wait: int) -> None:
    """The ramp down from wherever it is: no longer than the whole one."""
    machine = Machine(host, ramp.image)
    machine.move(100_000)
    machine.do("wait", wait)
    made = machine.report().position
    machine.do("stop", 1)
    target = machine.report().target
    intervals, report = played(machine)
    assert report.position == target
    assert report.position == len(intervals) + 1 if intervals else report.position <= 1
    # What is queued, and a batch, come before the ramp down.
    assert report.position - made <= ramp.on_chip.down.steps + 80
    assert within_ramp(intervals, ramp)
    # By Newton's method the second interval from rest is too short.
    assert changes_of_direction(intervals) <= (3 if ramp.method == "newton" else 1)


@given(ramp=st.sampled_from(EASY), part=st.floats(1, 4), next_part=st.floats(1, 4))
@settings(max_examples=60)
def test_run_at_one_speed_and_then_another(host: Host, ramp: Ramp, part: float, next_part: float) -> None:
    slew = ramp.on_chip.slew_interval
    machine = Machine(host, ramp.image)
    for wanted in (int(slew * part), int(slew * next_part)):
        assert machine.ask("run", 1, wanted) == (OK, 0)
        machine.do("wait", 1_500_000)
        assert machine.report().interval == wanted
    machine.do("stop", 1)
    target = machine.report().target
    intervals, report = played(machine)
    assert report.position == target == len(intervals) + 1
    assert within_ramp(intervals, ramp)
    assert min(intervals) == min(int(slew * part), int(slew * next_part))


@pytest.mark.parametrize("before", [0, 100, 200])
@pytest.mark.parametrize("ramp", EASY, ids=str)
def test_a_stop_past_the_last_position_ends_where_it_says(host: Host, ramp: Ramp, before: int) -> None:
    """As with segments: positions count modulo 2³²."""
    machine = Machine(host, ramp.image)
    machine.do("position", 1, 2**31 - 1 - before)
    machine.ask("run", 1, 1000)
    machine.do("wait", 500_000)
    machine.do("stop", 1)
    target = machine.report().target
    machine.rest()
    made = machine.steps().travel
    assert machine.report().position == target
    assert (2**31 - 1 - before + made - target) % 2**32 == 0
    assert made > 150
