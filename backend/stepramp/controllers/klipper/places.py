"""Where the axes of a Klipper are: its millimetres as steps, and positions that count from where people say."""

from collections.abc import Mapping, Sequence
from fractions import Fraction

from stepramp.controllers.klipper.memory import Memory
from stepramp.controllers.klipper.seen import Seen

ROUNDED_MM = 1e-6
"""So near a whole step a place is that step, which can't be told to more decimals [mm]."""


class Places:
    """Positions [steps], as Klipper counts from where it was homed, and as they are called here."""

    def __init__(self, memory: Memory) -> None:
        self._memory = memory
        self._offsets: dict[int, int] = {}

    @property
    def scales(self) -> tuple[Fraction, ...]:
        """Steps per mm, by axis."""
        return tuple(stepper.steps_per_mm for stepper in self._memory.machine.steppers)

    def told(self, seen: Seen) -> list[float]:
        """Return where the axes were told to go [mm]: at rest, where they are."""
        return seen.toolhead.position[: len(self.scales)]

    def counted(self, position: Sequence[float]) -> list[int]:
        """Return places [mm] as Klipper counts them [steps]."""
        return [round(length * float(scale)) for length, scale in zip(position, self.scales, strict=False)]

    def called(self, counted: Sequence[int]) -> list[int]:
        """Return what places are called here [steps]."""
        return [place + self._offsets.get(axis, 0) for axis, place in enumerate(counted)]

    def counted_of(self, axis: int, called: int) -> int:
        """Return a position as Klipper counts it [steps]."""
        return called - self._offsets.get(axis, 0)

    def after(self, axis: int, place: float, steps: int) -> float:
        """Return where so many steps from a place lead [mm]: from a whole step to one, however it is rounded."""
        scale = self.scales[axis]
        whole = round(place * float(scale))
        if abs(place - float(whole / scale)) < ROUNDED_MM:
            return float((whole + steps) / scale)
        return place + float(steps / scale)

    def call(self, positions: Mapping[int, int], counted: Sequence[int]) -> None:
        """Call places something else from now on [steps]."""
        for axis, position in positions.items():
            self._offsets[axis] = position - counted[axis]

    def forget(self) -> bool:
        """Call places as Klipper counts them from now on, and return whether they were called otherwise."""
        was_other = any(self._offsets.values())
        self._offsets.clear()
        return was_other
