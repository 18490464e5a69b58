"""A conversation with Moonraker: requests of JSON-RPC, each of which it answers, and what it tells unasked."""

import json
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from math import inf
from time import monotonic
from typing import Protocol

from stepramp.controllers.klipper.seen import OBJECTS, READY, SHUTDOWN, STARTUP, Seen
from stepramp.controllers.klipper.told import told_json
from stepramp.errors import DeviceLost, Refused
from stepramp.link.connection import Connection
from stepramp.link.moonraker_port import FILE_S, Reply

ANSWER_S = 1.5
"""So long an answer is waited for [s]."""
SCRIPT_S = 4.0
"""So long that of a line of G-code is: Klipper answers once it has it in its plan, at most 2 s ahead."""
GREETING_S = 1.5
"""So long a Klipper that starts is given while somebody connects [s]."""
GOING_S = 2.0
"""So long Moonraker is given to see that Klipper has gone for a restart [s]."""
AGAIN_S = 0.25
GIVE_WAY_S = 0.05
"""So long a more urgent call waits for what comes in at most [s]."""
MOST_AT_A_TIME = 100
"""So many messages are heard until something else has its turn, as a stop."""
SCRIPT, EMERGENCY = "printer.gcode.script", "printer.emergency_stop"


class Port(Connection, Protocol):
    """An open Moonraker: a message at a time, and files."""

    def request(
        self,
        method: str,
        path: str,
        give_way: Callable[[float], None],
        body: bytes = b"",
        content_type: str = "application/json",
        time_s: float = FILE_S,
    ) -> Reply:
        """Make a request over HTTP; see MoonrakerPort."""


class Answered(Refused):
    """Moonraker, or Klipper behind it, has refused a request."""


class _Awaited:
    """What is answered to a request."""

    def __init__(self, *, moves: bool) -> None:
        self.moves = moves
        self.answer: Mapping[str, object] | None = None


