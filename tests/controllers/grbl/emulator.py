"""A grbl 1.1h, as its documentation and its sources say that one behaves, and a pseudo-terminal to reach it at.

Written from those alone: of the client it knows nothing. It misbehaves as real ones do: it loses what comes while it
writes its EEPROM, and what its buffer doesn't hold; it starts anew when the port is opened.
"""

from __future__ import annotations

import math
import re
import struct
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, field

from controllers.pseudo_terminal import PseudoTerminal

SLICE_S = 0.002
BUFFER_BYTES, LINE_CHARACTERS = 128, 80
EEPROM_S = 0.015
DEFAULTS = {
    0: 10, 1: 25, 2: 0, 3: 0, 4: 0, 5: 0, 6: 0, 10: 1, 11: 0.010, 12: 0.002, 13: 0, 20: 0, 21: 0, 22: 0, 23: 0,
    24: 25, 25: 500, 26: 250, 27: 1, 30: 1000, 31: 0, 32: 0,
    100: 250, 101: 250, 102: 250, 110: 500, 111: 500, 112: 500, 120: 10, 121: 10, 122: 10, 130: 200, 131: 200, 132: 200,
}  # fmt: skip
WHOLE = (0, 1, 2, 3, 4, 5, 6, 10, 13, 20, 21, 22, 23, 26, 30, 31, 32)
JOG = re.compile(r"\$J=(.*)")
SETTING = re.compile(r"\$(\d+)=(-?\d*\.?\d*)")
WORD = re.compile(r"([A-Z])(-?\d*\.?\d+)")
OFFSET = re.compile(r"(G20|G21)?G10L2P([1-6])(.*)")


def float32(value: float) -> float:
    return struct.unpack("<f", struct.pack("<f", value))[0]


@dataclass
class Eeprom:
    """What it keeps, and how often it was written."""

    settings: dict[int, float] = field(default_factory=lambda: {n: float32(v) for n, v in DEFAULTS.items()})
    startup: list[str] = field(default_factory=lambda: ["", ""])
    offsets: dict[int, tuple[float, ...]] = field(default_factory=lambda: dict.fromkeys(range(1, 7), (0.0, 0.0, 0.0)))
    writes: int = 0
    unreadable: str = ""
    """What a power cut has left broken, by the command that lists it."""
    is_broken: bool = False
    """What is written doesn't reach it."""
    is_worn: bool = False
    """A cell doesn't keep what was written: at the next start its checksum is wrong, and it goes back to defaults."""


