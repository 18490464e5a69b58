"""The order in which figures are written: whatever keeps the rest from being, a motor isn't asked for more."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from stepramp.controllers.order import lowered_first

FIGURES = st.lists(st.tuples(st.integers(0, 5), st.integers(0, 5)), min_size=1, max_size=6)


@given(FIGURES)
def test_what_is_cut_short_is_no_more_than_it_was_or_no_more_than_it_is_to_be(figures: list[tuple[int, int]]) -> None:
    before, after = [old for old, _ in figures], [new for _, new in figures]
    order = lowered_first(range(len(figures)), lambda number: after[number] > before[number])
    assert sorted(order) == list(range(len(figures)))
    for cut in range(len(figures) + 1):
        there = [after[number] if number in order[:cut] else before[number] for number in range(len(figures))]
        # A lower place of each figure never hurts; one of both bounds holds for all of them at once.
        assert all(a <= b for a, b in zip(there, before, strict=True)) or all(
            a <= b for a, b in zip(there, after, strict=True)
        )