class Conversation:
    """All that is said over an open port.

    give_way: called while an answer is waited for, for other calls that are more urgent. They may ask, too.
    """

    def __init__(self, port: Port, give_way: Callable[[float], None]) -> None:
        self._port = port
        self._give_way = give_way
        self._awaited: dict[int, _Awaited] = {}
        self._last = 0
        self._has_heard = False
        self._until_s = inf
        """Until when everything has to be answered [s]."""
        self._status: dict[str, dict[str, object]] = {}
        self.restarts = 0
        """How often Klipper was started anew, or went, since it was connected to."""

    @property
    def name(self) -> str:
        """The name of the port."""
        return self._port.name

    @property
    def last(self) -> Seen:
        """How it fared when it told that last."""
        return Seen.of(self._status, self.name)

    @property
    def awaits_script(self) -> bool:
        """Whether G-code was sent that isn't answered yet: it may still wait for its turn, and move something then."""
        return any(each.moves and each.answer is None for each in self._awaited.values())

    @contextmanager
    def within(self, time_s: float) -> Iterator[None]:
        """Wait for what is asked meanwhile no longer than so long [s], all of it together."""
        self._until_s = monotonic() + time_s
        try:
            yield
        finally:
            self._until_s = inf

    def begin(self) -> str:
        """Find out that it is Moonraker, and return the state of its Klipper, which is given time to start.

        Raises DeviceLost when nothing answers, Refused when something does that is no Moonraker.
        """
        deadline_s = monotonic() + GREETING_S
        while True:
            try:
                info = self.ask("server.info")
            except DeviceLost:
                if self._has_heard:
                    raise Refused(f"Something talks at {self.name}, but it is no Moonraker.") from None
                raise DeviceLost(f"Nothing answers at {self.name} as Moonraker does: does it run there?") from None
            if not isinstance(info, dict) or not isinstance(state := info.get("klippy_state"), str):
                raise Refused(f"Something talks at {self.name}, but it is no Moonraker.")
            if state != STARTUP or monotonic() > deadline_s:
                return state
            self.wait(AGAIN_S)

    def await_ready(self, restarts: int, deadline_s: float) -> str:
        """Wait until Klipper has started anew, by the monotonic clock until then [s], and return its state.

        restarts: how many there were when it was told to. Moonraker may call it ready until it sees that it has gone.
        """
        gone_s = monotonic() + GOING_S
        has_gone = False
        while True:
            self.wait(AGAIN_S)
            state, now_s = self.state(), monotonic()
            has_gone = has_gone or state != READY or self.restarts > restarts or now_s > gone_s
            if state == SHUTDOWN or (state == READY and has_gone) or now_s > deadline_s:
                return state

    def state(self) -> str:
        """Return the state of Klipper as Moonraker knows it, which answers also while Klipper doesn't."""
        info = self.ask("server.info")
        return str(info.get("klippy_state")) if isinstance(info, dict) else ""

    def subscribe(self) -> Seen:
        """Have it tell what changes from now on, and return what it tells first; see Seen."""
        told = self.ask("printer.objects.subscribe", {"objects": OBJECTS})
        self._status = {}
        self._merge(told.get("status") if isinstance(told, dict) else None)
        return self.last

    def look(self) -> Seen:
        """Return how it fares, asked now; DeviceLost when it doesn't say, or makes no sense."""
        told = self.ask("printer.objects.query", {"objects": OBJECTS})
        self._merge(told.get("status") if isinstance(told, dict) else None)
        return self.last

    def listen(self) -> Seen | None:
        """Return how it fares as it has told unasked since; None when it hasn't."""
        before, has_news = self._status, False
        for _ in range(MOST_AT_A_TIME):
            if not (message := self._port.pending()):
                break
            has_news = self._understand(message) or has_news
        return self.last if has_news and before else None

    def script(self, lines: str, *, moves: bool = True) -> None:
        """Have Klipper carry out G-code; Answered when it refuses that.

        moves: whether it may set something in motion, so that a stop waits for its answer.
        """
        self.ask(SCRIPT, {"script": lines}, SCRIPT_S, moves=moves)

    def ask(
        self,
        method: str,
        params: Mapping[str, object] | None = None,
        time_s: float = ANSWER_S,
        *,
        moves: bool = False,
    ) -> object:
        """Make a request, and return its result; Answered when it is refused, DeviceLost when nothing is said.

        moves: as in script.
        """
        self._last += 1
        number, awaited = self._last, _Awaited(moves=moves)
        request = {"jsonrpc": "2.0", "method": method, "id": number} | ({} if params is None else {"params": params})
        self._awaited[number] = awaited
        try:
            self._port.write(json.dumps(request).encode())
        except Exception:
            # Not sent, or nobody knows: a connection that is gone is not asked again.
            del self._awaited[number]
            raise
        if not self._hear_until(lambda: awaited.answer is not None, self._left_s(time_s)):
            raise DeviceLost(f"Moonraker at {self.name} does not answer.")
        del self._awaited[number]
        assert awaited.answer is not None
        if "error" in awaited.answer:
            raise Answered(f"Klipper at {self.name} says: {_words(awaited.answer['error'])}")
        return awaited.answer.get("result")

    def hear_scripts(self, time_s: float) -> bool:
        """Wait until all G-code that may move something is answered, and return whether it is."""
        return self._hear_until(lambda: not self.awaits_script, time_s)

    def request(self, method: str, path: str, body: bytes = b"", content_type: str = "application/json") -> Reply:
        """Make a request over HTTP; see MoonrakerPort."""
        return self._port.request(method, path, self._give_way, body, content_type, self._left_s(FILE_S))

    def wait(self, time_s: float) -> None:
        """Hear what comes in for so long [s]."""
        self._hear_until(lambda: False, time_s)

    def _left_s(self, time_s: float) -> float:
        return max(0.0, min(time_s, self._until_s - monotonic()))

    def _hear_until(self, is_so: Callable[[], bool], time_s: float) -> bool:
        now_s = monotonic()
        deadline_s = now_s + time_s
        while not is_so() and now_s < deadline_s:
            if message := self._port.read(min(GIVE_WAY_S, deadline_s - now_s)):
                self._understand(message)
            if not is_so():
                self._give_way(0.0)
            now_s = monotonic()
        return is_so()

    def _understand(self, message: bytes) -> bool:
        """Take a message, and return whether it tells of the state; what makes no sense is left alone."""
        self._has_heard = True
        try:
            told = told_json(message)
        except ValueError:
            return False
        if not isinstance(told, dict):
            return False
        number, method = told.get("id"), told.get("method")
        if isinstance(number, int) and (awaited := self._awaited.get(number)) is not None and method is None:
            awaited.answer = told
        elif method in ("notify_klippy_disconnected", "notify_klippy_ready"):
            self.restarts += 1
        elif method == "notify_status_update" and isinstance(told.get("params"), list) and told["params"]:
            self._merge(told["params"][0])
            return True
        return False

    def _merge(self, status: object) -> None:
        if not isinstance(status, dict):
            return
        for name, fields in status.items():
            if isinstance(fields, dict):
                self._status[name] = self._status.get(name, {}) | fields


def _words(error: object) -> str:
    """Return what is wrong as Klipper says it, which Moonraker tells as the text of a dictionary or as it is."""
    message = error.get("message") if isinstance(error, dict) else error
    text = " ".join(str(message).split())
    return text if text.endswith((".", "!")) else f"{text}."
