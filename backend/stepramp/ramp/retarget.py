"""Targets and speeds that change in flight: the steps that a controller plays of a design's ramp, to the tick.

What a motor does of what it is told is `playback.motor`, by which the virtual controller moves and the real firmware is
judged.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stepramp.design import MOST_STEPS, Design
from stepramp.errors import Count, Limits, Rejected, Rejection
from stepramp.numerics.limit_text import highest
from stepramp.ramp.on_chip import design_refusal, on_chip_ramp
from stepramp.ramp.plan import longest_side, ramp_of
from stepramp.ramp.playback.formula import FormulaPlayback
from stepramp.ramp.playback.lists import ListPlayback
from stepramp.ramp.playback.motor import InstantsOf, Motor
from stepramp.ramp.playback.trajectory import Playback
from stepramp.ramp.profile import Phase
from stepramp.ramp.slopes import peak_of
from stepramp.ramp.thinning import kept_steps_of_all
from stepramp.units import interval_from_speed, speed_from_interval, ticks_from_us

MOST_LOOKED_THROUGH = 1_000_000_000
"""Commands times steps of the ramp."""
COST_OF_A_FORMULA = 4
"""So many times as long takes a step of a ramp that the controller computes."""
END = 2**62
"""Later than anything ends [ticks]."""


@dataclass(frozen=True)
class Command:
    """What a motor is told at an instant: a target, or a speed."""

    at_s: float
    target_steps: int | None = None
    speed_steps_per_s: float | None = None
    """Negative: backwards; 0: slow down to rest."""


@dataclass(frozen=True)
class PlayedSteps:
    """What a motor does: its steps in order of time, and where it came to rest."""

    at_ticks: NDArray[np.int64]
    """Instant of each pulse, shape (steps,)."""
    position_steps: NDArray[np.int64]
    """After each pulse, shape (steps,)."""
    direction: NDArray[np.int64]
    """1 forwards, -1 backwards, shape (steps,)."""
    rest_at_ticks: NDArray[np.int64]
    """When it came to rest: the end of the last pulse's interval, shape (rests,)."""
    rest_position_steps: NDArray[np.int64]
    """Where, shape (rests,)."""
    told_position_steps: NDArray[np.int64]
    """Where it was at the instant of each command, shape (commands,)."""

    @property
    def interval_ticks(self) -> NDArray[np.int64]:
        """From each pulse to the next, or to rest where that comes before it, shape (steps,)."""
        ends = np.append(self.at_ticks[1:], END)
        # After as many pulses as had been made by then; a rest without any is none of theirs.
        last = np.searchsorted(self.at_ticks, self.rest_at_ticks) - 1
        ends[last[last >= 0]] = self.rest_at_ticks[last >= 0]
        return ends - self.at_ticks

    def kept(self, most: int) -> NDArray[np.int64]:
        """Return the places of about `most` pulses that carry the shapes of position and speed, with all turns."""
        steps = self.at_ticks.size
        kept = kept_steps_of_all([self.position_steps, self.interval_ticks], (Phase("slew", 1, steps),), most)
        turns = np.flatnonzero(np.diff(self.direction))
        return np.union1d(kept, np.union1d(turns, turns + 1))


def played_towards(design: Design, commands: Sequence[Command], direction_setup_us: float) -> PlayedSteps:
    """Return the steps that commands make of a design's ramp, from rest at position 0.

    Pulses that are due at the instant of a command are made first. A target that is too close, or behind, is passed:
    the motor slows down, turns and comes back, as it does before it goes the other way.

    commands: by their instants, not falling. direction_setup_us: from a change of direction to the next pulse [µs].
    Raises Rejected as ramp_of does, for a speed that the ramp doesn't lead to, for a last command after which the motor
    would never rest, and beyond 10,000,000 steps.
    """
    _refuse_endless(commands)
    # A ramp that can't be made says so itself, however few commands it has.
    playback, timer_hz = _playback_of(design), design.timer.frequency_hz
    _refuse_many(design, commands)
    motor = Motor(playback, round(ticks_from_us(direction_setup_us, timer_hz)))
    recorder = motor.watch = _Recorder(motor, len(commands))
    for index, command in enumerate(commands):
        at = round(command.at_s * timer_hz)
        motor.settle(at)
        recorder.told()
        if command.target_steps is not None:
            motor.move_to(command.target_steps, at)
        elif command.speed_steps_per_s:
            interval = _interval(design, playback, command.speed_steps_per_s, index)
            motor.run(interval, 1 if command.speed_steps_per_s > 0 else -1, at)
        else:
            motor.stop()
    motor.settle(END)
    return recorder.steps()


