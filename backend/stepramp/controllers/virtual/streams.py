"""What the virtual controller sends without being asked each time: the stream of reports, and the trace of a move."""

from collections import deque
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from stepramp.controllers.stepramp.messages.trace import MOST_TRACE_VALUES, TRACE_LAST, TraceNotice
from stepramp.ramp.playback.motor import InstantsOf

WRAP = 1 << 16
"""The timer counts up to this and begins again [ticks]."""


class ReportClock:
    """When reports are due. Those that come too late are left out."""

    def __init__(self) -> None:
        self._period_s = 0.0
        self._due_s = 0.0

    def start(self, rate_hz: int, now_s: float) -> None:
        """Report so many times a second from now on; 0: no more."""
        self._period_s = 1 / rate_hz if rate_hz else 0.0
        self._due_s = now_s

    def is_due(self, now_s: float) -> bool:
        """Tell whether it is time for a report; that one is then made."""
        if not self._period_s or now_s < self._due_s:
            return False
        self._due_s += self._period_s
        if self._due_s <= now_s:
            self._due_s = now_s + self._period_s
        return True


class TraceRecorder:
    """The timer's values at every k-th step of one axis' moves, from the first pulse on, as frames."""

    def __init__(self, axis: int, every_steps: int) -> None:
        self.axis = axis
        self._every_steps = every_steps
        self._in_a_move = False
        self._values: deque[int] = deque()
        self._first_step = 1
        self._frames: deque[TraceNotice] = deque()

    def set_out(self) -> None:
        """Begin with the trace of a move."""
        self._in_a_move, self._first_step = True, 1
        self._values.clear()

    def pulses(self, first: int, count: int, instants_of: InstantsOf) -> None:
        """Note the instants of those of so many pulses that are traced."""
        every = self._every_steps
        traced: NDArray[np.int64] = np.arange(-(-(first - 1) // every) * every + 1, first + count, every)
        if self._in_a_move and traced.size:
            self._values.extend(int(value) for value in instants_of(traced) % WRAP)
        while len(self._values) >= MOST_TRACE_VALUES:
            self._cut_frame(self.axis)

    def at_rest(self) -> None:
        """End the trace of a move."""
        if self._in_a_move:
            self._cut_frame(self.axis | TRACE_LAST)
        self._in_a_move = False

    def frames(self) -> Iterator[TraceNotice]:
        """Yield the frames that are complete, once."""
        while self._frames:
            yield self._frames.popleft()

    def _cut_frame(self, axis: int) -> None:
        values = tuple(self._values.popleft() for _ in range(min(MOST_TRACE_VALUES, len(self._values))))
        self._frames.append(TraceNotice(axis, self._every_steps, self._first_step, values))
        self._first_step += len(values) * self._every_steps
