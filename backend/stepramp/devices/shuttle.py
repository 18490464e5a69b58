"""There and back: one axis goes to and fro between two places, with a pause at each."""

from dataclasses import dataclass, replace
from time import monotonic


@dataclass(frozen=True)
class Shuttle:
    """How far it has come. A time is once there and once back."""

    axis: int
    by_steps: int
    times: int
    pause_s: float
    page: str | None = None
    """Whose it is, if a page's: it ends when that page is no longer in control."""
    request_number: int = 0
    """When it was asked for, in the order of all that is asked; see stops."""
    legs_begun: int = 0
    """Legs, there and back, that have been set out on."""
    expected_steps: int | None = None
    """Where the present leg ends; None before the first."""
    rest_since_s: float | None = None
    """Since when it is at rest, by the monotonic clock [s]; None while it moves."""

    @property
    def times_done(self) -> int:
        """How often it has set out on the leg back, and arrived."""
        return (self.legs_begun - (self.rest_since_s is None)) // 2

    @property
    def next_by_steps(self) -> int:
        """Where to go next, from where it is [steps]."""
        return self.by_steps if self.legs_begun % 2 == 0 else -self.by_steps

    @property
    def ended(self) -> bool:
        """Whether it is back from the last leg."""
        return self.rest_since_s is not None and self.legs_begun == 2 * self.times

    def set_out(self, target_steps: int) -> "Shuttle":
        """Return it on its next leg, which ends at a target [steps]."""
        return replace(self, legs_begun=self.legs_begun + 1, expected_steps=target_steps, rest_since_s=None)

    def arrived(self) -> "Shuttle":
        """Return it at rest, from now on."""
        return self if self.rest_since_s is not None else replace(self, rest_since_s=monotonic())

    def is_due(self) -> bool:
        """Whether the pause is over."""
        return self.rest_since_s is not None and monotonic() >= self.rest_since_s + self.pause_s