def _playback_of(design: Design) -> Playback:
    """Return how a controller plays the design's ramp: computed by itself where it can, else from its intervals."""
    return FormulaPlayback(on_chip_ramp(design)) if design_refusal(design) is None else ListPlayback(ramp_of(design))


def _refuse_endless(commands: Sequence[Command]) -> None:
    last = len(commands) - 1
    if commands[last].speed_steps_per_s:
        allowed = "0 in the last command, or a target: at a speed it would never rest"
        raise Rejected([Rejection(f"commands.{last}.speed_steps_per_s", commands[last].speed_steps_per_s, allowed)])


def _refuse_many(design: Design, commands: Sequence[Command]) -> None:
    """Refuse what would take minutes: with each command the ramp that is left is looked through."""
    cost = COST_OF_A_FORMULA if design_refusal(design) is None else 1
    most = MOST_LOOKED_THROUGH // (cost * max(1, int(longest_side(design))))
    if len(commands) > most:
        limits = Limits(1, most, "commands", is_whole=True, note=" for so long a ramp")
        raise Rejected([Rejection.outside("commands", len(commands), limits)])


def _interval(design: Design, playback: Playback, speed_steps_per_s: float, index: int) -> int:
    """Return the interval of a speed [ticks]. Raises Rejected when the ramp doesn't lead to it."""
    timer_hz = design.timer.frequency_hz
    interval = interval_from_speed(abs(speed_steps_per_s), timer_hz)
    if interval < playback.slew_interval:
        fastest = highest(speed_from_interval(playback.slew_interval, timer_hz))
        is_lowered = peak_of(design) is not None
        peak = f"peak speed of the ramp that is made for a move of {abs(design.move.steps):,} steps"
        limits = Limits(-fastest, fastest, "steps/s", note=f", the {peak if is_lowered else 'slew speed of the ramp'}")
        raise Rejected([Rejection.outside(f"commands.{index}.speed_steps_per_s", speed_steps_per_s, limits)])
    return interval


class _Recorder:
    """Notices what a motor does. See motor.PulseListener."""

    def __init__(self, motor: Motor, commands: int) -> None:
        self._motor, self._commands = motor, commands
        self._made = 0
        self._at: list[NDArray[np.int64]] = []
        self._positions: list[NDArray[np.int64]] = []
        self._directions: list[NDArray[np.int64]] = []
        self._rests: list[tuple[int, int]] = []
        self._told: list[int] = []

    def told(self) -> None:
        """Notice that the motor is told something."""
        self._told.append(self._motor.position)

    def set_out(self) -> None:
        """Notice that the motor sets out from rest."""

    def pulses(self, first: int, count: int, instants_of: InstantsOf) -> None:
        """Notice pulses; raises Rejected beyond 10,000,000."""
        self._made += count
        if self._made > MOST_STEPS:
            allowed = f"moves of at most {MOST_STEPS:,} steps in all"
            raise Rejected([Rejection("commands", Count(f"{self._commands} commands"), allowed)])
        here, direction = self._motor.position, self._motor.direction
        self._at.append(instants_of(np.arange(first, first + count)))
        self._positions.append(here - direction * np.arange(count - 1, -1, -1))
        self._directions.append(np.full(count, direction))

    def at_rest(self) -> None:
        """Notice that the motor has come to rest."""
        self._rests.append((self._motor.due_ticks, self._motor.position))

    def steps(self) -> PlayedSteps:
        """Return what was noticed."""
        rests = np.array(self._rests, np.int64).reshape(-1, 2)
        return PlayedSteps(
            at_ticks=_joined(self._at),
            position_steps=_joined(self._positions),
            direction=_joined(self._directions),
            rest_at_ticks=rests[:, 0],
            rest_position_steps=rests[:, 1],
            told_position_steps=np.array(self._told, np.int64),
        )


def _joined(parts: list[NDArray[np.int64]]) -> NDArray[np.int64]:
    return np.concatenate([np.empty(0, np.int64), *parts])
