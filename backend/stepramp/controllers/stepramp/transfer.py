"""Ramp images on their way to a controller and back."""

from collections.abc import Callable
from time import monotonic

from stepramp.controllers.progress import Progress, PushStage, Tell
from stepramp.controllers.stepramp.conversation import Conversation
from stepramp.controllers.stepramp.frames import crc16
from stepramp.controllers.stepramp.messages.body import DoneReply
from stepramp.controllers.stepramp.messages.ramps import (
    MOST_DATA,
    BeginRequest,
    CommitRequest,
    DataReply,
    DataRequest,
    EndReply,
    EndRequest,
    ReadReply,
    ReadRequest,
    ReadSource,
    TryRequest,
)
from stepramp.controllers.stepramp.messages.status import MachineState, StatusFlag, StatusReply, StatusRequest
from stepramp.errors import Refused

WRITE_POLL_S = 0.02
WRITE_TIMEOUT_S = 10.0
"""Two slots of 512 bytes at 3.4 ms a byte, and more than twice that for slower memory."""


class Transfer:
    """What moves ramp images over a conversation.

    give_way: called while the controller writes, with how long there is time for other calls [s].
    tell: called with how far a transfer has come.
    """

    def __init__(
        self, conversation: Conversation, give_way: Callable[[float], None], tell: Tell = lambda _: None
    ) -> None:
        self._conversation = conversation
        self._give_way = give_way
        self._tell = tell

    def deliver(self, image: bytes) -> None:
        """Send an image and read it back from RAM; Refused when the controller can't take it, or holds another."""
        ask = self._conversation.ask
        ask(BeginRequest(len(image), crc16(image)), DoneReply)
        for offset in range(0, len(image), MOST_DATA):
            self._tell(Progress(PushStage.SENDING, offset, len(image)))
            ask(DataRequest(offset, image[offset : offset + MOST_DATA]), DataReply)
        ask(EndRequest(), EndReply)
        if self.read(ReadSource.RAM, PushStage.CHECKING) != image:
            raise Refused("The controller's memory holds another ramp than the one sent; it keeps the one it had.")

    def try_out(self) -> None:
        """Have the delivered image used, without storing it."""
        self._conversation.ask(TryRequest(), DoneReply)

    def commit(self) -> StatusReply:
        """Have what is in RAM stored, and return the status once it is; Refused when it can't be."""
        self._tell(Progress(PushStage.STORING, 0, 0))
        self._conversation.ask(CommitRequest(), DoneReply)
        return self.await_written()

    def await_written(self) -> StatusReply:
        """Return the status once all is stored that is being stored; Refused when it can't be."""
        deadline = monotonic() + WRITE_TIMEOUT_S
        while (reply := self._conversation.ask(StatusRequest(0), StatusReply)).state == MachineState.WRITING:
            if monotonic() >= deadline:
                raise Refused(f"The controller has been storing the ramp for {WRITE_TIMEOUT_S:g} s without an end.")
            self._give_way(WRITE_POLL_S)
        if reply.flags & StatusFlag.WRITE_FAILED:
            raise Refused("The controller could not store the ramp in its memory; it keeps the one it had.")
        return reply

    def read(self, source: ReadSource, stage: PushStage = PushStage.READING_BACK) -> bytes:
        """Return a whole ramp image; empty when there is none."""
        data = b""
        while True:
            reply = self._conversation.ask(ReadRequest(source, len(data), MOST_DATA), ReadReply)
            data += reply.data
            self._tell(Progress(stage, len(data), reply.total_bytes))
            if not reply.data or len(data) >= reply.total_bytes:
                return data
