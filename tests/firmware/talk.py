"""What is said to the controller in a conversation that is played to the cycle."""

import struct
from dataclasses import dataclass, field

from firmware.checker import CYCLES_PER_S
from firmware.protocol import (
    BEGIN,
    DATA,
    END,
    HELLO,
    TRY,
    WRITE_SETTINGS,
    InputSettings,
    Settings,
    crc16,
    encode_frame,
    image_parts,
)
from simulator.avr import TimedFrame

SESSION = 0x5354
CYCLES_PER_MS, CYCLES_PER_US = CYCLES_PER_S // 1000, CYCLES_PER_S // 1_000_000


@dataclass
class Talk:
    """Frames, in the order in which they are said."""

    asked: list[TimedFrame] = field(default_factory=list)
    tag: int = 0

    def frame(self, kind: int, body: bytes = b"", session: int = SESSION) -> bytes:
        """Return a request with a tag of its own."""
        self.tag = (self.tag + 1) & 0xFF
        return encode_frame(struct.pack("<BHB", kind, session, self.tag) + body)

    def ask(self, kind: int, body: bytes = b"", *, wait_ms: float = 0.0, quiet_ms: float = 0.0) -> None:
        """Ask for something, some time after the answer before."""
        wait, quiet = int(wait_ms * CYCLES_PER_MS), int(quiet_ms * CYCLES_PER_MS)
        self.asked.append(TimedFrame(self.frame(kind, body), wait_cycles=wait, quiet_cycles=quiet))

    def begin(self, ramps: bytes, outputs: Settings | None = None, inputs: InputSettings | None = None) -> None:
        """Have ramps used on trial, with settings; inputs make it a client of version 3."""
        self.ask(HELLO, b"\2" if inputs is None else b"\3")
        self.ask(WRITE_SETTINGS, (outputs or Settings()).packed() + (b"" if inputs is None else inputs.packed()))
        self.ask(BEGIN, struct.pack("<HH", len(ramps), crc16(ramps)))
        for part in image_parts(ramps):
            self.ask(DATA, part)
        self.ask(END)
        self.ask(TRY)
