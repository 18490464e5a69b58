"""What everybody can do who computes many things at once."""

from collections.abc import Callable, Iterator, Sequence
from typing import Protocol, TypeVar

Item = TypeVar("Item")
R = TypeVar("R")

IsWanted = Callable[[], bool]


class Executor(Protocol):
    """Computes many things at once."""

    def results(
        self, task: Callable[[Item, IsWanted], R], items: Sequence[Item], is_wanted: IsWanted
    ) -> Iterator[tuple[Item, R]]:
        """Yield each item with what the task makes of it, in the order in which they are done.

        task: a function of a module, or a partial of one: others may have to find it. It asks its second argument from
        time to time whether it is to go on, and raises what it likes when it isn't; what a task raises is raised.
        Ends early, without what has begun, as soon as is_wanted says no.
        """
        ...
