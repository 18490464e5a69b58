"""How a backup becomes the settings of a module again."""

from collections.abc import Callable, Sequence
from functools import partial

from stepramp.controllers.order import lowered_first
from stepramp.controllers.remark import UNLIKE, Unwritten
from stepramp.controllers.tmcl.axis import Axis
from stepramp.controllers.tmcl.backup import Backup
from stepramp.controllers.tmcl.conversation import Denied
from stepramp.controllers.tmcl.ramp import TmclRamp
from stepramp.controllers.tmcl.ramps import Locked, Ramps, store


class Restoring:
    """Writes the settings of axes that rest, and stores them."""

    def __init__(self, axes: Sequence[Axis], ramps: Ramps) -> None:
        self._axes = axes
        self._ramps = ramps

    def restore(self, backup: Backup) -> tuple[str, ...]:
        """Write what differs of a backup, one setting at a time, store and read it; return what couldn't be done."""
        self._ramps.on_trial = True
        remarks = [
            remark
            for axis in self._axes
            for remark in self._ramps.held(axis, partial(self._of_axis, axis, backup.settings.get(axis.number, {})))
        ]
        self._ramps.learn_again()
        self._ramps.on_trial = bool(remarks)
        return tuple(dict.fromkeys(remarks))

    def _present(self, axis: Axis) -> tuple[int, ...]:
        """Return the figures of an axis' ramp as it was last read; none of one that isn't shown."""
        in_use = self._ramps.in_use
        return tuple(value for _, value in in_use[axis.number].named) if axis.number < len(in_use) else ()

    def _of_axis(self, axis: Axis, wanted: dict[int, int], allowed: Callable[[], None]) -> list[str]:
        remarks: list[str] = []
        unit_mode = axis.parameters.unit_mode
        of_the_ramp = [axis.parameters.of(each.name) for each in TmclRamp.figures()]
        there = dict(zip(of_the_ramp, self._present(axis), strict=False))
        figures = lowered_first(wanted, lambda number: number in there and wanted[number] > there[number])
        # What the others mean depends on it.
        for parameter in sorted(figures, key=lambda number: number != unit_mode):
            try:
                differs = axis.get(parameter) != wanted[parameter]
                if differs and not axis.bring_back(parameter, wanted[parameter]):
                    remarks.append(Unwritten(f"Parameter {parameter} of axis {axis.number} {UNLIKE}"))
                # What a push stores may have been stored in part, though it is in use.
                if differs or parameter in of_the_ramp:
                    store(axis, parameter, allowed)
            except Denied as error:
                remarks.append(Unwritten(f"Parameter {parameter} of axis {axis.number}: {error}"))
            except Locked as error:
                remarks.append(str(error))
        return remarks
