"""How many steps a controller makes of a full step, and what comes of it that somebody else changes that meanwhile."""

from stepramp.errors import Rescaled


def steps(count: int) -> str:
    """Return a number of steps as people read it."""
    return f"{count:,} step{'' if count == 1 else 's'}"


class Microsteps:
    """What an axis makes of a full step, as it was last read.

    called: what the controller is in a sentence, such as "The Tic". setting: what it calls its microsteps.
    """

    def __init__(self, called: str, setting: str) -> None:
        self._called, self._setting = called, setting
        self.count = 1
        self._counted_by = 1
        """By these the axis has counted where it is."""
        self._asked_by = 1
        """By these whoever moves the axis has made steps of lengths, as far as was said."""

    def learn(self, count: int) -> None:
        """Take so many as those by which the axis counts where it is: at first, and once its position is set."""
        self.count = self._counted_by = self._asked_by = count

    def note(self, count: int, position: int) -> None:
        """Take so many as read at rest, or in between, at a position [steps]: 0 is the same place with any."""
        is_known = self._counted_by == self.count
        self.count = count
        if is_known and not position:
            self._counted_by = count

    def refuse_changed(self, count: int, position: int) -> None:
        """Note so many, too; Rescaled, once, where lengths may have been made steps by others.

        That a status has told them is no reason not to: who moves the axis need not have read it.
        """
        before, self._asked_by = self._asked_by, count
        self.note(count, position)
        if count != before:
            raise Rescaled(
                f"{self._called} makes {steps(count)} of a full step by now, and made {before:,} ({self._setting}): "
                "it was changed meanwhile. Nothing was moved: ask again, if it is to be done with these."
            )

    @property
    def trouble(self) -> str | None:
        """What keeps the axis from being moved, as a sentence; None for nothing."""
        if self.count == self._counted_by:
            return None
        return (
            f"{self._called} can't move: it makes {steps(self.count)} of a full step by now, and has counted with "
            f"{self._counted_by:,} ({self._setting}), so it may be at another place than is counted. Set the position "
            "here."
        )
