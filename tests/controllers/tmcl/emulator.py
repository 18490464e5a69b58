"""A TMCL module, as the manuals of such modules say that one behaves, and a pseudo-terminal to reach it at.

Written from these and from the firmwares that their maker has published for such chips: of the client it knows nothing.
"""

from __future__ import annotations

import math
import struct
import threading
import time
from collections.abc import Callable

from controllers.pseudo_terminal import PseudoTerminal
from controllers.tmcl.chip import ACCELERATION, BACKWARDS, FORWARDS, POSITION, SPEED, Chip

ROR, ROL, MST, MVP, SAP, GAP, STAP, RSAP, GGP, STOP_PROGRAM, VERSION = 1, 2, 3, 4, 5, 6, 7, 8, 10, 128, 136
QUESTIONS = {GAP, GGP, VERSION}
OK, WRONG_CHECKSUM, INVALID_COMMAND, WRONG_TYPE, INVALID_VALUE, EEPROM_LOCKED = 100, 1, 2, 3, 4, 5
VMAX, AMAX, A1, V1, DMAX, D1, VSTART, VSTOP = 4, 5, 15, 16, 17, 18, 19, 20
RAMP = {VMAX: "vmax", AMAX: "amax", A1: "a1", V1: "v1", DMAX: "dmax", D1: "d1", VSTART: "vstart", VSTOP: "vstop"}
SPEEDS = {VMAX, V1, VSTART, VSTOP}
WIDTHS = {VMAX: 23, V1: 20, VSTART: 18, VSTOP: 18}
CURRENT, RESOLUTION, UNIT_MODE = 6, 140, 255
FACTORY = {VMAX: 53687, AMAX: 858, A1: 858, V1: 0, DMAX: 858, D1: 858, VSTART: 0, VSTOP: 10}
"""In the chip's units."""
SLICE_S = 0.001
GAP_S = 0.02
"""Bytes of a command that come so late are none of it."""


class Motor:
    """One axis of a module."""

    def __init__(self) -> None:
        self.stored = {**FACTORY, CURRENT: 128, RESOLUTION: 8, UNIT_MODE: 1}
        self.power_up()

    def power_up(self) -> None:
        self.chip = Chip()
        self.settings = dict(self.stored)
        for number, name in RAMP.items():
            setattr(self.chip, name, self.settings[number])
        self.chip.vmax = 0


