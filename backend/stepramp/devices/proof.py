"""What the start of a controller has shown of what it was given before."""

from collections.abc import Collection
from dataclasses import dataclass, replace

from stepramp.controllers.capabilities import MENDING, WAIT_OR_RESTART


@dataclass(frozen=True)
class Other:
    """A setting that is another than was written. now: None where it isn't there."""

    name: str
    written: str
    at: str
    now: str | None

    @property
    def words(self) -> str:
        """What it has and had, as part of a sentence."""
        has = f"no {self.name}" if self.now is None else f"{self.name}={self.now}"
        return f"{has} where {self.written} was written on {self.at}"


@dataclass(frozen=True)
class Proof:
    """Settings by whether the controller had them after a start as they were written."""

    proven: tuple[str, ...]
    others: tuple[Other, ...]

    @property
    def not_kept(self) -> tuple[str, ...]:
        """The names of those that are others."""
        return tuple(each.name for each in self.others)

    @property
    def trouble(self) -> str | None:
        """What is to be said of those, blaming nobody; None for nothing."""
        if not self.others:
            return None
        found = ", and ".join(each.words for each in self.others)
        it = "it" if len(self.others) == 1 else "them"
        return (
            f"Since its start the controller has {found}. Either it hasn't kept {it}, or somebody has set {it} since, "
            f"or another controller is there now. {MENDING}"
        )

    @property
    def stored(self) -> str | None:
        """What is to be said of the proven ones; None for nothing."""
        names = ", ".join(self.proven)
        return f"Stored: after a start the controller had {names} as written." if names else None

    @property
    def words(self) -> str:
        """What it says, as sentences."""
        return " ".join(each for each in (self.stored, self.trouble) if each)

    def without(self, names: Collection[str]) -> "Proof | None":
        """Return what is left of it once settings were written anew; None for nothing."""
        proven = tuple(each for each in self.proven if each not in names)
        others = tuple(each for each in self.others if each.name not in names)
        return replace(self, proven=proven, others=others) if proven or others else None


def pending_words(names: Collection[str]) -> str | None:
    """Return what is to be said of settings that are in use, and not proven yet; None for none."""
    if not names:
        return None
    return f"{', '.join(names)} {'is' if len(names) == 1 else 'are'} in use. {WAIT_OR_RESTART}"
