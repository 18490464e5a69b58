"""What a slope remembers: computed once for whoever asks the same, and nobody's to spoil for the next."""

from dataclasses import dataclass, field

import numpy as np
import pytest
from numpy.typing import NDArray

from stepramp.numerics import remembered as module
from stepramp.numerics.remembered import remembered

computed: list[tuple[int, float]] = []


@dataclass(frozen=True)
class Slope:
    """A slope that keeps a list of what it computes."""

    steps: int
    kind: str = field(default="")

    @remembered
    def speeds(self, first: float) -> NDArray[np.floating]:
        """Return the numbers from `first` on."""
        computed.append((self.steps, first))
        return first + np.arange(self.steps, dtype=np.float64)


@pytest.fixture(autouse=True)
def nothing_computed() -> None:
    computed.clear()


def test_the_same_question_is_computed_once_and_another_by_itself() -> None:
    slope = Slope(3, "once")
    assert slope.speeds(1.0).tolist() == slope.speeds(1.0).tolist() == [1, 2, 3]
    assert Slope(3, "once").speeds(1.0).tolist() == [1, 2, 3]
    assert slope.speeds(0.5).tolist() == [0.5, 1.5, 2.5]
    assert Slope(3, "another").speeds(1.0).tolist() == [1, 2, 3]
    assert computed == [(3, 1.0), (3, 0.5), (3, 1.0)]


def test_who_writes_into_an_answer_spoils_no_other() -> None:
    slope = Slope(2, "written to")
    slope.speeds(1.0)[:] = -1
    slope.speeds(1.0)[:] = -1
    assert slope.speeds(1.0).tolist() == [1, 2]


def test_of_a_long_slope_nothing_is_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "MOST_STEPS", 2)
    for _ in range(2):
        assert Slope(3, "long").speeds(1.0).tolist() == [1, 2, 3]
    assert computed == [(3, 1.0)] * 2