class TmclEmulator:
    """One module with its motors. Time is that of a clock [s]; it goes on whenever something is exchanged.

    on_the_way_in, on_the_way_out: what a bad line makes of bytes.
    """

    def __init__(self, clock: Callable[[], float] = time.monotonic, number: int = 1276, axes: int = 1) -> None:
        self._clock = clock
        self.number, self.version = number, 0x0113
        self.tells_its_number = True
        """An older firmware tells it as text only."""
        self.address, self.host = 1, 2
        self.is_locked = False
        self.echoes = False
        """As a converter of RS-485 does that hears itself."""
        self.answers_before: bytes = b""
        """What somebody else on the line says before each answer."""
        self.stores_registers = False
        """STAP and RSAP take the speed that the chip is told for that of the ramp, as a published firmware does."""
        self.has_store_commands = True
        self.program: Callable[[TmclEmulator], None] | None = None
        """What a program that is stored in the module does every now and then."""
        self.obeys = True
        self.dies_after_stores: int | None = None
        """The power is cut once it has stored so many parameters."""
        self.on_the_way_in: Callable[[bytes], bytes] = lambda data: data
        self.on_the_way_out: Callable[[bytes], bytes] = lambda data: data
        self.commands: list[tuple[int, int, int, int]] = []
        """All that were obeyed, or answered: command, kind, motor, value."""
        self.motors = [Motor() for _ in range(axes)]
        self._lock = threading.RLock()
        self.power_up()

    def power_up(self) -> None:
        """Switch on, or off and on again."""
        self._now_s = self._up_since_s = self._clock()
        self._partial, self._heard_s = b"", 0.0
        self.is_dead = False
        for motor in self.motors:
            motor.power_up()

    @property
    def chip(self) -> Chip:
        return self.motors[0].chip

    def opened(self) -> None:
        """A module isn't reset by the opening of the port."""

    def has_been_up(self, time_s: float) -> None:
        """Tell that it was switched on so long before it was."""
        self._up_since_s -= time_s

    def press(self, name: str, pressed: bool = True) -> None:
        """Set a limit switch of the first motor, at the present time."""
        with self._lock:
            self._go_on()
            setattr(self.chip, name, pressed)

    def exchange(self, sent: bytes) -> bytes:
        with self._lock:
            self._go_on()
            if not sent or self.is_dead:
                return b""
            said = sent if self.echoes else b""
            # What comes at once comes without gaps, however long this machine takes over it.
            if time.monotonic() - self._heard_s > GAP_S:
                self._partial = b""
            self._heard_s = time.monotonic()
            for byte in self.on_the_way_in(sent):
                said += self._take(byte)
            return b"" if self.is_dead else self.on_the_way_out(said)

    def _take(self, byte: int) -> bytes:
        self._partial += bytes([byte])
        if len(self._partial) < 9:
            return b""
        address, command, kind, motor, value, told = struct.unpack(">BBBBiB", self._partial)
        is_whole = sum(self._partial[:8]) % 256 == told
        self._partial = b""
        if address != self.address:
            return b""
        if not is_whole:
            return self.answers_before + self._reply(WRONG_CHECKSUM, 0, 0)
        self.commands.append((command, kind, motor, value))
        if command == VERSION and kind == 0:
            return bytes([self.host]) + f"{self.number}V{self.version >> 8}{self.version & 0xFF:02x}".encode()
        status, answer = self._obey(command, kind, motor, value)
        return self.answers_before + self._reply(status, command, answer)

    def _reply(self, status: int, command: int, value: int) -> bytes:
        head = struct.pack(">BBBBi", self.host, self.address, status, command, value)
        return head + bytes([sum(head) % 256])

    def _obey(self, command: int, kind: int, number: int, value: int) -> tuple[int, int]:
        if command == VERSION:
            return OK, (self.number if self.tells_its_number else 0) << 16 | self.version
        if command == GGP:
            return self._global(kind)
        if command == STOP_PROGRAM:
            self.program = None
            return OK, 0
        stores = (STAP, RSAP) if self.has_store_commands else ()
        if command not in (ROR, ROL, MST, MVP, SAP, GAP, *stores):
            return INVALID_COMMAND, 0
        return (INVALID_VALUE, 0) if number >= len(self.motors) else self._of(self.motors[number], command, kind, value)

    def _of(self, motor: Motor, command: int, kind: int, value: int) -> tuple[int, int]:
        if command == GAP:
            return self._get(motor, kind)
        if command == SAP:
            return self._set(motor, kind, value), value
        if command in (STAP, RSAP):
            return (self._store if command == STAP else self._recall)(motor, kind), 0
        if self.obeys:
            self._move(motor, command, value)
        return OK, value

    def _global(self, kind: int) -> tuple[int, int]:
        if kind == 128:
            return OK, int(self.program is not None)
        if kind == 132:
            ticks = round((self._now_s - self._up_since_s) * 1000) % 2**32
            return OK, ticks - (ticks >> 31 << 32)
        return WRONG_TYPE, 0

    def _move(self, motor: Motor, command: int, value: int) -> None:
        chip = motor.chip
        if command == MVP:
            chip.target, chip.vmax, chip.mode = value, motor.settings[VMAX], POSITION
            return
        speed = {ROR: value, ROL: -value, MST: 0}[command]
        chip.vmax = self._to_chip(motor, VMAX, abs(speed))
        chip.mode = FORWARDS if speed >= 0 else BACKWARDS

    # Parameters.

    def _get(self, motor: Motor, kind: int) -> tuple[int, int]:
        chip = motor.chip
        if kind == 0:
            return OK, chip.target
        if kind == 1:
            return OK, chip.position
        if kind == 2:
            return OK, self._from_chip(motor, VMAX, chip.vmax) * (-1 if chip.mode == BACKWARDS else 1)
        if kind == 3:
            speed = self._from_chip(motor, VMAX, round(abs(chip.speed) / SPEED))
            return OK, speed if chip.speed >= 0 else -speed
        if kind not in motor.settings:
            return WRONG_TYPE, 0
        value = motor.settings[kind]
        return OK, self._from_chip(motor, kind, value) if kind in RAMP else value

    def _set(self, motor: Motor, kind: int, value: int) -> int:
        if kind == 0:
            motor.chip.target = value
        elif kind == 1:
            motor.chip.position = value
        elif kind in RAMP:
            register = self._to_chip(motor, kind, value)
            if not 0 <= register < 1 << WIDTHS.get(kind, 16):
                return INVALID_VALUE
            self._have(motor, kind, register)
        elif kind in motor.settings:
            motor.settings[kind] = value
        else:
            return WRONG_TYPE
        return OK

    def _have(self, motor: Motor, kind: int, register: int) -> None:
        motor.settings[kind] = register
        if kind != VMAX or motor.chip.mode == POSITION:
            setattr(motor.chip, RAMP[kind], register)

    def _store(self, motor: Motor, kind: int) -> int:
        if self.is_locked:
            return EEPROM_LOCKED
        if kind not in motor.settings:
            return WRONG_TYPE
        is_register = self.stores_registers and kind == VMAX
        motor.stored[kind] = motor.chip.vmax if is_register else motor.settings[kind]
        if self.dies_after_stores is not None:
            self.dies_after_stores -= 1
            self.is_dead = self.dies_after_stores <= 0
        return OK

    def _recall(self, motor: Motor, kind: int) -> int:
        if kind not in motor.settings:
            return WRONG_TYPE
        if kind in RAMP:
            self._have(motor, kind, motor.stored[kind])
            if self.stores_registers and kind == VMAX:
                motor.chip.vmax = motor.stored[kind]
        else:
            motor.settings[kind] = motor.stored[kind]
        return OK

    def _to_chip(self, motor: Motor, kind: int, value: int) -> int:
        if not motor.settings[UNIT_MODE]:
            return value
        return math.floor(value / (SPEED if kind in SPEEDS else ACCELERATION))

    def _from_chip(self, motor: Motor, kind: int, register: int) -> int:
        if not motor.settings[UNIT_MODE]:
            return register
        return math.floor(register * (SPEED if kind in SPEEDS else ACCELERATION))

    # Time.

    def _go_on(self) -> None:
        now_s = self._clock()
        while self._now_s + SLICE_S <= now_s:
            self._now_s += SLICE_S
            if self.program is not None and not self.is_dead:
                self.program(self)
            for motor in self.motors:
                motor.chip.advance(SLICE_S)


class ModuleOnACable(PseudoTerminal):
    """A module at a pseudo-terminal, plugged in while the context lasts."""

    def __init__(self, module: TmclEmulator | None = None) -> None:
        super().__init__()
        self.module = module or TmclEmulator()

    def exchange(self, data: bytes) -> bytes:
        return self.module.exchange(data)
