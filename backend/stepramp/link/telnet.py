"""What goes along with the bytes to a serial port of another machine by RFC 2217: telnet's commands among them.

Pure: bytes in, bytes out. Telnet is RFC 854, its options are agreed upon as RFC 1143 has it, without its queues, since
nothing is ever switched off; that every byte may travel is RFC 856, that of the serial port RFC 2217.
"""

from enum import Enum, auto

IAC = 0xFF
"""Begins a command; as a byte of what is carried it is doubled."""
DONT, DO, WONT, WILL = 0xFE, 0xFD, 0xFC, 0xFB
SB, SE = 0xFA, 0xF0
"""Begin and end what is said about an option that both agree on."""
BINARY, SUPPRESS_GO_AHEAD, COM_PORT = 0, 3, 44
SET_BAUDRATE, SET_DATASIZE, SET_PARITY, SET_STOPSIZE, SET_CONTROL, PURGE_DATA = 1, 2, 3, 4, 5, 12
ANSWER = 100
"""So much more is the code of a server's answer than that of what it answers."""
NO_FLOW_CONTROL, DTR_ON, RTS_ON = 1, 8, 11
BOTH_BUFFERS = 3
LONGEST_ABOUT_OPTION = 256
"""So much may be said about an option at a time; what goes on for longer is noise [bytes]."""


class Agreement(Enum):
    """How far two have come about an option."""

    ASKED = auto()
    MADE = auto()
    REFUSED = auto()


class Telnet:
    """The telnet of one connection, as the side that began it.

    baud_rate: what the serial port there is to be set to, with 8 data bits, no parity and 1 stop bit.
    """

    def __init__(self, baud_rate: int) -> None:
        settings = {SET_BAUDRATE: baud_rate.to_bytes(4), SET_DATASIZE: b"\x08", SET_PARITY: b"\x01"}
        self._settings = settings | {SET_STOPSIZE: b"\x01"}
        self._baud_rate = baud_rate
        self._ours = dict.fromkeys((BINARY, SUPPRESS_GO_AHEAD, COM_PORT), Agreement.ASKED)
        self._theirs = dict.fromkeys((BINARY, SUPPRESS_GO_AHEAD), Agreement.ASKED)
        self._unset = set(self._settings)
        self._rest = b""
        self.trouble: str | None = None
        """Why bytes can't be carried, as the end of a sentence about the other side."""

    @property
    def is_ready(self) -> bool:
        """Whether the serial port is set, and all bytes get there as they are."""
        made = (self._ours[BINARY], self._theirs[BINARY], self._ours[COM_PORT])
        return not self._unset and all(each is Agreement.MADE for each in made)

    def opening(self) -> bytes:
        """Return what is to be said first."""
        ours = b"".join(bytes((IAC, WILL, each)) for each in self._ours)
        return ours + b"".join(bytes((IAC, DO, each)) for each in self._theirs)

    def escaped(self, data: bytes) -> bytes:
        """Return bytes as they are sent."""
        return data.replace(b"\xff", b"\xff\xff")

    def feed(self, data: bytes) -> tuple[bytes, bytes]:
        """Take what has come in, however it was cut; return the bytes that it carries, and what is to be answered."""
        carried, answer, rest = bytearray(), bytearray(), self._rest + data
        while (at := rest.find(IAC)) >= 0:
            carried += rest[:at]
            rest = rest[at:]
            length = _length(rest)
            if length == 0:
                break
            if rest[1] == IAC:
                carried.append(IAC)
            answer += self._answer(rest[:length])
            rest = rest[length:]
        else:
            carried += rest
            rest = b""
        self._rest = rest
        return bytes(carried), bytes(answer)

    def _answer(self, command: bytes) -> bytes:
        match command[1]:
            case 0xFD | 0xFE:
                return self._agree(self._ours, command[2], wanted=command[1] == DO, yes=WILL, no=WONT)
            case 0xFB | 0xFC:
                return self._agree(self._theirs, command[2], wanted=command[1] == WILL, yes=DO, no=DONT)
            case 0xFA if command.endswith(bytes((IAC, SE))):
                self._note(command[2:-2].replace(b"\xff\xff", b"\xff"))
        return b""

    def _agree(self, agreements: dict[int, Agreement], option: int, *, wanted: bool, yes: int, no: int) -> bytes:
        """Note what the other side says of an option; return what is to be said to that: never the same again."""
        before = agreements.get(option)
        # That the other side sets a serial port of ours, too, is a thing to say, though nothing comes of it.
        is_welcome = before in (Agreement.ASKED, Agreement.MADE) or (before is None and option == COM_PORT)
        agreements[option] = now = Agreement.MADE if wanted and is_welcome else Agreement.REFUSED
        if now is Agreement.REFUSED and option in (BINARY, COM_PORT):
            what = "RFC 2217" if option == COM_PORT else "all bytes as they are (telnet's BINARY)"
            self.trouble = f"refuses to carry {what}"
        says = (
            b""
            if now is before or before is Agreement.ASKED
            else bytes((IAC, yes if wanted and is_welcome else no, option))
        )
        if before is None and not wanted:
            says = b""
        if agreements is self._ours and option == COM_PORT and now is Agreement.MADE and before is Agreement.ASKED:
            says += self._port_set_up()
        return says

    def _port_set_up(self) -> bytes:
        """Return what sets the serial port, and raises its lines as opening it here would."""
        lines = [(SET_CONTROL, bytes((each,))) for each in (NO_FLOW_CONTROL, DTR_ON, RTS_ON)]
        said = [*self._settings.items(), (PURGE_DATA, bytes((BOTH_BUFFERS,))), *lines]
        return b"".join(
            bytes((IAC, SB, COM_PORT, code)) + self.escaped(value) + bytes((IAC, SE)) for code, value in said
        )

    def _note(self, said: bytes) -> None:
        """Note what is said about an option: here only what the serial port was set to."""
        if len(said) < 2 or said[0] != COM_PORT or (wanted := self._settings.get(said[1] - ANSWER)) is None:
            return
        if said[2:] == wanted:
            self._unset.discard(said[1] - ANSWER)
        elif said[1] == SET_BAUDRATE + ANSWER:
            self.trouble = f"sets its port to {int.from_bytes(said[2:]):,} baud, not to {self._baud_rate:,}"
        else:
            self.trouble = "doesn't set its port to 8 data bits, no parity and 1 stop bit"


def _length(rest: bytes) -> int:
    """Return the length of the command that these bytes begin with; 0 while its end hasn't come."""
    if len(rest) < 2:
        return 0
    if rest[1] in (DONT, DO, WONT, WILL):
        return 3 if len(rest) >= 3 else 0
    if rest[1] != SB:
        return 2
    said, at = rest[:LONGEST_ABOUT_OPTION], 2
    while 0 <= (at := said.find(IAC, at)) < len(said) - 1:
        if said[at + 1] == SE:
            return at + 2
        at += 2
    return LONGEST_ABOUT_OPTION if len(said) == LONGEST_ABOUT_OPTION else 0
