"""What an axis did, and what it was told."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from firmware.checker import AxisEdges, Cycles, Edges, axis_of
from firmware.flight.exchange import ORDERS, Exchange
from firmware.flight.setting import Setting
from firmware.protocol import LINE


@dataclass(frozen=True)
class Flight:
    """What an axis did, and what it was told."""

    axis: int
    made: AxisEdges
    setting: Setting
    heard: Sequence[Exchange]
    lines: Sequence[tuple[Exchange, float]]
    """Each line with steps, and until when it may move [cycles]."""

    @property
    def orders(self) -> list[Exchange]:
        """Return what has changed its motion."""
        return [one for one in self.heard if one.is_granted and one.concerns(self.axis)]

    def travel(self, cycle: float) -> int:
        """Return where the steps until then have led [steps]."""
        count = int(np.searchsorted(self.made.steps, cycle, side="right"))
        return int(2 * self.made.forward[:count].sum() - count)

    def travels(self, begin: float, end: float) -> range:
        """Return where it has been between two moments."""
        first, last = (int(np.searchsorted(self.made.steps, cycle)) for cycle in (begin, end))
        way = self.travel(begin) + np.concatenate(([0], np.cumsum(2 * self.made.forward[first:last].astype(int) - 1)))
        return range(int(way.min()) - 1, int(way.max()) + 2)


def axis_at(edges: Edges, axis: int, setting: Setting) -> AxisEdges:
    """Return what the pins of an axis did since they were set up: at their first levels none of them has stepped."""
    settings = setting.settings
    return axis_of(
        edges,
        axis,
        step_inverted=bool(settings.step_inverted >> axis & 1),
        direction_inverted=bool(settings.direction_inverted >> axis & 1),
        both_edges=bool(settings.both_edges >> axis & 1),
    )


def line_windows(heard: Iterable[Exchange], steps: Cycles) -> list[tuple[Exchange, float]]:
    """Return each line with steps, and until when it may move [cycles], by the steps of all axes."""
    motions = [one for one in heard if one.kind in ORDERS and one.is_granted]
    ends = [_rest_before(one, steps) for one in motions[1:]] + [np.inf]
    pairs = zip(motions, ends, strict=True) if motions else ()
    return [(one, end) for one, end in pairs if one.kind == LINE and any(one.values.values())]


def _rest_before(one: Exchange, steps: Cycles) -> float:
    """Return when motors rested before a request was granted: it may have waited while a line came to its end."""
    first, last = np.searchsorted(steps, [one.arrived, one.answered])
    moments = np.concatenate(([one.arrived], steps[first:last], [one.answered]))
    longest = int(np.diff(moments).argmax())
    return float(moments[longest] + moments[longest + 1]) / 2


def leader_of(line: Exchange) -> int:
    values = line.values
    return max(values, key=lambda axis: (abs(values[axis]), -axis))
