"""A backup of a Tic: the ramp and step mode that it had in use, as lines of a settings file, and all that it kept."""

from collections.abc import Iterator
from dataclasses import dataclass

from stepramp.controllers.tic.ramp import TicRamp
from stepramp.controllers.tic.read_settings import FIGURES, NEEDED, microsteps_told, ramp_told, told_by
from stepramp.controllers.tic.stored_settings import stored_in
from stepramp.errors import Count, Rejected, Rejection

ALLOWED = "a backup of a Tic, or its settings file: lines 'max_speed: …' and 'max_accel: …'"


@dataclass(frozen=True)
class Backup:
    """What a text tells."""

    ramp: TicRamp
    microsteps: int | None
    """None: it isn't told."""
    stored: bytes | None
    """All that the Tic kept without power; None: it isn't told."""
    others: tuple[str, ...]
    """Names of settings that have nothing to do with the ramp: a settings file has them, no backup."""

    @classmethod
    def of(cls, text: str) -> "Backup":
        """Return it; Rejected for a text that is none, or tells a ramp that no Tic can have."""
        told = told_by(text)
        if not told.keys() >= NEEDED:
            raise Rejected([Rejection("text", Count(f"{len(text.splitlines())} lines"), ALLOWED)])
        others = tuple(name for name in told if name not in (*FIGURES, "step_mode", "product"))
        return cls(ramp_told(told), microsteps_told(told), stored_in(text), others)

    def left(self, microsteps: int) -> Iterator[str]:
        """Yield what can't be written, as sentences. microsteps: what the Tic makes of a full step."""
        if self.microsteps not in (None, microsteps):
            yield (
                f"The step mode is not as in the backup: it makes {microsteps} of a full step, in the backup "
                f"{self.microsteps}. The Tic Control Center sets it."
            )
        if self.others:
            yield (
                f"Other settings than those of the ramp stay as they are, {len(self.others)} of them: the Tic Control "
                "Center writes them."
            )
