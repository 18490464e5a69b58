"""A conversation with a controller: requests that are repeated until they are answered, and what it says in between."""

import secrets
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from time import monotonic
from typing import TypeVar

from stepramp.controllers.contract import AnswerUnknown
from stepramp.controllers.inputs import StopCause
from stepramp.controllers.stepramp.frames import FrameSplitter, encode_frame
from stepramp.controllers.stepramp.input_roles import InputRole
from stepramp.controllers.stepramp.messages.body import Notice, Reply, Request
from stepramp.controllers.stepramp.messages.kinds import NOTICE_KINDS, unpack_notice
from stepramp.controllers.stepramp.messages.message import REPLY, Message
from stepramp.controllers.stepramp.messages.motion import HaltRequest, StopRequest
from stepramp.controllers.stepramp.messages.reply import Refusal, ReplyStatus, unpack_reply
from stepramp.controllers.stepramp.messages.session import (
    OLDEST_VERSION,
    PROTOCOL_VERSION,
    HelloReply,
    HelloRequest,
)
from stepramp.controllers.stepramp.refusals import exception_for
from stepramp.controllers.stepramp.soft_limits import SoftLimit
from stepramp.errors import DeviceLost, Rejection
from stepramp.link.connection import Connection

HELLO_INTERVAL_S = 0.25
MOST_HELLOS = 16
"""Many boards reset when their port is opened, and are deaf for up to 2 s; others take longer. With what a port that
never falls silent is listened to before, it is over within 5 s."""
GARBAGE_S = 0.05
MOST_GARBAGE_S = 0.5
"""A controller may still be telling an earlier client what it does; the hello ends that."""
FIRST_COMMAND = 0x80
"""To controllers that obey single bytes, as a Pololu Tic does, bytes from here on are commands."""
REPLY_TIMEOUT_S = 0.2
MOST_REPEATS = 3

ANSWERS_TO_STOPS = (StopRequest.KIND | REPLY, HaltRequest.KIND | REPLY)

R = TypeVar("R", bound=Reply)


