from hypothesis import example, given
from hypothesis import strategies as st

from stepramp.numerics.limit_text import at_least, at_most


def number(text: str, words: str) -> float:
    assert text.startswith(words)
    return float(text.removeprefix(words).replace(",", ""))


@given(st.floats(1e-9, 1e12), st.integers(3, 6))
@example(2 / 3, 3)
@example(0.1, 6)
def test_what_is_told_is_within_the_limit_and_close_to_it(limit: float, figures: int) -> None:
    least, most = number(at_least(limit, figures), "at least "), number(at_most(limit, figures), "at most ")
    # But for what floating point makes of a number, beyond 12 figures.
    assert most * (1 - 1e-11) <= limit <= least * (1 + 1e-11)
    assert least - most <= limit * 10.0 ** (1 - figures) * (1 + 1e-9)


def test_limits_are_written_as_people_write_them() -> None:
    assert at_least(762.97444) == "at least 762.975"
    assert at_most(762.97444, 4) == "at most 762.9"
    assert (at_most(2_000_000), at_least(0.00077, 3)) == ("at most 2,000,000", "at least 0.00077")
    assert at_least(3_000_000.0000000005) == "at least 3,000,000"
