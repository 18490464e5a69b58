"""How long something is looked for: until nobody waits for it any more, or until the time is up."""

import math
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeVar

from stepramp.motor.train import NotWanted

Found = TypeVar("Found")


@dataclass
class Patience:
    """Whether to go on, asked by what plays moves; it begins when it is made."""

    is_wanted: Callable[[], bool]
    lasts_s: float = math.inf
    has_ended: bool = False
    """Whether it was asked when the time was up."""

    def __post_init__(self) -> None:
        """Note when it begins."""
        self._begun_s = time.monotonic()

    def is_over(self) -> bool:
        """Tell whether the time is up."""
        is_over = time.monotonic() - self._begun_s > self.lasts_s
        self.has_ended = self.has_ended or is_over
        return is_over

    def goes_on(self) -> bool:
        """Tell whether to go on."""
        return self.is_wanted() and not self.is_over()

    def within(self, play: Callable[[Callable[[], bool]], Found]) -> Found | None:
        """Return what is played while it lasts; None where the time is up. Raises NotWanted where nobody waits."""
        if self.is_over():
            return None
        try:
            return play(self.goes_on)
        except NotWanted:
            if self.is_wanted():
                return None
            raise