class Conversation:
    """One session over an open port.

    give_way: called before each request, and before it is repeated, for other calls that are more urgent.
    """

    def __init__(self, port: Connection, give_way: Callable[[float], None]) -> None:
        self._port = port
        self._give_way = give_way
        self._splitter = FrameSplitter()
        self._inbox: deque[Message] = deque()
        self._notices: deque[Notice] = deque()
        self._session = 0
        self._version = PROTOCOL_VERSION
        self._tag = 0xFF
        self._requests_made = 0
        self._heard_bytes = self._heard_messages = 0
        self.stops_of_others = 0
        """Stops and halts that were answered to somebody else on this line, such as those that are bytes alone."""
        self.roles: Sequence[InputRole] = ()
        """What the controller's inputs are for: refusals name those that are in the way."""
        self.stopped_by: Callable[[], tuple[StopCause, ...]] = tuple
        """Asks what has stopped motion: refusals name it."""
        self.moving_axis: Callable[[], int | None] = lambda: None
        """Tells an axis that moves, as last heard."""
        self.soft_limits: Sequence[SoftLimit] = ()
        """Those that the controller keeps: refusals tell them."""

    @property
    def requests_made(self) -> int:
        """How many requests there were: more than one's own when others came in between."""
        return self._requests_made

    def begin(self) -> HelloReply:
        """Shake hands: drop what a reset left on the line, then say hello until it is answered.

        With a controller of an older version that is known here, it goes on in that.

        Later once more: in the same session, so that the controller knows what more urgent calls say meanwhile.
        Raises DeviceLost when nothing answers or what talks there is no StepRamp controller, Refused when another
        protocol version does.
        """
        if not self._session:
            self._session = _new_session()
        began = monotonic()
        while monotonic() < began + MOST_GARBAGE_S and (garbage := self._port.read(GARBAGE_S)):
            self._heard_bytes += len(garbage)
        reply = self._say_hello()
        if isinstance(reply, Refusal) and self._speaks_older(reply):
            self._version = reply.detail
            reply = self._say_hello()
        if isinstance(reply, Refusal):
            raise exception_for(reply, None)
        return reply

    def _speaks_older(self, refusal: Refusal) -> bool:
        is_older = OLDEST_VERSION <= refusal.detail < self._version
        return refusal.status is ReplyStatus.BAD_VERSION and is_older

    def _say_hello(self) -> HelloReply | Refusal:
        message = _harmless_hello(self._session, self._tag, self._version)
        self._tag = message.tag
        for _ in range(MOST_HELLOS):
            self._give_way(0.0)
            # The lone zero ends whatever noise the board took for the beginning of a frame.
            self._port.write(b"\0" + encode_frame(message.pack()))
            reply = self._await_reply(message, HELLO_INTERVAL_S)
            if reply is not None:
                return self._unpacked(reply, HelloReply)
        if self._heard_bytes and not self._heard_messages:
            raise DeviceLost(f"Something talks at {self._port.name}, but it is not a StepRamp controller.")
        raise DeviceLost(f"Nothing answers at {self._port.name}: is it a StepRamp controller, and has it power?")

    def ask(self, request: Request, reply_type: type[R], rejected: Callable[[Refusal], Rejection] | None = None) -> R:
        """Return the reply to a request, which is repeated when the answer is lost.

        rejected: returns what is wrong with the values that were asked for, when the controller finds them too far or
        too fast. Raises Rejected then, Refused for other refusals, DeviceLost when there is no answer, AnswerUnknown
        when another request came in between, so that the repeat of what must not be done twice were a new one.
        """
        self._give_way(0.0)
        self._tag = (self._tag + 1) % 256
        self._requests_made += 1
        message = Message(request.KIND, self._session, self._tag, request.pack())
        for attempt in range(1 + MOST_REPEATS):
            if attempt:
                self._give_way(0.0)
            if message.tag != self._tag and not request.HARMLESS_TWICE:
                raise AnswerUnknown("Something came in between, and the controller's answer was lost: try again.")
            # What a noisy line has put before the first frame may still wait for its end: a lone zero.
            self._port.write((b"\0" if attempt else b"") + encode_frame(message.pack()))
            reply = self._await_reply(message, REPLY_TIMEOUT_S)
            if reply is not None:
                return self._understood(reply, reply_type, rejected)
        raise DeviceLost(f"The controller at {self._port.name} does not answer.")

    def listen(self) -> None:
        """Take what has come in by now, without waiting for more."""
        self._take(self._port.pending())
        while self._inbox:
            self._sort(self._inbox.popleft())

    def notices(self) -> Iterator[Notice]:
        """Yield what the controller said unasked before the last reply, or the last time it was listened to."""
        while self._notices:
            yield self._notices.popleft()

    def _await_reply(self, request: Message, timeout_s: float) -> Message | None:
        """Return the reply to a request; what else comes in is unasked, the answer to an earlier one, or noise."""
        expected = (request.kind | REPLY, request.session, request.tag)
        deadline = monotonic() + timeout_s
        while True:
            while self._inbox:
                message = self._inbox.popleft()
                if (message.kind, message.session, message.tag) == expected:
                    return message
                self._sort(message)
            left_s = deadline - monotonic()
            if left_s <= 0:
                return None
            self._take(self._port.read(left_s))

    def _take(self, data: bytes) -> None:
        unpacked = (Message.unpack(frame) for frame in self._splitter.feed(data))
        messages = [message for message in unpacked if message is not None]
        self._inbox.extend(messages)
        self._heard_bytes += len(data)
        # What a cable sends back of our own isn't a controller's.
        self._heard_messages += sum(1 for message in messages if message.kind & REPLY)

    def _sort(self, message: Message) -> None:
        """Keep a message if it is a notice of this session; a reply that nobody waits for any more is dropped.

        What has stopped at the word of somebody else rests as surely as at ours: that is counted.
        """
        if message.kind in ANSWERS_TO_STOPS and message.session != self._session:
            self.stops_of_others += 1
        if message.kind in NOTICE_KINDS and message.session == self._session:
            notice = unpack_notice(message)
            if notice is not None:
                self._notices.append(notice)

    def _understood(self, message: Message, reply_type: type[R], rejected: Callable[[Refusal], Rejection] | None) -> R:
        """Return a reply's body; a refusal becomes the exception that says so."""
        reply = self._unpacked(message, reply_type)
        if not isinstance(reply, Refusal):
            return reply
        if reply.status is ReplyStatus.STALE_SESSION:
            raise DeviceLost(f"The controller at {self._port.name} was restarted: its position is no longer known.")
        raise exception_for(reply, rejected, self.roles, self.soft_limits, self.stopped_by, self.moving_axis)

    def _unpacked(self, message: Message, reply_type: type[R]) -> R | Refusal:
        try:
            return unpack_reply(reply_type, message.body)
        except ValueError as error:
            raise DeviceLost(f"The controller at {self._port.name} gives answers without sense: {error}") from error


def _new_session() -> int:
    """Return a session, which is never 0, of two bytes that are no commands to a controller of another kind."""
    number = 1 + secrets.randbelow(FIRST_COMMAND**2 - 1)
    return number // FIRST_COMMAND << 8 | number % FIRST_COMMAND


def _harmless_hello(session: int, last_tag: int, version: int) -> Message:
    """Return a hello with the next tag whose frame sets nothing in motion where it meets a controller of another kind.

    Each session that _new_session returns has several such tags.
    """
    body = HelloRequest(version).pack()
    hellos = (Message(HelloRequest.KIND, session, (last_tag + count) % 256, body) for count in range(1, 257))
    return next(each for each in hellos if max(encode_frame(each.pack())) < FIRST_COMMAND)
