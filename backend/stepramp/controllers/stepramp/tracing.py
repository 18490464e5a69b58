"""Tracing: which moves are traced, and with what plan, as they are asked for."""

from collections.abc import Callable, Collection, Mapping, Sequence
from time import monotonic

from stepramp.controllers.contract import NextTrace, Trace
from stepramp.controllers.stepramp.conversation import Conversation
from stepramp.controllers.stepramp.messages.status import AxisState, StatusReply, StatusRequest
from stepramp.controllers.stepramp.messages.trace import TRACE_OFF, TraceNotice, TraceReply, TraceRequest
from stepramp.controllers.stepramp.trace import TraceCollector, TracedMove
from stepramp.ramp.line import steps_together
from stepramp.ramp.playback.trajectory import Playback

ENDLESS_STEPS = 2**31
LAST_FRAME_WITHIN_S = 0.2
LISTEN_S = 0.01


class Tracing:
    """The trace of one axis' moves over a conversation.

    give_way: called while a trace is waited for, with how long there is time for other calls [s].
    """

    def __init__(self, conversation: Conversation, give_way: Callable[[float], None]) -> None:
        self._conversation = conversation
        self._give_way = give_way
        self._collector: TraceCollector | None = None
        """Of the last move."""
        self._armed: TraceCollector | None = None
        """Of the next one. The last trace is kept until there is one: what is asked for may be refused."""
        self._sets_out = False
        self._told = 0
        """How many motions the axis to be traced was told."""

    @property
    def trace(self) -> Callable[[], Trace] | None:
        """What works out the trace of the last move that was traced, in any thread; None before there was one."""
        return self._collector.trace() if self._collector else None

    def arm(self, axis: int | None, every_steps: int) -> NextTrace:
        """Trace an axis' moves from now on; None: no more of them."""
        request = TraceRequest(TRACE_OFF if axis is None else axis, every_steps)
        every = self._conversation.ask(request, TraceReply).every_steps
        if axis is not None:
            self._armed = TraceCollector(axis, every)
        return NextTrace(every, self._told + 1)

    def take(self, notice: TraceNotice) -> None:
        """Take what the controller tells."""
        if self._collector is not None:
            self._collector.take(notice)

    def prepare(self, axes: Collection[int], hear: Callable[[], None]) -> dict[int, int]:
        """Before a request to axes: find out whether the traced one sets out from rest, and return where it is.

        hear: lets what the controller has said unasked be taken; what it tells of the move before is waited for.
        """
        self._sets_out = False
        collector = self._armed
        if collector is None or collector.axis not in axes:
            return {}
        status = self._conversation.ask(StatusRequest(collector.axis), StatusReply)
        self._sets_out = status.axis_state == AxisState.IDLE
        if not self._sets_out:
            collector.change()
        deadline = monotonic() + LAST_FRAME_WITHIN_S
        hear()
        while self._sets_out and collector.is_under_way and monotonic() < deadline:
            self._give_way(LISTEN_S)
            hear()
        return {collector.axis: status.position_steps}

    def change(self, axes: Collection[int] | None) -> None:
        """Note that axes, or all, no longer do what was planned."""
        if self._collector is not None and (axes is None or self._collector.axis in axes):
            self._collector.change()

    def moves(self, distances: Mapping[int, int], playbacks: Sequence[Playback], timer_hz: int) -> None:
        """Note that axes have begun to move so many steps."""
        if (collector := self._setting_out(distances)) is not None:
            own = playbacks[collector.axis]
            steps = abs(distances[collector.axis])
            collector.begin(lambda: TracedMove(own.trajectory(own.rest, steps)), timer_hz, self._told)

    def runs(self, intervals: Mapping[int, int], playbacks: Sequence[Playback], timer_hz: int) -> None:
        """Note that axes have begun to run at intervals [ticks]."""
        if (collector := self._setting_out(intervals)) is not None:
            own = playbacks[collector.axis]
            interval = abs(intervals[collector.axis])
            collector.begin(lambda: TracedMove(own.trajectory(own.rest, ENDLESS_STEPS, interval)), timer_hz, self._told)

    def goes_along_a_line(self, steps: Mapping[int, int], playback: Playback, timer_hz: int) -> None:
        """Note that axes have begun to move along a line, whose leader plays this ramp."""
        if (collector := self._setting_out(steps)) is not None:
            most, own = max(map(abs, steps.values())), abs(steps[collector.axis])
            collector.begin(
                lambda: TracedMove(playback.trajectory(playback.rest, most), steps_together(most, own)),
                timer_hz,
                self._told,
            )

    def _setting_out(self, commanded: Mapping[int, int]) -> TraceCollector | None:
        """Let the armed collector be that of the last move, and return it if its axis has set out from rest."""
        collector = self._collector = self._armed
        if collector is not None and collector.axis in commanded:
            self._told += 1
        if collector is None or not self._sets_out or not commanded.get(collector.axis):
            return None
        return collector
