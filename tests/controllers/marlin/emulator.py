"""A Marlin 2.1, as its documentation and its sources say that one behaves, and a pseudo-terminal to reach it at.

Written from those alone: of the client it knows nothing. One program runs in it, as in the real one: whatever waits
(for a free place in the queue, for rest, for the second after a quick stop) looks meanwhile at what comes in, and obeys
a quick stop there and then, in the midst of what it was doing. It misbehaves as real ones do: it loses what its buffer
doesn't hold, and what comes while it stores; it starts anew when the port is opened; it asks for lines again.
"""

from __future__ import annotations

import copy
import re
import struct
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

from controllers.marlin.planner import Planner
from controllers.pseudo_terminal import PseudoTerminal

SLICE_S = 0.002
BUFFER_BYTES, LINE_CHARACTERS, RING_LINES, BLOCKS = 128, 96, 4, 16
CLEANING_S, KEEPALIVE_S = 1.0, 2.0
AXES = "XYZE"
DEFAULTS = {
    "M92": {"X": 80.0, "Y": 80.0, "Z": 400.0, "E": 93.0},
    "M203": {"X": 500.0, "Y": 500.0, "Z": 5.0, "E": 25.0},
    "M201": {"X": 500.0, "Y": 500.0, "Z": 100.0, "E": 5000.0},
    "M204": {"P": 500.0, "R": 500.0, "T": 1000.0},
    "M205": {"B": 20000.0, "S": 0.0, "T": 0.0, "J": 0.08},
    "M206": {"X": 0.0, "Y": 0.0, "Z": 0.0},
}
SAYS_EARLY = re.compile(r"M(112|410|108)(?!\d)")
EMERGENCY = re.compile(rb"(?:N\d+ ?)?M(112|410)(?!\d)[^\n]*")
WORD = re.compile(r"([A-Z])(-?\d*\.?\d+)")

Program = Iterator[None]


def float32(value: float) -> float:
    return struct.unpack("<f", struct.pack("<f", value))[0]


@dataclass
class Eeprom:
    """What it keeps, and how often it was stored. None: nothing that makes sense."""

    settings: dict[str, dict[str, float]] | None = field(default_factory=lambda: copy.deepcopy(DEFAULTS))
    writes: int = 0
    is_broken: bool = False
    """What is stored is not kept."""


