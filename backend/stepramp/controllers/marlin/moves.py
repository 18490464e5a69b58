"""What the axes of a Marlin are told to do: ways from rest, one after the other, and runs as rows of short ones."""

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from time import monotonic

from stepramp.controllers.axes import refuse_axes
from stepramp.controllers.contract import (
    Activity,
    AnswerUnknown,
    AxisCommand,
    AxisStatus,
    Ends,
    lasts_until_end_s,
    values_of,
)
from stepramp.controllers.marlin.conversation import ANSWER_S, PLACE, Conversation
from stepramp.controllers.marlin.course import Course
from stepramp.controllers.marlin.dialect import (
    ABSOLUTE,
    AWAIT_REST,
    LIVE_POSITION,
    NO_EXTRUSION,
    POSITION,
    RELATIVE,
    Place,
    place_of,
)
from stepramp.controllers.marlin.exchange import Answered, Exchange
from stepramp.controllers.marlin.memory import Memory
from stepramp.controllers.marlin.off_target import off_target
from stepramp.controllers.marlin.places import Places, rescaled, rescaled_words
from stepramp.controllers.marlin.settings import AxisSettings
from stepramp.controllers.marlin.stopping import Stopping
from stepramp.controllers.marlin.way import (
    can_be_told,
    fastest_feed,
    feed_of,
    refuse_places,
    refuse_runs_too_far,
    refuse_speeds,
    way_line,
)
from stepramp.errors import DeviceLost, Refused, Rescaled
from stepramp.units import SECONDS_PER_MINUTE

LOOK_S = 0.1
"""So long an answer is waited for that may come only when everything rests [s]."""
REST_S = 1.5
"""The same before something is changed, which is refused otherwise [s]."""
LATE_S = 6.0
"""So long after it should have come to rest it is asked anew whether it has [s]."""
AHEAD_S = 1.2
"""So long a run goes on when nobody asks any more how it fares, besides slowing down [s]."""
FURTHER_S = 0.4
"""A run is told to go on, by so much, once it would go on for so much less than that [s]."""
DRIFT = 0.005
"""By so much of the time that a run has lasted, its clock may differ from the one here."""
MOST_AHEAD_S = 4.0
FOREIGN = "Something moves that was not asked for here: wait until it rests, or stop it."


@dataclass(frozen=True)
class Seen:
    """How the axes fare at an instant. counted: where they are, as the controller counts [steps]."""

    counted: list[int]
    at_s: float
    course: Course | None = None
    """What they are on; None at rest, or on something that somebody else has told them."""
    is_foreign: bool = False
    """Something moves that wasn't asked for here."""


