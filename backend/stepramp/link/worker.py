"""One thread a port that owns it: others hand it calls and wait for the results.

Urgent calls (stop and halt) go first, also between two frames of a long call, which lets them through with `give_way`.
They refuse the calls that still wait: a move asked for before a stop must not begin after it.
"""

import logging
import threading
from collections import deque
from collections.abc import Callable
from concurrent.futures import Future
from functools import partial
from time import monotonic
from typing import Any, TypeVar

from stepramp.errors import DeviceLost, Refused, StepRampError

_logger = logging.getLogger(__name__)

T = TypeVar("T")
DISCONNECTED = "The device was disconnected."
_Call = tuple[Future[Any], Callable[[], Any]]


class Worker:
    """The thread of one port. It ends when it is closed, when a call or a poll raises DeviceLost, or a call says so.

    poll: called when nothing else is to be done; returns after how many seconds it wants to be called again.
    ended: called once, last, in the thread: with the loss that ended it, or None when it was closed.
    """

    def __init__(self, name: str, poll: Callable[[], float], ended: Callable[[DeviceLost | None], None]) -> None:
        self._poll = poll
        self._ended = ended
        self._changed = threading.Condition()
        self._urgent: deque[_Call] = deque()
        self._waiting: deque[_Call] = deque()
        self._closed = False
        self._closed_since = DISCONNECTED
        """Why it is closed, as a sentence for those who wait."""
        self._loss: DeviceLost | None = None
        self._last_words: list[Callable[[], None]] = []
        """Tell callers what has come of calls in the midst of which the device was lost."""
        self._in_urgent_call = False
        self._says_farewell = False
        self._thread = threading.Thread(target=self._run, name=f"port {name}", daemon=True)
        self._thread.start()

    def call(self, job: Callable[[], T]) -> T:
        """Run a job in the thread, after those that wait already, and return its result or raise what it raised.

        Raises DeviceLost when the device is lost before, Refused when a stop or the closing came first.
        """
        with self._changed:
            future = self._enqueue(job, self._waiting)
        return future.result()

    def call_urgently(self, job: Callable[[], T], *, overtakes: bool = True) -> "Future[T]":
        """Let a job run next, and return its result to come. overtakes: the ordinary calls that wait are refused.

        Raises DeviceLost or Refused when the thread has ended.
        """
        with self._changed:
            future = self._enqueue(job, self._urgent)
            overtaken = list(self._waiting) if overtakes else []
            if overtakes:
                self._waiting.clear()
        for waiting, _ in overtaken:
            waiting.set_exception(Refused("A stop came first; nothing was done."))
        return future

    def give_way(self, pause_s: float = 0.0) -> None:
        """Run the urgent calls that wait, and those that come within a pause [s]: for long calls, between frames.

        Raises DeviceLost when one of them found the device lost, Refused when the thread is to end.
        """
        if self._in_urgent_call or self._says_farewell:
            return
        deadline = monotonic() + pause_s
        while (call := self._next_call(deadline, urgent_only=True)) is not None:
            self._in_urgent_call = True
            try:
                self._serve(call)
            finally:
                self._in_urgent_call = False
        if self._loss is not None or self._closed:
            raise self._end_error()

    def lose(self, why: StepRampError) -> None:
        """End the thread as of a lost device once the present call is done, whose caller is given what comes of it.

        For a call, in the thread, that has done what it was for when it finds that out.
        """
        with self._changed:
            self._loss = why if isinstance(why, DeviceLost) else DeviceLost(str(why))

    def close(self, wait_s: float | None = None, why: str = DISCONNECTED) -> None:
        """End the thread once its present call is done or gives way, and wait for that; calls that wait are refused.

        wait_s: wait only so long [s]. why: a sentence for those who wait.
        """
        with self._changed:
            if not self._closed:
                self._closed_since = why
            self._closed = True
            self._changed.notify_all()
        if threading.current_thread() is not self._thread:
            self._thread.join(wait_s)

    def _enqueue(self, job: Callable[[], T], queue: deque[_Call]) -> "Future[T]":
        if self._closed or self._loss is not None:
            raise self._end_error()
        future: Future[T] = Future()
        # A call that was handed over is carried out, also when nobody waits for it any more: a stop above all.
        future.set_running_or_notify_cancel()
        queue.append((future, job))
        self._changed.notify_all()
        return future

    def _run(self) -> None:
        poll_at = monotonic()
        try:
            while not self._closed and self._loss is None:
                call = self._next_call(poll_at)
                if call is not None:
                    self._serve(call)
                    poll_at = monotonic()
                elif not self._closed:
                    pause_s = self._poll_once()
                    poll_at = monotonic() + pause_s
        finally:
            # Also after a mistake of ours in a poll: nobody must wait for a thread that is no more.
            self._end()

    def _next_call(self, deadline: float, *, urgent_only: bool = False) -> _Call | None:
        """Wait for a call up to a deadline of the monotonic clock [s]; None when none came or the thread shall end."""
        with self._changed:
            while True:
                if self._urgent:
                    return self._urgent.popleft()
                wait_s = deadline - monotonic()
                # A poll that is due goes before: what it sees to must not wait for however many calls.
                if self._waiting and not urgent_only and not self._closed and wait_s > 0:
                    return self._waiting.popleft()
                if wait_s <= 0 or self._closed or self._loss is not None:
                    return None
                self._changed.wait(wait_s)

    def _serve(self, call: _Call) -> None:
        future, job = call
        try:
            result = job()
        except DeviceLost as loss:
            # The caller hears of it last, when everyone can see that the device is lost.
            with self._changed:
                self._loss = loss
                self._waiting.append(call)
        except Exception as error:
            self._tell(partial(future.set_exception, error))
        else:
            self._tell(partial(future.set_result, result))

    def _tell(self, tell: Callable[[], None]) -> None:
        """Tell a caller what has come of a call: last, where the device was lost, as above."""
        if self._loss is None:
            tell()
        else:
            self._last_words.append(tell)

    def _poll_once(self) -> float:
        try:
            return self._poll()
        except StepRampError as error:
            self.lose(error)
            return 0.0

    def _end(self) -> None:
        with self._changed:
            self._closed = self._says_farewell = True
            left = [*self._urgent, *self._waiting]
            self._urgent.clear()
            self._waiting.clear()
        try:
            self._ended(self._loss)
        except Exception:
            _logger.exception("The end of a port's thread could not be told.")
        for tell in self._last_words:
            tell()
        for future, _ in left:
            future.set_exception(self._end_error())

    def _end_error(self) -> StepRampError:
        return self._loss or Refused(self._closed_since)
