"""Positions and targets against the pins."""

from dataclasses import dataclass

from firmware.checker import CYCLES_PER_US
from firmware.flight.exchange import Exchange
from firmware.flight.judgement import Judgement, at
from firmware.flight.motion import Flight
from firmware.protocol import HALT, LINE, MOVE_BY, MOVE_TO, RUN, STATUS, STOP, Status


@dataclass
class Words:
    """What has been said of an axis: a target that has been told is where it comes to rest."""

    flight: Flight
    found: Judgement
    target: int | None = 0
    """None: it has not been told."""
    runs: bool = False

    def been(self, one: Exchange) -> range:
        """Return where the axis was when a request was answered; a step and its count are not of one instant."""
        return self.flight.travels(one.arrived - 10 * CYCLES_PER_US, one.answered + 10 * CYCLES_PER_US)

    def add(self, one: Exchange, fault: str) -> None:
        self.found.add(f"axis {self.flight.axis} {at(one.arrived)}: {fault}")

    def hear(self, one: Exchange) -> None:
        axis = self.flight.axis
        if one.kind == STATUS and one.body[0] == axis:
            self.hear_status(one, Status.unpack(one.reply))
        elif one.kind in (MOVE_BY, MOVE_TO, LINE) and axis in one.values:
            self.hear_target(one, one.values[axis], one.targets[axis])
        elif one.kind == RUN and axis in one.values:
            self.target, self.runs = None, one.values[axis] != 0
        elif one.kind in (STOP, HALT) and (one.concerns(axis) or _on_a_line(self.flight, one)):
            self.target, self.runs = None if one.kind == STOP else self.flight.travel(one.answered), False

    def hear_status(self, one: Exchange, status: Status) -> None:
        """Positions are those of the edges."""
        been, rests = self.been(one), status.axis_state == 0
        if status.position not in (been[1:-1] if rests else been):
            self.add(one, f"the position is {status.position}, the edges say {been}")
        if self.runs and not rests:
            return
        if self.target not in (None, status.target):
            self.add(one, f"the target is {status.target}, it was {self.target}")
        if rests and status.position != status.target:
            self.add(one, f"at rest at {status.position}, the target is {status.target}")
        self.target, self.runs = status.target, False

    def hear_target(self, one: Exchange, value: int, told: int) -> None:
        """From its position in a run, else from its target."""
        begins = [0] if one.kind == MOVE_TO else self.been(one) if self.runs else [self.target]
        if begins != [None] and told - value not in begins:
            whence = "a run" if self.runs else begins[0]
            self.add(one, f"{told} is told as the target, {value} from {whence}")
        self.target, self.runs = told, False


def judge_words(flight: Flight, found: Judgement) -> None:
    words = Words(flight, found)
    for one in flight.heard:
        if one.is_granted:
            words.hear(one)


def _on_a_line(flight: Flight, one: Exchange) -> bool:
    return any(line.arrived < one.arrived < end for line, end in flight.lines)