class Moves:
    """Moves axes, unless a stop has come since that was asked for."""

    def __init__(self, conversation: Conversation, places: Places) -> None:
        self._conversation = conversation
        self._places = places
        self.stopping = Stopping(conversation, self._stopped)
        self.memory = Memory(conversation, self.refuse_moving)
        self._course: Course | None = None
        self._speeds: dict[int, float] = {}
        """Of axes that run [steps/s]."""
        self._pending: Exchange | None = None
        """What is answered only when everything rests."""
        self._at_rest: list[int] = []
        """Where the axes were last told to be."""
        self._set_out_at: list[int] = []
        self.ends: Mapping[int, Ends] = {}
        """Where runs end by themselves, as positions are called here [steps]."""
        self._asked_by: tuple[AxisSettings, ...] = ()
        """With these whoever moves axes has made steps of lengths, as far as was said."""
        self.trouble: str | None = None
        """What has cut the last motion short, as a sentence."""

    def look(self) -> Seen:
        """Return how the axes fare; axes that run are told to go on."""
        if self._pending is not None:
            return self._look_again(self._pending)
        if self._course is None:
            with suppress(Refused):
                self.stopping.leave_relative()
            return self._look_at_rest()
        self._go_on()
        if self._course is not None and monotonic() < self._course.ends_s:
            return self._on_its_way()
        self._pending = self._conversation.start(AWAIT_REST)
        return self._look_again(self._pending)

    def learn(self) -> str | None:
        """Read the settings; return which steps per mm have changed, as a sentence, or None.

        Where axes rest stays called what it was: Marlin counts it anew then, though nothing has moved.
        """
        before, rested = self._places.axes, self._at_rest
        called = self._places.called(rested) if rested else []
        self.memory.learn()
        self._places.learn(self.memory.settings.axes())
        after = self._places.axes
        changed = rescaled(before, after)
        if rested and (changed or len(before) != len(after)):
            self._note_rest(self._conversation.place())
            self._places.call({axis: called[axis] for axis in changed}, self._at_rest)
            self._set_out_at = self._at_rest
        return rescaled_words(before, after)

    def know_scales(self) -> None:
        """Take the steps per mm as known to whoever moves axes from now on."""
        self._asked_by = self._places.axes

    def refuse_moving(self) -> None:
        """Refused while something moves, whoever has told it to."""
        if self.look().course is not None:
            raise Refused("The motor moves: wait until it rests, or stop it first.")
        until_s = monotonic() + REST_S
        while monotonic() < until_s:
            pending = self._pending = self._pending or self._conversation.start(AWAIT_REST)
            if self._conversation.is_through(pending, LOOK_S):
                self._pending = None
                if pending.is_over:
                    return
        raise Refused(FOREIGN)

    def by(self, steps: Sequence[AxisCommand]) -> None:
        """Begin to move axes by so many steps, along a line."""
        self._begin(steps, lambda axis, counted: counted + int(values_of(steps)[axis]))

    def to(self, positions: Sequence[AxisCommand]) -> None:
        """Begin to move axes to positions [steps], along a line."""
        self._begin(positions, lambda axis, _: self._places.counted_of(axis, int(values_of(positions)[axis])))

    def run(self, speeds: Sequence[AxisCommand]) -> None:
        """Run axes at speeds [steps/s], along a line; 0 stops all."""
        refuse_axes(speeds, len(self._places.axes))
        refuse_speeds(speeds, self._places.axes)
        now, stops = self._speeds, self.stopping.count
        wanted = {axis: speed for axis, speed in (now | dict(values_of(speeds))).items() if speed}
        if wanted == now and now:
            return
        if not wanted:
            self.stopping.stop()
            return
        if now:
            raise Refused("Axes that run keep their speeds: stop them first.")
        counted = self._ready(stops)
        feed = feed_of(wanted, self._places.axes)
        ahead = partial(self._ahead, counted)
        refuse_runs_too_far(speeds, wanted, ahead, self._places.axes)
        self._go(ahead(wanted), feed, stops, counted, speed=float(feed) / SECONDS_PER_MINUTE)
        self._speeds = wanted

    def axes(self, seen: Seen) -> tuple[AxisStatus, ...]:
        """Return what each axis does."""
        called, found = self._places.called(seen.counted), []
        for axis, scale in enumerate(self._places.axes):
            moves = seen.is_foreign or (seen.course is not None and axis in seen.course.targets)
            rest, speed = called[axis], 0.0
            if seen.course is not None and moves:
                speed = seen.course.speed_of(axis, seen.at_s)
                if axis not in self._speeds:
                    rest += seen.course.targets[axis] - seen.counted[axis]
            made = abs(seen.counted[axis] - self._set_out_at[axis]) if self._set_out_at else 0
            activity = Activity.MOVING if moves else Activity.READY
            found.append(
                AxisStatus(axis, activity, called[axis], rest, speed, made, steps_per_mm=float(scale.steps_per_mm))
            )
        return tuple(found)

    def rest_at(self, place: Place) -> None:
        """Take where the axes are as where they set out from: when a connection begins, and positions are set."""
        self._places.forget()
        self.know_scales()
        self._set_out_at = self._note_rest(place).counted

    def call(self, positions: Mapping[int, int]) -> None:
        """Call the places where axes rest something else from now on [steps]."""
        self._places.call(positions, self._at_rest)
        self._set_out_at, self.trouble = self._at_rest, None

    def _begin(self, asked: Sequence[AxisCommand], target_of: Callable[[int, int], int]) -> None:
        refuse_axes(asked, len(self._places.axes))
        stops = self.stopping.count
        counted = self._ready(stops)
        targets = {each.axis: target_of(each.axis, counted[each.axis]) for each in asked}
        refuse_places(asked, targets)
        self._set_out_at = counted
        going = {axis: place for axis, place in targets.items() if place != counted[axis]}
        if going:
            self._go(going, fastest_feed(list(going), self._places.axes), stops, counted)

    def _ahead(self, counted: Sequence[int], speeds: Mapping[int, float]) -> dict[int, int]:
        """Return where axes that begin to run from places are sent to first [steps]."""
        scales = self._places.axes
        brakes_s = max(abs(speed) / scales[axis].acceleration_steps_per_s2 for axis, speed in speeds.items())
        called = dict(enumerate(self._places.called(counted)))
        lasts_s = min(brakes_s + AHEAD_S + FURTHER_S, lasts_until_end_s(self.ends, called, speeds))
        return {axis: counted[axis] + round(speed * lasts_s) for axis, speed in speeds.items()}

    def _ready(self, stops: int) -> list[int]:
        """Return where the axes rest [steps]; Refused while something moves, or when a stop has come meanwhile.

        Once also with steps per mm by which nothing was asked for yet: who moves axes need not have read their status.
        """
        self.refuse_moving()
        self.memory.refuse_printing()
        if self.memory.tells_other_scales():
            self.trouble = self.learn()
        words = rescaled_words(self._asked_by, self._places.axes)
        self.know_scales()
        if words is not None:
            raise Rescaled(f"{words} Nothing was moved: ask again, if it is to be done with these.")
        self.stopping.refuse_stopped(stops)
        self.trouble = None
        return self._at_rest

    def _go(
        self, targets: Mapping[int, int], feed: str, stops: int, counted: Sequence[int], speed: float | None = None
    ) -> None:
        """Have axes go from where they rest to places [steps] at a feed; speed: along the line [mm/s]."""
        ways = {axis: (counted[axis], target) for axis, target in targets.items()}
        course = Course.of(monotonic(), ways, self._places.axes, self.memory.settings, speed)
        self._set_out_at = list(counted)
        self._tell(targets, {axis: a for axis, (a, _) in ways.items()}, feed, stops, course)

    def _tell(
        self, targets: Mapping[int, int], origins: Mapping[int, int], feed: str, stops: int, course: Course
    ) -> None:
        """Have axes go from places to others [steps], which makes their course so long."""
        scales, places = self._places.axes, self._places
        ways = {axis: places.way(axis, target, origins[axis]) for axis, target in targets.items()}
        line = way_line({scales[axis].letter: way for axis, way in ways.items()}, feed)
        said = self._told(line, stops)
        for axis, way in ways.items():
            places.went(axis, targets[axis], origins[axis], way)
        self._course = course
        if refusal := next((found for found in map(NO_EXTRUSION.fullmatch, said) if found), None):
            self._course = None
            raise Refused(f"Marlin leaves the extruder where it is: {refusal['words']}.")

    def _told(self, line: str, stops: int) -> list[str]:
        """Return what it says to a relative way, after which it takes places again, whatever comes in between."""
        self.stopping.may_be_relative = True
        try:
            said = self._conversation.carry_out(
                [RELATIVE, line, ABSOLUTE], allowed=lambda: self.stopping.refuse_stopped(stops)
            )
            self.stopping.may_be_relative = False
            self.stopping.refuse_stopped(stops)
        except DeviceLost:
            # Whether it moves isn't known, and nobody would hear where.
            self.stopping.give_up()
            raise
        except Answered:
            # One of the three was refused: whether the way is among what was taken isn't known.
            self.stopping.stop()
            raise
        except Refused:
            # Where nothing may be sent just now, the stop that follows sends it, or the next look.
            self.stopping.leave_relative()
            raise
        return said

    def _go_on(self) -> None:
        """Have axes that run go on, as long as somebody asks how they fare."""
        course, now_s, stops = self._course, monotonic(), self.stopping.count
        if course is None or not self._speeds:
            return
        if now_s > course.ends_s - course.brakes_s:
            # It slows down already, since nobody has asked for so long: it comes to rest.
            self._speeds = {}
            return
        ahead_s = min(AHEAD_S + DRIFT * (now_s - course.begun_s), MOST_AHEAD_S)
        if course.ends_s - course.brakes_s - now_s >= ahead_s:
            return
        lasts_s = FURTHER_S + ahead_s - (course.ends_s - course.brakes_s - now_s)
        heading = [course.targets.get(axis, place) for axis, place in enumerate(self._at_rest)]
        called = dict(enumerate(self._places.called(heading)))
        left_s = lasts_until_end_s(self.ends, called, self._speeds)
        # The last way is none of a few steps: Marlin would leave it out.
        lasts_s = left_s if left_s < lasts_s + FURTHER_S else lasts_s
        if lasts_s <= 0:
            return
        targets = {axis: course.targets[axis] + round(speed * lasts_s) for axis, speed in self._speeds.items()}
        if not all(map(can_be_told, targets.values())):
            # It comes to rest near the furthest place that can be told.
            self._speeds = {}
            return
        feed = feed_of(self._speeds, self._places.axes)
        try:
            with suppress(AnswerUnknown):
                self._tell(targets, course.targets, feed, stops, course.longer(targets))
        except Answered as error:
            self.trouble = str(error)
        except Refused as error:
            # As of an extruder that has cooled meanwhile: what it was told already it still does.
            self.trouble, self._speeds = str(error), {}

    def _look_at_rest(self) -> Seen:
        """Return where the axes rest, or that something else goes on, which keeps it from answering."""
        exchange = self._conversation.start(POSITION, PLACE)
        if not self._conversation.is_through(exchange, ANSWER_S) and self._conversation.is_busy:
            self._pending = exchange
            return Seen(self._at_rest, monotonic(), is_foreign=True)
        told = next(filter(None, map(place_of, exchange.said)), None)
        return self._rests(told if exchange.is_over and told is not None else self._conversation.place())

    def _on_its_way(self) -> Seen:
        """Return where axes are: as they are told to be, where that isn't where they will come to rest."""
        course = self._course
        exchange = self._conversation.start(LIVE_POSITION, PLACE)
        if not self._conversation.is_through(exchange, LOOK_S):
            self._pending = exchange
        if self._course is None:
            return Seen(self._at_rest, monotonic())
        assert course is not None
        told = next(filter(None, map(place_of, exchange.said)), None)
        if told is not None and exchange.is_over:
            counted = self._places.counted(told)
            if any(counted[axis] != target for axis, target in course.targets.items()):
                return Seen(counted, monotonic(), self._course)
        return self._as_planned()

    def _as_planned(self) -> Seen:
        now_s, counted = monotonic(), list(self._at_rest)
        if self._course is None:
            return Seen(counted, now_s)
        for axis, place in self._course.places(now_s).items():
            counted[axis] = place
        return Seen(counted, now_s, self._course)

    def _look_again(self, pending: Exchange) -> Seen:
        """Return how the axes fare while an answer is waited for that comes when they rest."""
        if not self._conversation.is_through(pending, LOOK_S):
            if self._course is None:
                if monotonic() > pending.begun_s + LATE_S and not self._conversation.is_busy:
                    # Its answer was lost.
                    self._conversation.give_up(pending)
                    return self._has_come_to_rest()
                return Seen(self._at_rest, monotonic(), is_foreign=True)
            if monotonic() > self._course.ends_s + LATE_S:
                # Its answer was lost.
                self._conversation.give_up(pending)
                self._conversation.ask(AWAIT_REST)
                return self._has_come_to_rest()
            return self._as_planned()
        self._pending = None
        if pending.is_over and pending.line == AWAIT_REST:
            return self._has_come_to_rest()
        return self.look() if self._course is None else self._as_planned()

    def _has_come_to_rest(self) -> Seen:
        self._pending = None
        place = self._conversation.place()
        course, self._course, self._speeds = self._course, None, {}
        seen = self._rests(place)
        if course is not None:
            self.trouble = off_target(course.targets, seen.counted, course.starts, self._places.axes)
        return seen

    def _rests(self, place: Place) -> Seen:
        try:
            if self._places.is_counted_anew(place) and self.memory.tells_other_scales():
                self.trouble = self.learn()
        except Refused as error:
            # It can be looked at all the same, and stopped.
            self.trouble = str(error)
        return self._note_rest(place)

    def _note_rest(self, place: Place) -> Seen:
        self._at_rest = self._places.counted(place)
        self._places.note_rest(place, self._at_rest)
        return Seen(self._at_rest, monotonic())

    def _stopped(self, place: Place) -> None:
        """Note where a quick stop has ended everything."""
        self._course, self._speeds, self._pending = None, {}, None
        self._places.forget()
        self._note_rest(place)