class MarlinEmulator:
    """One Marlin with its motors. Time is that of a clock [s]; it goes on whenever something is exchanged."""

    def __init__(self, clock: Callable[[], float] = time.monotonic, eeprom: Eeprom | None = None) -> None:
        self._clock = clock
        self.eeprom = eeprom or Eeprom()
        self.firmware = "Marlin 2.1.2.5 (Nov  4 2024 12:00:00)"
        self.has_emergency_parser = False
        self.tells = "targets"
        """Of M114: targets, places (as until 2.0.5), or places at rest (as with M114_LEGACY)."""
        self.has_realtime = False
        self.has_eeprom = True
        self.prints_a_file = False
        self.lacks: tuple[str, ...] = ()
        """Commands that it was built without."""
        self.says_ok_after_resend = True
        self.chats = False
        self.is_hot = True
        self.tells_scales = True
        """Of M92 alone, as from 2.0 on."""
        self.has_errors = False
        """As after a heater has failed: it answers moves with an error, and drops them."""
        self.soft_limit_mm: float | None = None
        self.starts_on_open = True
        self.boot_s = self.shows_s = 0.0
        """So long it hears nothing, and shows a picture then."""
        self.storing_s, self.heats_until_s = 0.2, 0.0
        self.echoes = False
        self.answers_after_s = 0.0
        self.dies_at_write: int | None = None
        self.on_the_way_in: Callable[[bytes], bytes] = lambda data: data
        self.on_the_way_out: Callable[[bytes], bytes] = lambda data: data
        self.lines: list[str] = []
        """All that were carried out, without their numbers."""
        self.bytes_lost = self.steps = self.resends = 0
        self._lock = threading.RLock()
        self._now_s = clock()
        self.power_up()

    # Power, starts and resets.

    def power_up(self) -> None:
        """Switch on, or off and on again: positions count from 0."""
        with self._lock:
            self.is_on, self.is_killed = True, False
            self.settings = copy.deepcopy(self.eeprom.settings or DEFAULTS)
            self.planner = Planner(lambda: self.settings)
            self._mm = dict.fromkeys(AXES, 0.0)
            self._is_relative = False
            self._received, self._line, self._said = bytearray(), bytearray(), []
            self._ring: list[str] = []
            self._last_number, self._quick_stop_seen = 0, False
            self._deaf_until_s, self._cleaning_until_s = self._now_s + self.boot_s, 0.0
            self._chat_s = self._busy_s = self._now_s
            self._in_command = False
            self._program = self._main()

    def opened(self) -> None:
        """Start anew, since the port's DTR does that to many boards."""
        with self._lock:
            if self.starts_on_open and self.is_on:
                self.power_up()

    # What comes in, and what is said.

    def exchange(self, sent: bytes) -> bytes:
        with self._lock:
            if not self.is_on:
                return b""
            arriving = self.on_the_way_in(sent) if sent else b""
            if self.echoes and arriving:
                self._said.append((self._now_s, arriving))
            if self._now_s < self._deaf_until_s:
                self.bytes_lost += len(arriving)
                arriving = b""
            for byte in arriving:
                self._take(byte)
            self._go_on()
            due = b"".join(text for at_s, text in self._said if at_s <= self._now_s)
            self._said = [(at_s, text) for at_s, text in self._said if at_s > self._now_s]
            return self.on_the_way_out(due) if due else b""

    def _take(self, byte: int) -> None:
        if self.has_emergency_parser:
            # Whatever becomes of the line itself.
            self._line.append(byte)
            if byte == 0x0A:
                if found := EMERGENCY.match(bytes(self._line).strip()):
                    self.is_killed = self.is_killed or found[1] == b"112"
                    self._quick_stop_seen = self._quick_stop_seen or found[1] == b"410"
                self._line.clear()
        if len(self._received) < BUFFER_BYTES:
            self._received.append(byte)
        else:
            self.bytes_lost += 1

    def _say(self, text: str) -> None:
        self._said.append((self._now_s + self.answers_after_s, f"{text}\n".encode()))

    def _go_on(self) -> None:
        now_s = self._clock()
        while self._now_s + SLICE_S <= now_s and self.is_on:
            self._now_s += SLICE_S
            self.steps += self.planner.go_on(SLICE_S)
            if self.chats and self._now_s >= self._chat_s + 1:
                self._chat_s = self._now_s
                self._say(" T:21.50 /0.00 B:21.30 /0.00 @:0 B@:0")
            if not self.is_killed:
                next(self._program)
            elif self._ring is not None:
                self._say("Error:Printer halted. kill() called!")
                self.planner.quick_stop()
                self._ring = None  # type: ignore[assignment]  # dead from now on

    # The program.

    def _main(self) -> Program:
        while self._now_s < self._deaf_until_s:
            yield
        self._load()
        for line in ("start", "Marlin 2.1.2.5", "echo: Last Updated: 2024-11-04 | Author: (none)"):
            self._say(line)
        while self._now_s < self._deaf_until_s + self.shows_s:
            yield
        while True:
            yield from self._idle()
            self._in_command, self._busy_s = True, self._now_s
            while self._now_s < self.heats_until_s:
                yield from self._idle()
            self._in_command = False
            if self._ring:
                self._in_command, self._busy_s = True, self._now_s
                line = self._ring[0]
                self.lines.append(line)
                yield from self._carry_out(line)
                self._ring.pop(0)
                self._in_command = False
                self._say("ok")

    def _idle(self) -> Program:
        yield
        if self._in_command and self._now_s >= self._busy_s + KEEPALIVE_S:
            self._busy_s = self._now_s
            self._say("echo:busy: processing")
        if self._quick_stop_seen:
            self._quick_stop_seen = False
            yield from self._quick_stop()
        while len(self._ring) < RING_LINES:
            found = re.search(rb"[\r\n]", self._received)
            if found is None:
                return
            text = bytes(self._received[: found.start()]).decode("ascii", "replace").strip()
            del self._received[: found.end()]
            if text:
                yield from self._take_line(text)

    def _take_line(self, text: str) -> Program:
        is_early = SAYS_EARLY.match(text)
        if text.startswith("N"):
            checked = self._checked(text)
            if checked is None:
                return
            text = checked
        elif is_early and not self.has_emergency_parser:
            if is_early[1] == "410":
                yield from self._quick_stop()
            self.is_killed = self.is_killed or is_early[1] == "112"
        if len(self._ring) < RING_LINES:
            self._ring.append(text)

    def _checked(self, text: str) -> str | None:
        body, asterisk, told = text.rpartition("*")
        found = re.match(r"N(\d+) ?(.*)", body if asterisk else text)
        number = int(found[1]) if found else -1
        is_first = found is not None and "M110" in found[2]
        if not is_first and number != self._last_number + 1:
            return self._ask_again("Line Number is not Last Line Number+1")
        checksum = 0
        for byte in body.encode():
            checksum ^= byte
        if not asterisk:
            return self._ask_again("No Checksum with line number")
        if told.strip() != str(checksum):
            return self._ask_again("checksum mismatch")
        assert found is not None
        self._last_number = number
        return found[2].strip()

    def _ask_again(self, fault: str) -> None:
        self.resends += 1
        self._say(f"Error:{fault}, Last Line: {self._last_number}")
        self._received.clear()
        self._say(f"Resend: {self._last_number + 1}")
        if self.says_ok_after_resend:
            self._say("ok")

    def _quick_stop(self) -> Program:
        self.planner.quick_stop()
        self._cleaning_until_s = self._now_s + CLEANING_S
        yield from self._await_rest()
        self._mm = {axis: float32(self.planner.counts[axis] / self.settings["M92"][axis]) for axis in AXES}

    def _await_rest(self) -> Program:
        while self.planner.is_busy or self._now_s < self._cleaning_until_s:
            yield from self._idle()

    # Lines.

    def _carry_out(self, line: str) -> Program:
        code, _, rest = line.partition(" ")
        words = {letter: float(number) for letter, number in WORD.findall(rest)}
        if code in DEFAULTS and code not in self.lacks:
            self._set(code, words)
        elif (carry_out := getattr(self, f"_{code.lower()}", None)) is not None:
            yield from carry_out(words, rest)
        else:
            self._say(f'echo:Unknown command: "{line}"')

    def _set(self, code: str, words: dict[str, float]) -> None:
        if code == "M92" and not words and self.tells_scales:
            self._list_one("M92")
        for letter, value in words.items():
            if letter in self.settings[code]:
                self.settings[code][letter] = float(int(value)) if code == "M201" else float32(value)
        if code == "M92" and words:
            self._count_anew()

    def _count_anew(self) -> None:
        """Take the mm where it is for what holds: with other steps per mm these are other steps."""
        counts = {axis: round(float32(self._mm[axis] * self.settings["M92"][axis])) for axis in AXES}
        if not self.planner.is_busy:
            self.planner.counts, self.planner.targets = counts, dict(counts)

    def _g90(self, *_: object) -> Program:
        self._is_relative = False
        yield from ()

    def _g91(self, *_: object) -> Program:
        self._is_relative = True
        yield from ()

    def _m27(self, *_: object) -> Program:
        self._say("SD printing byte 123/45678" if self.prints_a_file else "Not SD printing")
        yield from ()

    def _m110(self, *_: object) -> Program:
        yield from ()

    def _m114(self, _: dict[str, float], rest: str) -> Program:
        if self.tells == "places at rest":
            yield from self._await_rest()
        self._tell_place(is_live=self.tells != "targets" or (self.has_realtime and rest == "R"))

    def _m119(self, *_: object) -> Program:
        for line in ("Reporting endstop status", "x_min: open", "y_min: open", "z_min: TRIGGERED"):
            self._say(line)
        yield from ()

    def _m400(self, *_: object) -> Program:
        yield from self._await_rest()

    def _m410(self, *_: object) -> Program:
        if not self.has_emergency_parser:
            yield from self._quick_stop()

    def _m500(self, *_: object) -> Program:
        yield from self._store()

    def _m501(self, *_: object) -> Program:
        self._load()
        self._list()
        yield from ()

    def _m503(self, *_: object) -> Program:
        self._list()
        yield from ()

    def _g1(self, words: dict[str, float], _: str) -> Program:
        assert self._is_relative
        if self.has_errors:
            self._say("Error:Printer stopped due to errors. Fix the error and use M999 to restart.")
            return
        for axis in AXES:
            self._mm[axis] = float32(self._mm[axis] + float32(words.get(axis, 0.0)))
        if self.soft_limit_mm is not None:
            self._mm["X"] = min(max(self._mm["X"], 0.0), self.soft_limit_mm)
        scale = self.settings["M92"]
        target = {axis: round(float32(self._mm[axis] * scale[axis])) for axis in AXES}
        if not self.is_hot and target["E"] != self.planner.targets["E"]:
            self._say("echo: cold extrusion prevented")
            self.planner.targets["E"] = self.planner.counts["E"] = target["E"]
        # It was worked out before: what comes while a place in the queue is waited for changes nothing in that.
        while len(self.planner.blocks) >= BLOCKS - 1:
            yield from self._idle()
        if self._now_s >= self._cleaning_until_s:
            self.planner.add(target, words.get("F", 1e9) / 60)

    def _tell_place(self, *, is_live: bool) -> None:
        counts = self.planner.counts if is_live else self.planner.targets
        scale = self.settings["M92"]
        lengths = {axis: counts[axis] / scale[axis] if is_live else self._mm[axis] for axis in AXES}
        told = " ".join(f"{axis}:{lengths[axis]:.2f}" for axis in AXES)
        self._say(f"{told} Count " + " ".join(f"{axis}:{counts[axis]}" for axis in "XYZ"))

    def _m115(self, *_: object) -> Program:
        self._say(
            f"FIRMWARE_NAME:{self.firmware} SOURCE_CODE_URL:github.com/MarlinFirmware/Marlin PROTOCOL_VERSION:1.0 "
            "MACHINE_TYPE:3D Printer EXTRUDER_COUNT:1 UUID:cede2a2f-41a2-4748-9b12-c55c62f367ff"
        )
        caps = {"EEPROM": self.has_eeprom, "EMERGENCY_PARSER": self.has_emergency_parser, "SDCARD": True}
        for name, has in caps.items():
            self._say(f"Cap:{name}:{int(has)}")
        yield from ()

    def _list(self) -> None:
        self._say("echo:; Linear Units:")
        self._say("echo:  G21 ; (mm)")
        for code in self.settings:
            self._list_one(code)

    def _list_one(self, code: str) -> None:
        told = " ".join(f"{letter}{value:.2f}" for letter, value in self.settings[code].items())
        self._say(f"echo:  {code} {told}")

    def _store(self) -> Program:
        if not self.has_eeprom:
            self._say("Error:EEPROM disabled")
            return
        self.eeprom.writes += 1
        if self.dies_at_write == self.eeprom.writes:
            # Its checksum is wrong from then on.
            self.dies_at_write, self.is_on, self.eeprom.settings = None, False, None
            yield
        self._deaf_until_s = self._now_s + self.storing_s
        while self._now_s < self._deaf_until_s:
            yield
        if not self.eeprom.is_broken:
            self.eeprom.settings = copy.deepcopy(self.settings)
        self._say("echo:Settings Stored (622 bytes; crc 31234)")

    def _load(self) -> None:
        if self.eeprom.settings is None:
            self._say("Error:EEPROM CRC mismatch - (stored) 0 != 31234 (calculated)!")
        self.settings = copy.deepcopy(self.eeprom.settings or DEFAULTS)
        self._count_anew()
        self._say("echo:V89 stored settings retrieved (622 bytes; crc 31234)")

    # What tests ask.

    @property
    def position(self) -> list[int]:
        return [self.planner.counts[axis] for axis in AXES]

    @property
    def is_moving(self) -> bool:
        return self.planner.is_busy

    def change_at_the_display(self, code: str, letter: str, value: float) -> None:
        """Change a setting, of which nothing is said."""
        with self._lock:
            self._set(code, {letter: value})

    def move_as_somebody_else(self, **steps: int) -> None:
        """Move something as the knob on the machine does."""
        with self._lock:
            target = {axis: self.planner.targets[axis] + steps.get(axis, 0) for axis in AXES}
            self._mm = {axis: target[axis] / self.settings["M92"][axis] for axis in AXES}
            self.planner.add(target, 20.0)


class MarlinOnACable(PseudoTerminal):
    """A Marlin at a pseudo-terminal, plugged in while the context lasts."""

    def __init__(self, marlin: MarlinEmulator | None = None) -> None:
        super().__init__()
        self.marlin = marlin or MarlinEmulator()

    def opened(self) -> None:
        self.marlin.opened()

    def exchange(self, data: bytes) -> bytes:
        return self.marlin.exchange(data)
