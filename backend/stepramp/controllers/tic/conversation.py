"""A conversation with a Tic: commands, which it doesn't answer, and blocks of its memory, which it is asked for."""

from collections.abc import Callable
from time import monotonic

from stepramp.controllers.tic.variables import GENERAL, SERIAL_OPTIONS, Block, General, SerialOption
from stepramp.controllers.tic.wire import crc7, read
from stepramp.errors import DeviceLost, Refused
from stepramp.link.connection import Connection

ANSWER_S = 0.2
"""So long an answer is waited for [s]: 15 bytes take 17 ms at 9600 baud, and a USB adapter may keep them 16 ms."""
GIVE_WAY_S = 0.05
"""So long a more urgent call waits for what comes in at most [s]; an answer is mostly there by then."""
MOST_REPEATS = 3
"""So often what a disturbed line has swallowed or damaged is said again."""
MOST_LATE = 10
"""So many pieces of late answers, or of noise, are waited for."""
MOST_GREETINGS = 3


class Conversation:
    """All that is said over an open port.

    give_way: called before each block is asked for, and while an answer or silence is waited for, for other calls that
    are more urgent. They may send and ask, too.
    """

    def __init__(self, port: Connection, give_way: Callable[[float], None]) -> None:
        self._port = port
        self._give_way = give_way
        self._commands_have_crc = False
        self._answers_have_crc = False
        self._asked = 0
        """How many questions there were."""
        self._answer_due_s = 0.0
        """Until when the last one is usually answered, by the monotonic clock [s]."""
        self._is_settled = True
        """Nothing comes in any more that answers an earlier question."""

    def begin(self) -> None:
        """Find out whether a Tic is there, and ask it whether it wants CRCs, and sends some. Nothing moves by it.

        Raises DeviceLost when nothing answers, Refused when something does that is no Tic.
        """
        heard = b""
        for with_crc in (False, True) * MOST_GREETINGS:
            self._give_way(0.0)
            heard += self._port.pending()
            self._commands_have_crc = with_crc
            self._ask_for(GENERAL)
            # One byte more than without a CRC, so that one that follows is seen.
            answer = self._hear(GENERAL.length + 1, ANSWER_S)
            self._answers_have_crc = len(answer) > GENERAL.length
            if _is_of_a_tic(self._whole(answer, GENERAL)):
                self._is_settled = True
                self._learn_options()
                return
            heard += answer
        if heard:
            raise Refused(f"Something talks at {self._port.name}, but it is no Tic, or its baud rate is another one.")
        raise DeviceLost(
            f"Nothing answers at {self._port.name} as a Tic does: has it power, do RX and TX cross, is its baud rate "
            "9600? A controller of another family is to be connected as that."
        )

    def send(self, *commands: bytes) -> None:
        """Send commands in one go. Whether they arrived is to be seen from what the Tic then says."""
        self._port.write(b"".join(self._checked(command) for command in commands))

    def read(self, block: Block) -> tuple[int, ...]:
        """Return the values of a block; DeviceLost when it never comes whole."""
        for _ in range(1 + MOST_REPEATS):
            self._give_way(0.0)
            data = self._answer(block)
            if data is not None:
                return block.unpack(data)
        raise DeviceLost(f"The Tic at {self._port.name} does not answer.")

    def _learn_options(self) -> None:
        """Ask what the Tic is set to: one that wants no CRCs answers with them, too, and takes them for mistakes."""
        options = SerialOption(self.read(SERIAL_OPTIONS)[0])
        self._commands_have_crc = SerialOption.CRC_FOR_COMMANDS in options
        self._answers_have_crc = SerialOption.CRC_FOR_RESPONSES in options

    def _answer(self, block: Block) -> bytes | None:
        """Ask for a block and return its data; None when it doesn't come whole.

        It is asked for anew when something more urgent has asked meanwhile, and so dropped the answer.
        """
        while True:
            is_doubtful = not self._is_settled
            if is_doubtful:
                self._await_silence()
            self._port.pending()  # Noise.
            self._ask_for(block)
            asked = self._asked
            data = self._whole(self._hear(block.length + self._answers_have_crc, ANSWER_S), block)
            if self._asked == asked:
                break
        if data is not None:
            # Answers don't say to what: one that was given up mustn't be taken for that to the next question.
            if is_doubtful:
                self._await_silence()
            self._is_settled = True
        return data

    def _ask_for(self, block: Block) -> None:
        self._asked += 1
        self._answer_due_s = monotonic() + ANSWER_S
        self._is_settled = False
        self.send(read(block.command, block.offset, block.length))

    def _checked(self, command: bytes) -> bytes:
        return command + bytes([crc7(command)]) if self._commands_have_crc else command

    def _hear(self, most: int, time_s: float) -> bytes:
        """Return what comes in until there are so many bytes, time is up [s], or something more urgent has asked."""
        heard, asked, now_s = b"", self._asked, monotonic()
        deadline_s, give_way_s = now_s + time_s, now_s + GIVE_WAY_S
        while len(heard) < most and self._asked == asked and now_s < deadline_s:
            heard += self._port.read(min(deadline_s, give_way_s) - now_s)
            now_s = monotonic()
            if now_s >= give_way_s and len(heard) < most:
                self._give_way(0.0)
                now_s = monotonic()
                give_way_s = now_s + GIVE_WAY_S
        return heard

    def _await_silence(self) -> None:
        """Drop what comes in until nothing does, or it never ends."""
        wait_s = max(0.0, self._answer_due_s - monotonic()) + ANSWER_S
        for _ in range(MOST_LATE):
            asked = self._asked
            heard = self._hear(1, wait_s)
            # Also when pieces come so fast that nothing else gives way.
            self._give_way(0.0)
            if not heard and self._asked == asked:
                return
            wait_s = ANSWER_S

    def _whole(self, answer: bytes, block: Block) -> bytes | None:
        """Return the data of an answer; None when it is too short, too long, or not what its CRC says."""
        data = answer[: block.length]
        crc = bytes([crc7(data)]) if self._answers_have_crc else b""
        return data if len(data) == block.length and answer == data + crc else None


def _is_of_a_tic(data: bytes | None) -> bool:
    """Tell whether a Tic may have said so: also of noise, which is nothing but zeros on a line that is held low."""
    if data is None or not any(data):
        return False
    try:
        General.of(*GENERAL.unpack(data))
    except ValueError:
        return False
    return True
