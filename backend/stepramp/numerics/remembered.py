"""What a slope computed last, kept for the next method that asks the same: curves are drawn of several at once."""

from collections.abc import Callable
from functools import lru_cache, wraps
from typing import Any, Concatenate, ParamSpec, Protocol, TypeVar, cast

import numpy as np
from numpy.typing import NDArray

MOST_STEPS = 100_000
"""Of slopes whose arrays are kept, so that all of a kind take 26 MB at most [steps]."""
KEPT = 32
"""So many arrays are kept of each kind."""


class HasSteps(Protocol):
    """What is so many steps long."""

    @property
    def steps(self) -> int:
        """Whole steps [steps]."""


One = TypeVar("One", bound=HasSteps)
Question = ParamSpec("Question")
Computed = Callable[Concatenate[One, Question], NDArray[np.floating]]


def remembered(compute: Computed[One, Question]) -> Computed[One, Question]:
    """Return the same function of a slope, which looks first whether it was asked that; each answer is a copy."""
    known: Any = lru_cache(maxsize=KEPT)(compute)

    @wraps(compute)
    def asked(one: One, *args: Question.args, **kwargs: Question.kwargs) -> NDArray[np.floating]:
        if one.steps > MOST_STEPS:
            return compute(one, *args, **kwargs)
        return np.array(known(one, *args, **kwargs))

    # That `asked` names its first argument is no business of those who call it.
    return cast(Computed[One, Question], asked)
