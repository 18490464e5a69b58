"""The soft limits that the virtual controller keeps, as the firmware does."""

from collections.abc import Callable, Collection, Iterable, Mapping

from stepramp.controllers.stepramp.messages.reply import Refusal, ReplyStatus
from stepramp.controllers.stepramp.soft_limits import AT_HIGHEST, AT_LOWEST, HIGHEST, LOWEST, SoftLimit


class VirtualSoftLimits:
    """How far axes may go. They hold while positions are known.

    known: the axes whose position is; it changes. position: returns where an axis is [steps].
    """

    def __init__(self, known: Collection[int], position: Callable[[int], int]) -> None:
        self._known = known
        self._position = position
        self._bounds: dict[int, tuple[int, int]] = {}

    def use(self, limits: Iterable[SoftLimit]) -> None:
        """Keep axes within these from now on."""
        self._bounds = {limit.axis: limit.bounds for limit in limits}

    def end(self, axis: int, direction: int) -> int | None:
        """Return where a run in a direction comes to rest at the latest [steps]; None: nowhere."""
        lowest, highest = self._of(axis)
        end = highest if direction > 0 else lowest
        return None if end in (LOWEST, HIGHEST) else end

    def refuse_targets(self, targets: Mapping[int, int]) -> Refusal | None:
        """Refuse targets beyond them [steps]."""
        for axis, target in targets.items():
            lowest, highest = self._of(axis)
            if not lowest <= target <= highest:
                return _refusal(axis, -1 if target < lowest else 1)
        return None

    def refuse_runs(self, directions: Mapping[int, int]) -> Refusal | None:
        """Refuse runs, by the sign of their directions, of axes that are at the end or beyond."""
        for axis, direction in directions.items():
            end = self.end(axis, direction)
            if end is not None and (end - self._position(axis)) * direction <= 0:
                return _refusal(axis, direction)
        return None

    def _of(self, axis: int) -> tuple[int, int]:
        return self._bounds.get(axis, (LOWEST, HIGHEST)) if axis in self._known else (LOWEST, HIGHEST)


def _refusal(axis: int, direction: int) -> Refusal:
    return Refusal(ReplyStatus.AT_LIMIT, axis | (AT_LOWEST if direction < 0 else AT_HIGHEST) << 8)
