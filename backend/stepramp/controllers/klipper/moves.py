"""What the axes of a Klipper are told to do: one straight way at a time, told in parts."""

import math
from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from time import monotonic

from stepramp.controllers.axes import refuse_axes
from stepramp.controllers.contract import (
    Activity,
    AnswerUnknown,
    AxisCommand,
    AxisStatus,
    Ends,
    lasts_until_end_s,
)
from stepramp.controllers.klipper.conversation import Answered, Conversation
from stepramp.controllers.klipper.machine import LETTERS, Z
from stepramp.controllers.klipper.memory import Memory
from stepramp.controllers.klipper.places import Places
from stepramp.controllers.klipper.ramp import KLIPPER
from stepramp.controllers.klipper.route import AHEAD_S, ARRIVED_MM, PART_S, PUT_BACK, Route, script
from stepramp.controllers.klipper.seen import READY, Seen
from stepramp.controllers.klipper.stopping import Stopping
from stepramp.controllers.speed_ranges import too_fast_for, too_slow_for
from stepramp.errors import DeviceLost, Limits, Refused, Rejected, Rejection

REST_S = 30.0
"""What goes on is waited for so long, once it was told to end [s]."""
BUSY_S = 2.0
"""So long Klipper is given to see that it has nothing to do any more [s]."""
LOOK_S = 0.1
PRINTS = "it prints, or has paused that"
BUSY = "The printer is busy with what somebody has told it: wait until that has ended."


