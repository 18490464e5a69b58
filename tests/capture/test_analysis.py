"""Channels, steps, pulses and moves of a recording."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from capture.writers import Changes, instants_of, pulses, saleae_csv, vcd, written_by_simavr
from designs import design
from stepramp.capture.analysis import Analysis, Wanted, analysed
from stepramp.capture.formats.files import read_file
from stepramp.errors import Rejected
from stepramp.ramp.profile import profile_of

NAMES = ("A", "B")
THERE_AND_BACK: Changes = [
    *pulses([1000, 2000, 3000, 4000], 10),
    (5000, 1, 1),
    *pulses([6000, 7000, 8000], 10),
    *pulses([900_000, 901_000], 10),
]
"""[µs]; the direction changes without a pause, then there is a pause."""


def analysis(changes: Changes, names: tuple[str, ...] = NAMES, **wanted: object) -> Analysis:
    return analysed(read_file(vcd(changes, names).encode()), Wanted(**wanted), None)  # type: ignore[arg-type]


def moves_in(found: Analysis) -> list[tuple[int, int]]:
    return list(zip(found.moves.first.tolist(), found.moves.steps.tolist(), strict=True))


def test_moves_end_at_pauses_and_changes_of_direction() -> None:
    assert moves_in(analysis(THERE_AND_BACK)) == [(0, 7), (7, 2)]
    found = analysis(THERE_AND_BACK, direction_channel="B")
    assert moves_in(found) == [(0, 4), (4, 3), (7, 2)]
    assert found.move is not None
    assert (found.move.number, found.move.direction_level) == (1, 0)
    assert moves_in(analysis(THERE_AND_BACK, longest_wait_us=1000)) == [(0, 4), (4, 3), (7, 2)]
    assert len(moves_in(analysis(THERE_AND_BACK, longest_wait_us=999))) == 9


def test_a_direction_holds_for_the_step_that_it_comes_with() -> None:
    changes = [*pulses([10, 20, 30], 2), (30, 1, 1)]
    assert moves_in(analysis(changes, direction_channel="B")) == [(0, 2), (2, 1)]
    assert moves_in(analysis(sorted(changes), ("B", "A"), step_channel="B", direction_channel="A")) == [(0, 2), (2, 1)]


def test_all_steps_of_one_instant_have_the_direction_that_it_ends_with() -> None:
    """Of instants with many edges, each is looked at once: this file was once read for hours."""
    again = 200_000
    lines = "0,0,0\n0,1,1\n" * again + "1,0,0\n1,1,0\n2,0,0\n"
    found = analysed(read_file(f"Time [s],Step,Dir\n{lines}".encode()), Wanted(), None)
    directions = found.steps.direction_levels
    assert found.steps.ticks.size == again + 1
    assert (directions[:-1] == 1).all()
    assert directions[-1] == 0


@pytest.mark.parametrize(
    ("edge", "instants"), [("rising", [100, 150]), ("falling", [110, 170]), ("both", [100, 110, 150, 170])]
)
def test_edges(edge: str, instants: list[int]) -> None:
    found = analysis([*pulses([100], 10), *pulses([150], 20)], edge=edge)
    assert found.steps.ticks.tolist() == instants


@pytest.mark.parametrize(
    ("edge", "shortest_us", "short"),
    [("rising", 10, []), ("rising", 10.01, [0]), ("rising", 20.5, [0, 1]), ("falling", 41, [0]), ("both", 11, [0])],
)
def test_short_pulses(edge: str, shortest_us: float, short: list[int]) -> None:
    found = analysis([*pulses([100], 10), *pulses([150], 20)], edge=edge, shortest_pulse_us=shortest_us)
    assert found.move is not None
    assert found.move.short_pulses.tolist() == short


def test_a_pulse_that_had_not_ended_is_not_short() -> None:
    found = analysis([*pulses([100], 10), (150, 0, 1)], shortest_pulse_us=1000)
    assert found.move is not None
    assert found.move.short_pulse_us.tolist() == [10]


@pytest.mark.parametrize(
    ("names", "step", "direction", "edge"),
    [
        (("A", "B"), "A", None, "rising"),
        (("Dir", "Step"), "Step", "Dir", "rising"),
        (("X DIR", "PUL-"), "PUL-", "X DIR", "rising"),
        (("Step (each edge)", "B"), "Step (each edge)", None, "both"),
    ],
)
def test_likely_channels(names: tuple[str, str], step: str, direction: str | None, edge: str) -> None:
    other = [*pulses([10, 20, 30], 2, 0), *pulses([11, 21], 2, 1)]
    found = analysis(other, names)
    chosen = found.choice.direction
    assert found.recording.channels[found.choice.step] == step
    assert (None if chosen is None else found.recording.channels[chosen]) == direction
    assert found.choice.edge == edge


@pytest.mark.parametrize(
    ("wanted", "field", "allowed"),
    [
        ({"step_channel": "C"}, "step_channel", "one of the file's channels: A, B"),
        ({"direction_channel": "C"}, "direction_channel", "one of the file's channels: A, B"),
        ({"step_channel": "B", "direction_channel": "B"}, "direction_channel", "another channel than the step channel"),
        ({"move_number": 3}, "move_number", "from 1 to 2"),
    ],
)
def test_refused(wanted: dict[str, object], field: str, allowed: str) -> None:
    with pytest.raises(Rejected) as refused:
        analysis(THERE_AND_BACK, **wanted)
    assert refused.value.rejections[0].field == field
    assert allowed in refused.value.rejections[0].allowed


def test_no_step_and_one_step() -> None:
    assert analysis([(5, 1, 1)], step_channel="A").move is None
    one = analysis([(5, 0, 1)])
    assert one.move is not None
    assert one.move.time_s.tolist() == [0.0]
    with pytest.raises(Rejected, match="the step channel has no such edge"):
        analysis([(5, 1, 1)], step_channel="A", move_number=1)


def test_of_several_moves_the_one_like_the_design() -> None:
    profile = profile_of(design(move__steps=3))
    changes = [*pulses(range(0, 5000, 1000), 10), *pulses([500_000, 514_000, 520_000], 10)]
    found = analysed(read_file(vcd(changes, NAMES).encode()), Wanted(), profile)
    assert moves_in(found) == [(0, 5), (5, 3)]
    assert found.move is not None
    assert found.move.number == 2


ramps = st.builds(
    lambda slew, acceleration, steps: design(
        ramp__slew_speed_steps_per_s=slew, ramp__acceleration_steps_per_s2=acceleration, move__steps=steps
    ),
    st.integers(100, 20_000),
    st.integers(500, 200_000),
    st.integers(1, 800),
)


@settings(max_examples=40)
@given(ramps, st.sampled_from(["CSV", "VCD"]), st.integers(1, 10**7), st.sampled_from(["first_step", "best_fit"]))
def test_a_profile_that_was_played_is_found_to_the_tick(played: object, kind: str, begin: int, alignment: str) -> None:
    """Half a microsecond is a tick of these designs, and of the files."""
    profile = profile_of(played)  # type: ignore[arg-type]  # a design
    instants = instants_of(profile.intervals_ticks, begin)
    changes = [*pulses(instants, 3), (0, 1, 1)]
    if kind == "VCD":
        content = vcd(changes, ("STEP", "DIR"), "500 ns").encode()
    else:
        content = saleae_csv(changes, ("STEP", "DIR"), Fraction(1, 2_000_000)).encode()
    found = analysed(read_file(content), Wanted(alignment=alignment), profile)  # type: ignore[arg-type]
    unit = found.recording.tick_s * 2_000_000
    assert [tick * unit for tick in found.steps.ticks.tolist()] == instants
    assert found.deviation is not None
    assert found.deviation.planned_step.tolist() == list(range(len(instants)))
    assert (found.deviation.missing.size, found.deviation.extra.size) == (0, 0)
    assert found.deviation.figures.largest_us < 1e-3


def test_a_move_that_simavr_wrote() -> None:
    """In cycles of 16 MHz, one of which is 6.25 of its file's ticks: rounded down, by less than one."""
    profile = profile_of(design())
    instants = [16_000 + 8 * tick for tick in instants_of(profile.intervals_ticks)]
    content = written_by_simavr([*pulses(instants, 32), (8000, 1, 1)], ("STEP", "DIR"))
    found = analysed(read_file(content), Wanted(), profile)
    assert found.deviation is not None
    assert found.deviation.planned_step.tolist() == list(range(2000))
    assert found.deviation.figures.largest_us < 0.01 + 1e-6
    assert np.all(found.steps.direction_levels == 1)
