"""How motions of a module's axes begin and end. A module isn't asked what it was told: that is remembered here."""

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass
from enum import Enum
from functools import partial

from stepramp.controllers.axes import MOST_AXES
from stepramp.controllers.contract import Activity, AxisCommand, AxisStatus
from stepramp.controllers.tmcl.axis import Axis, Seen
from stepramp.controllers.tmcl.conversation import MOST_REPEATS
from stepramp.controllers.tmcl.program import RUNS, Program
from stepramp.controllers.tmcl.ramps import Ramps
from stepramp.controllers.tmcl.stopping import Stopping
from stepramp.controllers.tmcl.targets import speed_of, target_of, within_32_bits
from stepramp.errors import Refused

STUCK_LOOKS = 4
"""So often in a row an axis is seen to stand still short of its end until that is taken for it."""


class Aim(Enum):
    """What an axis was told last, over this connection."""

    NOTHING = "nothing"
    """Or it has been done."""
    REST = "rest"
    POSITION = "position"
    SPEED = "speed"


@dataclass
class Course:
    """How far an axis has come with what it was told."""

    aim: Aim = Aim.NOTHING
    target: int = 0
    set_out_at: int = 0
    still: int = 0
    """How often in a row it was seen standing still."""


class Motions:
    """Moves axes unless a stop has come since that was asked for, and tells how they fare.

    motors: all; those beyond MOST_AXES are stopped with the others, and else left alone.
    """

    def __init__(self, motors: Sequence[Axis], program: Program, ramps: Ramps, stopping: Stopping) -> None:
        self._axes, self._others = motors[:MOST_AXES], motors[MOST_AXES:]
        self._program = program
        self._ramps = ramps
        self._stopping = stopping
        self._courses = [Course() for _ in self._axes]
        self.past_trouble: str | None = None
        """What has ended the last motion."""

    def learn(self) -> None:
        """Take what the module does when the connection begins as given."""
        for course, axis in zip(self._courses, self._axes, strict=True):
            course.set_out_at = axis.look().position

    def note_stop(self, axes: Collection[int] | None) -> None:
        """Note that axes, or all, were told to come to rest."""
        for number, course in enumerate(self._courses):
            if axes is None or number in axes:
                course.aim = Aim.REST

    def inability(self) -> str | None:
        """Return what keeps axes from being moved, as a sentence; None for nothing. The program isn't asked for."""
        for number, ramp in enumerate(self._ramps.in_use):
            if (lack := ramp.lacks()) is not None:
                return f"Axis {number} can't move: of its ramp {lack}. Push a ramp, or roll back."
            if ramp.is_of_a_halt(self._ramps.units[number]):
                return (
                    f"Axis {number} can't move: it has the acceleration of a halt that was cut short. Push a ramp, or "
                    "roll back."
                )
        return next(filter(None, (each.trouble for each in self._ramps.microsteps)), None)

    def refuse_moving(self) -> None:
        """Raise Refused when an axis moves, or a program may move one."""
        for number, axis in enumerate(self._axes):
            if self._status(number, axis.look()).activity is not Activity.READY:
                raise Refused("The motor moves: stop it first.")
        for axis in self._others:
            if axis.look().speed:
                raise Refused(f"Motor {axis.number} of the module moves, which StepRamp doesn't show: stop all first.")
        if self._program.runs:
            raise Refused(RUNS)

    def status(self, number: int) -> AxisStatus:
        """Ask how an axis fares; one that stands still short of its end is stopped."""
        seen, course = self._axes[number].look(), self._courses[number]
        status = self._status(number, seen)
        is_going = course.aim in (Aim.POSITION, Aim.SPEED) and status.activity is Activity.MOVING
        course.still = course.still + 1 if is_going and not seen.speed else 0
        if course.still >= STUCK_LOOKS:
            # Else it would go on, once a switch is released.
            self._stopping.stop([number])
            self.note_stop([number])
            self.past_trouble = (
                f"Axis {number} has stopped by itself at {seen.position:,} steps, as at a limit switch or a stall: it "
                "does not go on."
            )
            return self.status(number)
        return status

    def by(self, steps: Sequence[AxisCommand]) -> None:
        """Begin to move axes by so many steps from where they would rest; Refused while one runs or slows down."""
        stops = self._stopping.count
        self._to([(each, self._rest_of(each) + int(each.value)) for each in steps], stops)

    def to(self, positions: Sequence[AxisCommand]) -> None:
        """Begin to move axes to positions [steps]."""
        stops = self._stopping.count
        self._to([(each, int(each.value)) for each in positions], stops)

    def run(self, speeds: Sequence[AxisCommand]) -> None:
        """Run axes at speeds with sign [steps/s]; 0 stops."""
        stops = self._stopping.count
        units = {
            each.axis: speed_of(each, self._ramps.in_use[each.axis], self._ramps.units[each.axis]) for each in speeds
        }
        running = {number: speed for number, speed in units.items() if speed}
        if running:
            for number in running:
                self._ramps.refuse_other_microsteps(number, self._axes[number].look().position)
            self._refuse_unable()
        for number, speed in running.items():
            axis = self._axes[number]
            self._begin(number, Course(Aim.SPEED), partial(axis.go_at, speed), running, stops)
        if resting := [number for number, speed in units.items() if not speed]:
            self._stopping.stop(resting)
            self.note_stop(resting)

    def set_position(self, positions: Sequence[AxisCommand]) -> None:
        """Call the places where axes rest positions [steps]."""
        called = {each.axis: within_32_bits(each, int(each.value)) for each in positions}
        self.refuse_moving()
        counts = {number: self._axes[number].microsteps() for number in called}
        for number, position in called.items():
            if position:
                self._ramps.microsteps[number].refuse_changed(counts[number], self._axes[number].look().position)
        for number, position in called.items():
            axis = self._axes[number]
            # One that has a target would go there from its new place. Only once it has that it is given a target.
            told = (
                axis.slow_down,
                partial(axis.call, axis.parameters.position, position),
                partial(axis.call, axis.parameters.target_position, position),
            )
            if not all(any(tell() for _ in range(1 + MOST_REPEATS)) for tell in told):
                raise Refused("The module doesn't take the position: is its serial line disturbed?")
            self._courses[number] = Course(set_out_at=position)
            self._ramps.microsteps[number].learn(counts[number])
        self.past_trouble = None

    def _to(self, targets: Sequence[tuple[AxisCommand, int]], stops: int) -> None:
        """Begin to move axes to positions. stops: how many had come when that was asked for."""
        seen = {asked.axis: self._axes[asked.axis].look() for asked, _ in targets}
        wanted = {asked.axis: target_of(asked, target, seen[asked.axis].position) for asked, target in targets}
        for number in wanted:
            self._ramps.refuse_other_microsteps(number, seen[number].position)
        self._refuse_unable()
        for number, target in wanted.items():
            axis = self._axes[number]
            self._begin(number, Course(Aim.POSITION, target), partial(axis.go_to, target), wanted, stops)

    def _begin(
        self,
        number: int,
        course: Course,
        tell: Callable[[Callable[[], None]], bool],
        all_told: Collection[int],
        stops: int,
    ) -> None:
        """Tell an axis what to do until it has it.

        all_told: axes that are told something together: when one doesn't take it, all are stopped.
        Raises AnswerUnknown when a stop came since there were so many.
        """
        allowed = partial(self._stopping.refuse_stopped, stops)
        seen = self._axes[number].look()
        if not any(tell(allowed) for _ in range(1 + MOST_REPEATS)):
            allowed()
            self._stopping.stop(all_told)
            self.note_stop(all_told)
            raise Refused(f"Axis {number} doesn't take what it is told: is the module's serial line disturbed?")
        allowed()
        course.set_out_at = self._courses[number].set_out_at if seen.speed else seen.position
        self._courses[number] = course
        self.past_trouble = None

    def _rest_of(self, asked: AxisCommand) -> int:
        """Return where an axis rests, or will; Refused while it runs at a speed, or slows down."""
        status = self._status(asked.axis, self._axes[asked.axis].look())
        if status.activity is Activity.STOPPING or status.runs:
            raise Refused("The motor runs, so it isn't known yet where it comes to rest: say a position, or wait.")
        return status.target_steps

    def _refuse_unable(self) -> None:
        """Refuse a motion before anything is said of it, when something is in its way that no command ends."""
        if (reason := self.inability()) is not None:
            raise Refused(reason)
        if self._program.runs:
            raise Refused(RUNS)

    def _status(self, number: int, seen: Seen) -> AxisStatus:
        """Return how an axis fares that was just looked at."""
        course, units = self._courses[number], self._ramps.units[number]
        speed = float(abs(seen.speed) * units.speed)
        activity, target = Activity.READY, seen.position
        if course.aim is Aim.POSITION and (seen.speed or seen.position != course.target):
            activity, target = Activity.MOVING, course.target
        elif course.aim is Aim.SPEED or (course.aim is Aim.NOTHING and seen.speed):
            activity = Activity.MOVING
        elif course.aim is Aim.REST and seen.speed:
            way = self._ramps.in_use[number].steps_to_rest(speed, units)
            activity, target = Activity.STOPPING, seen.position + (way if seen.speed > 0 else -way)
        else:
            course.aim = Aim.NOTHING
        return AxisStatus(
            axis=number,
            activity=activity,
            position_steps=seen.position,
            target_steps=target,
            speed_steps_per_s=speed,
            steps_made=abs(seen.position - course.set_out_at),
        )