class Moves:
    """Moves axes, unless a stop has come since that was asked for."""

    def __init__(
        self, conversation: Conversation, memory: Memory, stopping: Stopping, give_way: Callable[[float], None]
    ) -> None:
        self._conversation = conversation
        self._memory = memory
        self._stopping = stopping
        self._give_way = give_way
        self._places = Places(memory)
        self._route: Route | None = None
        """Where the tool is on its way to, or was stopped on."""
        self._told: dict[int, float] = {}
        """Up to where it was told of that [mm]."""
        self._told_way = 0.0
        self._goes_on = False
        """More of the way is to be told."""
        self._has_left_state = False
        """A part was refused, and the state of its G-code is still to be put back."""
        self._stops = 0
        """How many stops there were when it was asked for."""
        self._speeds: dict[int, float] = {}
        """Of axes that run [steps/s]."""
        self._idle_since_s: float | None = None
        self._set_out_at: list[int] = []
        self.ends: Mapping[int, Ends] = {}
        """Where runs end by themselves, as positions are called here [steps]."""
        self.past_trouble: str | None = None
        """What has cut the last motion short; None for nothing."""

    def inability(self, seen: Seen) -> str | None:
        """Return what keeps the axes from being moved, as a sentence; None for nothing."""
        if seen.webhooks.state != READY:
            return (
                f"Klipper isn't ready: {' '.join(seen.webhooks.state_message.split())} Say FIRMWARE_RESTART at the "
                "printer's own page, then home it."
            )
        if seen.is_printing:
            return f"The printer can't be moved: {PRINTS}."
        return None

    def unhomed(self, seen: Seen) -> str | None:
        """Return that axes have to be homed first, as a sentence; None where all are."""
        missing = [letter for letter in LETTERS if letter not in seen.toolhead.homed_axes]
        if not missing:
            return None
        if len(missing) == 1:
            return f"Axis {missing[0]} isn't homed: Klipper doesn't move it before. Home it at the printer."
        all_missing = f"{', '.join(missing[:-1])} and {missing[-1]}"
        return f"Axes {all_missing} aren't homed: Klipper doesn't move them before. Home them at the printer."

    def is_under_way(self, seen: Seen) -> bool:
        """Whether the tool moves, or is about to."""
        if seen.webhooks.state != READY:
            return False
        return seen.motion_report.live_velocity != 0 or (self._route is not None and not self._has_arrived(seen))

    def is_others(self, seen: Seen) -> bool:
        """Whether what moves was told by somebody else."""
        return self._route is None and (seen.is_printing or seen.motion_report.live_velocity != 0)

    def do_others_go_on(self, seen: Seen) -> bool:
        """Whether what moves now, or will by itself, was told by somebody else; a print that is paused rests."""
        return self._route is None and (seen.virtual_sdcard.is_active or seen.motion_report.live_velocity != 0)

    def by(self, steps: Sequence[AxisCommand]) -> None:
        """Begin to move axes by so many steps, along a line, from where they would come to rest."""
        self._begin(steps, is_relative=True)

    def to(self, positions: Sequence[AxisCommand]) -> None:
        """Begin to move axes to positions [steps], along a line."""
        self._begin(positions, is_relative=False)

    def run(self, speeds: Sequence[AxisCommand]) -> None:
        """Run axes at speeds [steps/s], along a line up to the end of a travel; 0 has one of them run no more."""
        refuse_axes(speeds, len(self._places.scales))
        stops = self._stopping.count
        seen = self._conversation.look()
        self._refuse_speeds(speeds, seen)
        asked = (self._speeds if self._is_ours else {}) | {each.axis: each.value for each in speeds}
        wanted = {axis: speed for axis, speed in sorted(asked.items()) if speed}
        if not wanted:
            self._stopping.note()
            self._stopping.let_end()
            return
        seen = self._at_rest(list(asked), stops)
        self._refuse_unhomed(wanted, seen)
        rates = {axis: speed / float(self._places.scales[axis]) for axis, speed in wanted.items()}
        start = self._places.told(seen)
        lasts_s = min(_until_end(start[axis], rate, seen, axis) for axis, rate in rates.items())
        called = dict(enumerate(self._places.called(self._places.counted(start))))
        lasts_s = min(lasts_s, lasts_until_end_s(self.ends, called, wanted))
        goal = {axis: _within(start[axis] + rate * lasts_s, seen, axis) for axis, rate in rates.items()}
        if lasts_s <= 0:
            raise Refused("An axis is at the end of its travel.")
        self._set_out(goal, math.hypot(*rates.values()), seen, stops, wanted)

    def go_on(self, seen: Seen) -> None:
        """Tell Klipper the next part of the way, as long as somebody asks how it fares; note when it has arrived."""
        self.put_back_state()
        route = self._route
        if route is None:
            return
        if seen.webhooks.state != READY:
            self._route = None
        elif self._is_ours and (end := route.next_end(seen.motion_report.live_position, self._told_way)) is not None:
            try:
                self._tell(route, end)
            except Answered as error:
                self.past_trouble = f"The last motion was cut short. {error}"
            except AnswerUnknown:
                pass
        elif self._has_arrived(seen):
            self._route = None

    def put_back_state(self) -> None:
        """Put back the state of its G-code where a part was refused: Klipper carries nothing out after an error.

        It moves nothing, so it is sent after a stop, too: then with what is asked next.
        """
        if not self._has_left_state:
            return
        self._has_left_state = False
        try:
            self._conversation.script(PUT_BACK, moves=False)
        except Answered:
            # Not ready any more: the next start has a state of its own.
            pass
        except Refused:
            self._has_left_state = True

    def axes(self, seen: Seen) -> tuple[AxisStatus, ...]:
        """Return what each axis does."""
        counted = self._places.counted(seen.motion_report.live_position)
        called = self._places.called(counted)
        moves, found = self.is_under_way(seen), []
        for axis, scale in enumerate(self._places.scales):
            activity, rest, speed = Activity.READY, called[axis], 0.0
            route = self._route
            if moves and (route is None or axis in route.goal):
                speed = seen.motion_report.live_velocity * float(scale) * (abs(route.share(axis)) if route else 1.0)
                activity = Activity.MOVING if route is None or self._is_ours else Activity.STOPPING
            if route is not None and axis in route.goal and not (self._speeds and self._is_ours):
                end = route.goal[axis] if self._is_ours else self._told[axis]
                rest += round(end * float(scale)) - counted[axis]
            made = abs(counted[axis] - self._set_out_at[axis]) if self._set_out_at else 0
            is_homed = LETTERS[axis] in seen.toolhead.homed_axes
            found.append(
                AxisStatus(
                    axis, activity, called[axis], rest, speed, made, steps_per_mm=float(scale), position_told=is_homed
                )
            )
        return tuple(found)

    def steps_to_rest(self, axis: int, speed_steps_per_s: float) -> int:
        """Return how many steps slowing down from a speed [steps/s] takes: v² / 2a, and what is told ahead.

        That is v²/(2a·(1 - r)) with the minimum_cruise_ratio r, since so far ahead the end has to be known.
        """
        seen = self._conversation.last
        acceleration = float(self._memory.in_use(seen).accel_of(axis) * self._places.scales[axis])
        braking = speed_steps_per_s**2 / (2 * acceleration * (1 - seen.cruise_ratio))
        return math.ceil(braking + (AHEAD_S + PART_S) * speed_steps_per_s)

    def set_position(self, positions: Sequence[AxisCommand]) -> None:
        """Call the places where axes rest positions [steps]; Klipper isn't told. Refused where it doesn't know them."""
        refuse_axes(positions, len(self._places.scales))
        seen = self._conversation.look()
        if self.is_under_way(seen):
            raise Refused("The motor moves: stop it first.")
        self._refuse_unhomed([each.axis for each in positions], seen)
        counted = self._places.counted(seen.motion_report.live_position)
        self._places.call({each.axis: int(each.value) for each in positions}, counted)
        self.rest_at(seen)

    def count_as_klipper(self) -> str | None:
        """Forget what places are called here, and return that as a sentence; None where nothing else was said."""
        if not self._places.forget():
            return None
        return "Positions are counted as Klipper does again, since its axes are others than before: set them anew."

    def rest_at(self, seen: Seen) -> None:
        """Take where the axes are as where they set out from: when a connection begins, and positions are set."""
        self._set_out_at, self._route = self._places.counted(seen.motion_report.live_position), None

    @property
    def _is_ours(self) -> bool:
        """Whether the way is still to be gone: no stop came since it was asked for."""
        return self._route is not None and self._goes_on and self._stops == self._stopping.count

    def _has_arrived(self, seen: Seen) -> bool:
        """Tell whether the tool rests where it was sent, with no more to be sent."""
        if self._route is None or (self._is_ours and self._told_way < self._route.length):
            return False
        live = seen.motion_report.live_position
        if seen.motion_report.live_velocity != 0:
            return False
        is_there = all(abs(live[axis] - place) < ARRIVED_MM for axis, place in self._told.items())
        return is_there or self._has_been_idle(seen)

    def _has_been_idle(self, seen: Seen) -> bool:
        """Tell whether Klipper has done nothing for a while: somebody else has sent the tool elsewhere meanwhile."""
        now_s = monotonic()
        self._idle_since_s = None if seen.is_busy else self._idle_since_s or now_s
        return self._idle_since_s is not None and now_s - self._idle_since_s > BUSY_S

    def await_rest(self) -> Seen:
        """Return how Klipper fares once it has nothing to do; Refused while something moves, or it is busy."""
        return self._at_rest((), self._stopping.count)

    def _begin(self, asked: Sequence[AxisCommand], *, is_relative: bool) -> None:
        refuse_axes(asked, len(self._places.scales))
        stops, route = self._stopping.count, self._route if self._is_ours else None
        if is_relative and route is not None and self._speeds:
            raise Refused("An axis runs, so it isn't known yet where it comes to rest: say a position, or stop it.")
        seen = self._at_rest([each.axis for each in asked], stops)
        self._refuse_unhomed([each.axis for each in asked], seen)
        start, scales = self._places.told(seen), self._places.scales
        goal: dict[int, float] = {}
        for each in sorted(asked, key=lambda each: each.axis):
            if is_relative:
                origin = route.goal[each.axis] if route is not None and each.axis in route.goal else start[each.axis]
                goal[each.axis] = self._places.after(each.axis, origin, int(each.value))
            else:
                goal[each.axis] = float(self._places.counted_of(each.axis, int(each.value)) / scales[each.axis])
        self._refuse_beyond(asked, goal, seen)
        going = {axis: place for axis, place in goal.items() if abs(place - start[axis]) >= ARRIVED_MM}
        if going:
            self._set_out(going, float(self._memory.in_use(seen).velocity), seen, stops, {})
        else:
            self.rest_at(seen)

    def _set_out(
        self, goal: Mapping[int, float], speed: float, seen: Seen, stops: int, speeds: dict[int, float]
    ) -> None:
        """Tell the first part of a way; it is refused when a stop came since there were so many.

        speeds: of axes that run.
        """
        told, limits = self._places.told(seen), self._memory.in_use(seen)
        start = {axis: told[axis] for axis in goal}
        route = Route(start, goal, speed, float(limits.accel), seen.cruise_ratio)
        if (z_share := abs(route.share(Z))) > 0:
            speed = min(speed, float(limits.z_velocity) / z_share)
            acceleration = min(float(limits.accel), float(limits.z_accel) / z_share)
            route = Route(start, goal, speed, acceleration, route.cruise_ratio)
        self._stopping.refuse_stopped(stops)
        self._set_out_at = self._places.counted(told)
        self._route, self._told, self._told_way, self.past_trouble = route, dict(start), 0.0, None
        self._goes_on, self._stops, self._speeds, self._idle_since_s = True, stops, speeds, None
        end = route.next_end(told, 0.0)
        assert end is not None
        try:
            self._tell(route, end)
        except Answered:
            self._route = None
            raise
        self._stopping.refuse_stopped(stops)

    def _tell(self, route: Route, end: float) -> None:
        """Tell a part of the way up to an end [mm]."""
        places = route.place(end)
        lines, lengths = script(self._told, places, route.speed)
        before = dict(self._told), self._told_way
        # Before it is answered: a stop in the midst has to know where it may come to rest.
        self._told = {axis: self._told[axis] + length for axis, length in lengths.items()}
        self._told_way = end
        try:
            self._conversation.script(lines)
        except DeviceLost:
            # Whether it moves isn't known, and nobody would hear where.
            self._stopping.give_up()
            raise
        except Answered:
            self._told, self._told_way = before
            self._goes_on, self._has_left_state = False, True
            self.put_back_state()
            raise
        except Refused:
            self._told, self._told_way = before
            raise

    def _at_rest(self, axes: Sequence[int], stops: int) -> Seen:
        """Return how Klipper fares once it rests: what these axes do ends. Refused while others move, or it is busy."""
        seen = self._conversation.look()
        if self.is_others(seen):
            raise Refused(self.inability(seen) or BUSY)
        route = self._route
        if route is not None and self._is_ours and not set(route.goal) <= set(axes) and self.is_under_way(seen):
            others = ", ".join(str(axis) for axis in sorted(set(route.goal) - set(axes)))
            raise Refused(f"Axis {others} moves, and Klipper moves all axes by one plan: wait, or stop it first.")
        # What is still to be told is told no more: it comes to rest where it was told by now.
        self._goes_on = False
        deadline_s, busy_s = monotonic() + REST_S, None
        while self.is_under_way(seen) or seen.is_busy:
            self._stopping.refuse_stopped(stops)
            now_s = monotonic()
            busy_s = None if self.is_under_way(seen) else busy_s or now_s + BUSY_S
            if busy_s is not None and now_s > busy_s:
                raise Refused(BUSY)
            if now_s > deadline_s:
                raise Refused("What goes on doesn't come to rest: stop it first.")
            self._give_way(LOOK_S)
            seen = self._conversation.look()
        self._stopping.refuse_stopped(stops)
        self._route = None
        if (reason := self.inability(seen)) is not None:
            raise Refused(reason)
        return seen

    def _refuse_unhomed(self, axes: Sequence[int] | Mapping[int, float], seen: Seen) -> None:
        if any(LETTERS[axis] not in seen.toolhead.homed_axes for axis in axes):
            raise Refused(self.unhomed(seen) or "")

    def _refuse_speeds(self, asked: Sequence[AxisCommand], seen: Seen) -> None:
        limits, bad = self._memory.in_use(seen), []
        for each in asked:
            scale = self._places.scales[each.axis]
            fastest, slowest = limits.velocity_of(each.axis) * scale, KLIPPER.speed.least * scale
            if abs(Fraction(each.value)) > fastest:
                bad.append(too_fast_for(each, float(slowest), float(fastest), "the highest speed of the axis"))
            elif each.value and abs(Fraction(each.value)) < slowest:
                bad.append(too_slow_for(each, float(slowest), float(fastest)))
        if bad:
            raise Rejected(bad)

    def _refuse_beyond(self, asked: Sequence[AxisCommand], goal: Mapping[int, float], seen: Seen) -> None:
        """Reject places beyond an axis' travel: Klipper would refuse them, some of them in the midst of the way."""
        bad, toolhead = [], seen.toolhead
        for each in asked:
            axis, scale = each.axis, float(self._places.scales[each.axis])
            low, high = toolhead.axis_minimum[axis], toolhead.axis_maximum[axis]
            if low <= goal[axis] <= high:
                continue
            origin = goal[axis] * scale - each.value
            limits = Limits(
                math.ceil(low * scale - origin),
                math.floor(high * scale - origin),
                "steps",
                is_whole=True,
                note=f", the travel of axis {LETTERS[axis]} from {low:,.10g} to {high:,.10g} mm",
            )
            bad.append(Rejection.outside(each.field, int(each.value), limits))
        if bad:
            raise Rejected(bad)


def _until_end(place: float, rate: float, seen: Seen, axis: int) -> float:
    """Return after how long an axis that runs [mm/s] is at the end of its travel [s]."""
    end = seen.toolhead.axis_maximum[axis] if rate > 0 else seen.toolhead.axis_minimum[axis]
    return (end - place) / rate


def _within(place: float, seen: Seen, axis: int) -> float:
    """Return a place that was computed for the end of a travel without what rounding has led beyond that [mm]."""
    return min(max(place, seen.toolhead.axis_minimum[axis]), seen.toolhead.axis_maximum[axis])
