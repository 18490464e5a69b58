"""STOP over the WebSocket of events, which every page has open already.

A browser has six connections to a server for all its tabs together: while they wait for plannings, a request to stop
would wait, too. A WebSocket doesn't count among them.
"""

import asyncio
import threading
from collections import deque
from collections.abc import AsyncGenerator, Callable
from contextlib import ExitStack

from stepramp.devices.registry import Devices
from stepramp.errors import Rejected, Rejection, StepRampError
from stepramp.http_api.error_items import ErrorItem, error_items
from stepramp.http_api.json_response import json_bytes
from stepramp.http_api.sockets import parsed
from stepramp.http_api.stopping import halt_whole, stop_every
from stepramp.http_api.stopping_models import LONGEST_MESSAGE, StopMessage, StopMessageAnswer, meant_by

ALLOWED = 'a JSON object such as {"do": "stop"}'
MOST_AT_A_TIME = 16
"""So many messages of a socket are seen to at a time, the next ones wait. So many answers wait to be sent."""


class PendingAnswer:
    """An answer, made in the instant at which it is written: only then a stop is answered.

    until_then: ends when that is done, or given up. For any thread.
    """

    def __init__(self, make: Callable[[], str], until_then: ExitStack | None = None) -> None:
        self._make = make
        self._lock = threading.Lock()
        self._until_then = ExitStack() if until_then is None else until_then

    def made(self) -> str:
        """Return its text, which is written at once."""
        self.give_up()
        return self._make()

    def give_up(self) -> None:
        """Let go of what waits for it, if that has not been done."""
        with self._lock:
            self._until_then.close()


class PendingAnswers:
    """What is to be answered over a socket. Whoever doesn't read the answers gets only the newest of them.

    So a client that reads nothing is heard all the same, and nothing piles up meanwhile.
    """

    def __init__(self) -> None:
        self._given: deque[PendingAnswer] = deque(maxlen=MOST_AT_A_TIME)
        self._came = asyncio.Event()

    def add(self, answer: PendingAnswer) -> None:
        """Have something answered."""
        if len(self._given) == MOST_AT_A_TIME:
            self._given[0].give_up()
        self._given.append(answer)
        self._came.set()

    async def given(self) -> AsyncGenerator[PendingAnswer, None]:
        """Yield one answer after the other, for as long as it is asked for more."""
        while True:
            await self._came.wait()
            while self._given:
                yield self._given.popleft()
            self._came.clear()

    def give_up(self) -> None:
        """Let go of all that hasn't been given."""
        for answer in self._given:
            answer.give_up()


async def answered(text: str | bytes, devices: Devices) -> PendingAnswer:
    """Stop or halt as a message asks, and return what makes the answer.

    Its `did` says what was done, its `errors` why it wasn't, or what of the message can't be used. A stop is obeyed
    whatever else the message says.
    """
    odd: list[ErrorItem] | None = None
    try:
        if len(text) > LONGEST_MESSAGE:
            raise Rejected([Rejection("message", text, f"{ALLOWED}, of up to {LONGEST_MESSAGE:,} characters")])
        message = StopMessage.checked(parsed(text, ALLOWED))
    except Rejected as error:
        odd, meant = error_items(error), meant_by(text)
        if meant is None:
            refused = _text(StopMessageAnswer(errors=odd))
            return PendingAnswer(lambda: refused)
        message = meant
    with ExitStack() as stopping:
        try:
            if message.device is None:
                stopping.enter_context(devices.being_stopped())
                odd = [*(odd or ()), *await stop_every(devices)] or None
            else:
                device = devices.get(message.device)
                stopping.enter_context(device.being_stopped())
                await halt_whole(device)
        except StepRampError as error:
            failed = _text(StopMessageAnswer(did=message, errors=[*(odd or ()), *error_items(error)]))
            return PendingAnswer(lambda: failed, stopping.pop_all())
        until_then = stopping.pop_all()

    def done() -> str:
        told = {} if odd is None else {"errors": odd}
        return _text(StopMessageAnswer.model_validate({"did": message, "devices": devices.views(), **told}))

    return PendingAnswer(done, until_then)


def _text(answer: StopMessageAnswer) -> str:
    return json_bytes(answer).decode()