class GrblEmulator:
    """One grbl with its motors. Time is that of a clock [s]; it goes on whenever something is exchanged."""

    def __init__(self, clock: Callable[[], float] = time.monotonic, eeprom: Eeprom | None = None) -> None:
        self._clock = clock
        self.eeprom = eeprom or Eeprom()
        self.banner = "Grbl 1.1h ['$' for help]"
        self.version = ["[VER:1.1h.20190830:]", "[OPT:V,15,128]"]
        self.starts_on_open = True
        self.greets_after_s: float | None = None
        """Where it goes on as the port is opened: when it greets all the same, as grblHAL with USB of its own."""
        self.boot_s = 0.0
        self.alarm_told: int | None = None
        """The code that grblHAL tells with its state; None: it doesn't, as grbl 1.1."""
        self.echoes = False
        self.most: dict[int, float] = {}
        """grblHAL's highest values."""
        self.answers_after_s = 0.0
        self.dies_at_write: int | None = None
        self.on_the_way_in: Callable[[bytes], bytes] = lambda data: data
        self.on_the_way_out: Callable[[bytes], bytes] = lambda data: data
        self.lines: list[str] = []
        """All that were obeyed, or refused."""
        self.bytes_lost = 0
        self.steps = self.starts = 0
        self._lock = threading.RLock()
        self._now_s = clock()
        self.position = [0, 0, 0]
        self._mm = [0.0, 0.0, 0.0]
        self.power_up()

    # Power, starts and resets.

    def power_up(self) -> None:
        """Switch on, or off and on again: positions count from 0."""
        with self._lock:
            self.is_on = True
            self.position, self._mm = [0, 0, 0], [0.0, 0.0, 0.0]
            self.state, self.part = "Idle", 0
            is_whole = self._is_whole()
            self._load()
            self._begin_anew(self.boot_s)
            if not is_whole:
                said = "".join(f"{line}\r\n" for line in ("error:7", *self._listing()))
                self._said.insert(0, (self._now_s + self.boot_s, said.encode()))

    def opened(self) -> None:
        """Start anew, since the port's DTR does that to many boards."""
        with self._lock:
            if self.starts_on_open and self.is_on:
                self.starts += 1
                self.power_up()
            elif self.greets_after_s is not None and self.is_on:
                self._said.append((self._now_s + self.greets_after_s, f"\r\n{self.banner}\r\n".encode()))

    def _begin_anew(self, after_s: float) -> None:
        # Only now it counts by steps per mm that were set since.
        self._mm = self._places_mm
        self._received, self._queue, self._speed = bytearray(), [], 0.0
        self._ends_jog = self._holds = False
        self._reports = 0
        self._said: list[tuple[float, bytes]] = []
        self._deaf_until_s = self._now_s + after_s
        self._say(f"\r\n{self.banner}", after_s)
        if self.settings[22] and self.state == "Idle" and not self.steps:
            self.state = "Alarm"
        if self.state == "Alarm":
            self._say("[MSG:'$H'|'$X' to unlock]", after_s)
            return
        self.state = "Idle"
        for line in self.eeprom.startup:
            if line:
                self._say(f">{line}:{self._run_block(line)}", after_s)

    def _is_whole(self) -> bool:
        """Look whether its EEPROM's checksum is right, as it does only here; else put it to its defaults."""
        if not self.eeprom.is_worn:
            return True
        self.eeprom.settings, self.eeprom.startup = Eeprom().settings, ["", ""]
        return False

    def _load(self) -> None:
        """Take what it keeps: a reset by 0x18 doesn't."""
        self.settings = dict(self.eeprom.settings)

    @property
    def _places_mm(self) -> list[float]:
        scales = [self.settings[100 + axis] for axis in range(3)]
        return [step / scale if scale else 0.0 for step, scale in zip(self.position, scales, strict=True)]

    def _reset(self) -> None:
        alarm = 3 if self.state in ("Run", "Jog") else 6 if self.state == "Home" else None
        if alarm:
            self.state = "Alarm"
            said = [(self._now_s, f"ALARM:{alarm}\r\n".encode())]
            self._begin_anew(0.0)
            self._said = said + self._said
            return
        if self.state not in ("Alarm",):
            self.state = "Idle"
        self._begin_anew(0.0)

    # What comes in, and what is said.

    def exchange(self, sent: bytes) -> bytes:
        with self._lock:
            if not self.is_on:
                return b""
            self._go_on()
            arriving = self.on_the_way_in(sent) if sent else b""
            if self.echoes and arriving:
                self._said.append((self._now_s, arriving))
            if self._now_s < self._deaf_until_s:
                self.bytes_lost += len(arriving)
                arriving = b""
            for byte in arriving:
                self._take(byte)
            self._read_lines()
            due = b"".join(text for at_s, text in self._said if at_s <= self._now_s)
            self._said = [(at_s, text) for at_s, text in self._said if at_s > self._now_s]
            return self.on_the_way_out(due) if due else b""

    def _take(self, byte: int) -> None:
        if byte == 0x18:
            self._reset()
        elif byte == ord("?"):
            self._say_report()
        elif byte == ord("!"):
            if self.state in ("Run", "Jog"):
                self._holds = True
                self.state, self.part = "Hold", 1
        elif byte == ord("~"):
            if self.state == "Hold" and not self.part:
                self.state, self._holds = "Run" if self._queue else "Idle", False
        elif byte == 0x85:
            if self.state == "Jog":
                self._ends_jog = True
        elif byte < 0x80:
            if len(self._received) < BUFFER_BYTES:
                self._received.append(byte)
            else:
                self.bytes_lost += 1

    def _read_lines(self) -> None:
        """Obey whole lines, one after the other, until one keeps it busy."""
        while self._now_s >= self._deaf_until_s and self.state not in ("Sleep",):
            found = re.search(rb"[\r\n]", self._received)
            if found is None:
                return
            line = bytes(self._received[: found.start()]).decode("ascii", "replace").replace(" ", "").upper()
            if self._queue_is_full(line):
                return
            del self._received[: found.end()]
            self.lines.append(line)
            self._obey(line)

    def _queue_is_full(self, line: str) -> bool:
        return line.startswith("$J=") and len(self._queue) >= 15

    def _say(self, text: str, after_s: float = 0.0) -> None:
        self._said.append((self._now_s + after_s + self.answers_after_s, f"{text}\r\n".encode()))

    def _say_report(self) -> None:
        self._reports += 1
        scale = 1 / 25.4 if self.settings[13] else 1.0
        places = 4 if self.settings[13] else 3
        machine = [
            # Without steps/mm it prints what becomes of no number.
            float32(step / float32(self.settings[100 + axis])) * scale if self.settings[100 + axis] else 0.0
            for axis, step in enumerate(self.position)
        ]
        offset = [each * scale for each in self.eeprom.offsets[1]]
        is_of_work = not int(self.settings[10]) & 1
        shown = [a - b for a, b in zip(machine, offset, strict=True)] if is_of_work else machine
        name = f"{self.state}:{self.part}" if self.state in ("Hold", "Door") else self.state
        if self.state == "Alarm" and self.alarm_told is not None:
            name = f"Alarm:{self.alarm_told}"
        told = f"<{name}|{'WPos' if is_of_work else 'MPos'}:{','.join(f'{each:.{places}f}' for each in shown)}"
        told += f"|FS:{self._speed * 60 * scale:.0f},0"
        if self._reports % 30 == 1:
            told += f"|WCO:{','.join(f'{each:.{places}f}' for each in offset)}"
        self._say(told + ">")

    # Lines.

    def _obey(self, line: str) -> None:
        if len(line) > LINE_CHARACTERS - 1:
            self._say("error:11")
        elif line in ("$$", "$#", "$N", "$I"):
            self._say_listing(line)
        elif line == "$X":
            self.state = "Idle" if self.state == "Alarm" else self.state
            self._say("[MSG:Caution: Unlocked]")
            self._say("ok")
        elif (jog := JOG.fullmatch(line)) is not None:
            self._say(self._jog(jog[1]))
        elif (setting := SETTING.fullmatch(line)) is not None:
            self._set(int(setting[1]), setting[2])
        elif line.startswith(("$N0=", "$N1=")):
            self._keep_startup(int(line[2]), line[4:])
        elif self.state == "Alarm" and line and not line.startswith("$"):
            self._say("error:9")
        elif (offset := OFFSET.fullmatch(line)) is not None:
            scale = 25.4 if offset[1] == "G20" else 1.0
            words = {letter: float(number) * scale for letter, number in WORD.findall(offset[3])}
            place = int(offset[2])
            self._write(lambda: self.eeprom.offsets.__setitem__(place, tuple(words[letter] for letter in "XYZ")))
        elif line == "":
            self._say("ok")
        else:
            self._say(self._run_block(line))

    def _say_listing(self, line: str) -> None:
        if self.state not in ("Idle", "Alarm"):
            self._say("error:8")
            return
        if self.eeprom.unreadable == line:
            # It is put to its default by that.
            self.eeprom.unreadable = ""
            self._say("error:7")
            self._say("ok")
            return
        makes = {"$$": self._listing, "$#": self._parameters, "$N": self._startup, "$I": lambda: self.version}
        for each in makes[line]():
            self._say(each)
        self._say("ok")

    def _keep_startup(self, number: int, block: str) -> None:
        """Store a start-up line, which is carried out before, to see that it makes sense."""
        verdict = "error:8" if self.state != "Idle" else self._run_block(block)
        if verdict == "ok":
            self._write(lambda: self.eeprom.startup.__setitem__(number, block))
        else:
            self._say(verdict)

    def _listing(self) -> list[str]:
        return [
            f"${number}={value:.0f}" if number in WHOLE else f"${number}={value:.3f}"
            for number, value in self.settings.items()
        ]

    def _parameters(self) -> list[str]:
        told = [
            f"[G{53 + place}:{','.join(f'{each:.3f}' for each in offset)}]"
            for place, offset in self.eeprom.offsets.items()
        ]
        zero = "0.000,0.000,0.000"
        return [*told, f"[G28:{zero}]", f"[G30:{zero}]", f"[G92:{zero}]", "[TLO:0.000]", f"[PRB:{zero}:0]"]

    def _startup(self) -> list[str]:
        return [f"$N{number}={line}" for number, line in enumerate(self.eeprom.startup)]

    def _set(self, number: int, text: str) -> None:
        value = float32(float(text)) if text not in ("", ".", "-") else math.nan
        errors = {
            8: self.state not in ("Idle", "Alarm"),
            2: math.isnan(value),
            4: value < 0,
            3: number not in self.settings,
            6: number == 0 and value < 3,
            10: number == 20 and value != 0 and not self.settings[22],
            52: value > self.most.get(number, math.inf),
        }
        error = next((code for code, is_so in errors.items() if is_so), None)
        if error is not None:
            self._say(f"error:{error}")
            return
        if 120 <= number < 130:
            # It keeps accelerations in mm/min².
            value = float32(float32(value * 3600) / 3600)
        # Without homing there are no soft limits.
        changed = {22: 0.0, 20: 0.0} if (number, value) == (22, 0) else {number: value}
        self.settings |= changed
        self._write(lambda: self.eeprom.settings.update(changed))

    def _write(self, write: Callable[[], None]) -> None:
        self.eeprom.writes += 1
        if self.dies_at_write == self.eeprom.writes:
            # The checksum is wrong from then on: it goes back to its defaults.
            self.dies_at_write, self.is_on = None, False
            self.eeprom.settings = Eeprom().settings
            self.eeprom.startup = ["", ""]
            return
        if not self.eeprom.is_broken:
            write()
        self._deaf_until_s = self._now_s + EEPROM_S
        self._say("ok", EEPROM_S)

    def _jog(self, words: str) -> str:
        if self.state not in ("Idle", "Jog"):
            return "error:9" if self.state == "Alarm" else "error:8"
        if WORD.sub("", words):
            return "error:1"
        found = dict(WORD.findall(re.sub(r"G(53|20|21|90|91)", "", words)))
        if "F" not in found:
            return "error:22"
        if not set(found) & set("XYZ"):
            return "error:16"
        scale = 25.4 if "G20" in words else 1.0
        begin = self._queue[-1][0] if self._queue else tuple(self._mm)
        target = list(begin)
        if not self._queue:
            # It plans from where the steps are, to where it was told: an axis that isn't named, by its old steps/mm.
            self._mm = [
                there if abs(there - told) * self.settings[100 + axis] > 1 else told
                for axis, (there, told) in enumerate(zip(self._places_mm, self._mm, strict=True))
            ]
            begin = tuple(self._mm)
        for axis, letter in enumerate("XYZ"):
            if letter in found:
                target[axis] = float32(float(found[letter])) * scale
                assert "G90" in words
                assert "G53" in words
        if self.settings[20] and any(not -self.settings[130 + axis] <= at <= 0 for axis, at in enumerate(target)):
            return "error:15"
        if tuple(target) != begin:
            self._queue.append((tuple(target), float(found["F"]) * scale / 60))
            self.state = "Jog"
        return "ok"

    def run_program(self, *blocks: str) -> None:
        """Carry something out that another one has started, as an SD card or a pendant does."""
        with self._lock:
            self._go_on()
            for block in blocks:
                self._run_block(block)

    def go_home(self) -> None:
        with self._lock:
            self.state, self._speed = "Home", 5.0

    def _run_block(self, block: str) -> str:
        found = dict(WORD.findall(block.replace(" ", "").upper()))
        if not set(found) & set("XYZ"):
            return "ok"
        begin = self._queue[-1][0] if self._queue else tuple(self._mm)
        target = tuple(float(found.get(letter, begin[axis])) for axis, letter in enumerate("XYZ"))
        if target != begin:
            self._queue.append((target, float(found.get("F", 1e9)) / 60))
            self.state = "Run"
        return "ok"

    # Motion: the whole way that is queued, at one speed along it.

    def _go_on(self) -> None:
        now_s = self._clock()
        while self._now_s + SLICE_S <= now_s:
            self._now_s += SLICE_S
            if self.state in ("Jog", "Run", "Hold") and self._queue:
                self._move_for(SLICE_S)
            self._read_lines()

    def _move_for(self, time_s: float) -> None:
        target, feed = self._queue[0]
        way = [b - a for a, b in zip(self._mm, target, strict=True)]
        length = math.hypot(*way)
        unit = [each / length for each in way] if length else [0.0] * 3
        most = [self.settings[110 + axis] / 60 / abs(part) for axis, part in enumerate(unit) if part]
        gain = min((self.settings[120 + axis] / abs(part) for axis, part in enumerate(unit) if part), default=1.0)
        assert gain > 0, "it hangs"
        slows = self._ends_jog or self._holds
        wanted = 0.0 if slows else min(feed, *most, math.sqrt(2 * gain * self._left_mm(unit))) if most else 0.0
        step = gain * time_s
        self._speed = max(wanted, self._speed - step) if self._speed > wanted else min(wanted, self._speed + step)
        if slows and not self._speed:
            return self._come_to_rest()
        ahead = min(length, max(self._speed, 1e-6) * time_s)
        at = target if ahead >= length else [a + part * ahead for a, part in zip(self._mm, unit, strict=True)]
        self._place_at(list(at))
        if ahead >= length:
            self._queue.pop(0)
            if not self._queue:
                self._speed = 0.0
                self.state, self._ends_jog = "Idle", False
                if self._holds:
                    self.state, self.part = "Hold", 0
        return None

    def _left_mm(self, unit: list[float]) -> float:
        """Return how far it may go without coming to rest: along the line that it is on."""
        left, at = 0.0, self._mm
        for target, _ in self._queue:
            way = [b - a for a, b in zip(at, target, strict=True)]
            length = math.hypot(*way)
            if length and any(abs(part - each / length) > 1e-3 for part, each in zip(unit, way, strict=True)):
                break
            left, at = left + length, list(target)
        return left

    def _come_to_rest(self) -> None:
        if self.state == "Jog":
            self._queue, self._ends_jog, self.state = [], False, "Idle"
            self._mm = [step / self.settings[100 + axis] for axis, step in enumerate(self.position)]
        else:
            self.part = 0

    def _place_at(self, mm: list[float]) -> None:
        self._mm = mm
        before = list(self.position)
        self.position = [
            math.floor(abs(at * self.settings[100 + axis]) + 0.5) * (1 if at >= 0 else -1) for axis, at in enumerate(mm)
        ]
        self.steps += max(abs(a - b) for a, b in zip(before, self.position, strict=True))

    @property
    def is_moving(self) -> bool:
        return self._speed > 0 or (bool(self._queue) and self.state in ("Jog", "Run"))


class GrblOnACable(PseudoTerminal):
    """A grbl at a pseudo-terminal, plugged in while the context lasts."""

    def __init__(self, grbl: GrblEmulator | None = None) -> None:
        super().__init__()
        self.grbl = grbl or GrblEmulator()

    def opened(self) -> None:
        self.grbl.opened()

    def exchange(self, data: bytes) -> bytes:
        return self.grbl.exchange(data)
