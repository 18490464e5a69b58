"""A conversation with a Tic: commands, which it doesn't answer, and blocks of its memory, which it is asked for."""

from collections.abc import Callable

from stepramp.controllers.tic.variables import GENERAL, SERIAL_OPTIONS, Block, General, SerialOption
from stepramp.controllers.tic.wire import crc7, read
from stepramp.errors import DeviceLost, Refused
from stepramp.link.connection import Connection
from stepramp.link.hearing import Hearing

ANSWER_S = 0.2
"""So long an answer is waited for [s]: 15 bytes take 17 ms at 9600 baud, and a USB adapter may keep them 16 ms."""
MOST_REPEATS = 3
"""So often what a disturbed line has swallowed or damaged is said again."""
MOST_GREETINGS = 3


class Conversation:
    """All that is said over an open port.

    give_way: called before each block is asked for, and while an answer or silence is waited for, for other calls that
    are more urgent. They may send and ask, too.
    """

    def __init__(self, port: Connection, give_way: Callable[[float], None]) -> None:
        self._port = port
        self._give_way = give_way
        self._hearing = Hearing(port, give_way)
        self._commands_have_crc = False
        self._answers_have_crc = False
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
            answer = self._hearing.hear(GENERAL.length + 1, ANSWER_S)
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
                self._hearing.await_silence(ANSWER_S)
            self._port.pending()  # Noise.
            self._ask_for(block)
            asked = self._hearing.asked
            data = self._whole(self._hearing.hear(block.length + self._answers_have_crc, ANSWER_S), block)
            if self._hearing.asked == asked:
                break
        if data is not None:
            # Answers don't say to what: one that was given up mustn't be taken for that to the next question.
            if is_doubtful:
                self._hearing.await_silence(ANSWER_S)
            self._is_settled = True
        return data

    def _ask_for(self, block: Block) -> None:
        self._hearing.note_question(ANSWER_S)
        self._is_settled = False
        self.send(read(block.command, block.offset, block.length))

    def _checked(self, command: bytes) -> bytes:
        return command + bytes([crc7(command)]) if self._commands_have_crc else command

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
