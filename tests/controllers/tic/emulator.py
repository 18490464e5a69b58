"""A Pololu Tic, as its User's Guide (Pololu 0J71) says that one behaves, and a pseudo-terminal to reach it at.

Written from the guide alone: of the client it knows nothing. Sections 5.1 (motion), 5.4 (errors), 6 to 9.
"""

from __future__ import annotations

import math
import struct
import threading
import time
from collections.abc import Callable

from controllers.pseudo_terminal import PseudoTerminal

RESET, DEENERGIZED, SOFT_ERROR, WAITING_FOR_ERR_LINE, STARTING_UP, NORMAL = 0, 2, 4, 6, 8, 10
OFF, TO_POSITION, AT_VELOCITY = 0, 1, 2
HALTED, POSITION, VELOCITY = 2, 3, 4
QUICK = {0x83, 0x85, 0x86, 0x89, 0x8A, 0x8C, 0x8F, 0xB0}
WRITE_32 = {0xE0, 0xE3, 0xE5, 0xE6, 0xE9, 0xEA, 0xEC}
READ = {0xA1, 0xA2, 0xA8}
GO_HOME = 0x97
LENGTHS = {GO_HOME: 2, **dict.fromkeys(QUICK, 1), **dict.fromkeys(WRITE_32, 6), **dict.fromkeys(READ, 3)}
ENDS_SERIAL_ERROR = {0xE0, 0xE3, 0xEC, 0x89, 0x85, 0x83, 0xB0}
SLICE_S = 0.001
EXIT_LASTS_S = 0.2
CURRENT_STEADY_S = 0.01
AT_HOME_S = 0.02
FRAMING, FORMAT, CRC = 1 << 16, 1 << 18, 1 << 19
DEENERGIZE, HALT_AND_HOLD, DECELERATE_TO_HOLD, GO_TO_POSITION = range(4)
NEW_SETTINGS = (
    ("<BBBBHBBH", 0x01, (0, 0, 0, 0, 1249, 14, 1, 1000)),
    ("<BHHHHhHHBB", 0x0B, (0, 250, 6000, 6500, 35000, 0, 100, 500, 2, 0)),
    ("<HHBBHHHHiBHBiB", 0x1C, (0, 4095, 0, 0, 0, 2015, 2080, 4095, -200, 1, 0, 255, 200, 0)),
    ("<IBBBBBBBBIIII", 0x37, (1, 0, 0, 0, 0, 0, 6, 0, 0, 0, 2_000_000, 0, 40_000)),
    ("<BiIBBB", 0x53, (DECELERATE_TO_HOLD, 0, 1, 0, 0, 0)),
    ("<BBIIBH", 0x5F, (0, 0, 1_000_000, 500_000, 0, 0)),
)
"""What a T825 keeps when it is new, section 6: how, from which address on, and what."""
SETTINGS_END = 0x100
"""Its EEPROM is larger than what a product has settings for."""


def crc_7(message: bytes) -> int:
    """Return the remainder as the guide has it worked out by hand: a long division, least bits first, on the left."""
    bits = [byte >> place & 1 for byte in message for place in range(8)] + [0] * 7
    for start in range(len(bits) - 7):
        if bits[start]:
            for place, bit in enumerate((1, 0, 0, 0, 1, 0, 0, 1)):
                bits[start + place] ^= bit
    return sum(bit << place for place, bit in enumerate(bits[-7:]))


class TicEmulator:
    """One Tic with its motor. Time is that of a clock [s]; it goes on whenever something is exchanged.

    on_the_way_in, on_the_way_out: what a bad line makes of bytes.
    """

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self.control_mode = 0
        self.disable_safe_start = False
        self.command_timeout_ms = 1000
        self.crc_for_commands = self.crc_for_responses = False
        self.soft_error_response = DECELERATE_TO_HOLD
        self.soft_error_position = 0
        self.stored_ramp = [0, 2_000_000, 0, 40_000]
        self.step_mode, self.current_limit, self.decay_mode = 0, 6, 0
        """Those in use."""
        self.low_vin = self.driver_fault = self.kill_switch = self.err_line_high = False
        self.forward_limit = self.reverse_limit = False
        self.homing_speed_towards = self.homing_speed_away = 1_000_000
        self.other_settings: dict[int, int] = {}
        """Bytes by address, in the place of those that it has when it is new."""
        self.settings_end = SETTINGS_END
        """From where on it is silent; whether old ones are the guide doesn't say."""
        self.targets_end_homing = True
        """Whether they do the guide doesn't say."""
        self.on_the_way_in: Callable[[bytes], bytes] = lambda data: data
        self.on_the_way_out: Callable[[bytes], bytes] = lambda data: data
        self._lock = threading.RLock()
        self.commands: list[bytes] = []
        """All that were obeyed, or answered."""
        self.out_of_range: list[tuple[int, int]] = []
        """Commands with values that the guide doesn't allow."""
        self.power_up()

    def power_up(self) -> None:
        """Switch on, or off and on again."""
        self._now_s = self._up_since_s = self._heard_s = self._clock()
        self._partial = bytearray()
        self.state, self.energized, self.position_uncertain = RESET, False, True
        self.errors_occurred = 0
        self._deenergized = self._serial_error = self._timed_out = False
        self._safe_start_violation = not self.disable_safe_start
        self._safe_until_s = self._steady_at_s = -math.inf
        self._load_ramp()
        self._input = (HALTED, 0)
        self._homing: Callable[[], None] | None = None
        self.planning, self._target_position, self._target_velocity = OFF, 0, 0
        self.position, self._speed, self._direction, self._wait_s = 0, 0.0, 1, 0.0
        self.steps = 0
        self.waits: list[int] = []
        """Of every step that it set out for [ticks of 3 MHz]."""
        self._evaluate()

    def has_been_up(self, time_s: float) -> None:
        """Tell that it was switched on so long before it was."""
        self._up_since_s -= time_s

    def opened(self) -> None:
        """A Tic isn't reset by the opening of the port."""

    def exchange(self, sent: bytes) -> bytes:
        with self._lock:
            self._go_on()
            said = b"".join(self._take(byte) for byte in (self.on_the_way_in(sent) if sent else b""))
            return self.on_the_way_out(said) if said else b""

    def frame_badly(self) -> None:
        """Receive a byte without its stop bit."""
        with self._lock:
            self._go_on()
            self._note_serial_error(FRAMING)

    def press(self, name: str, pressed: bool = True) -> None:
        """Set one of the inputs that tests play with, at the present time."""
        with self._lock:
            self._go_on()
            setattr(self, name, pressed)
            self._evaluate()

    def go_home(self, direction: int) -> None:
        """Begin to look for a limit switch, backwards with -1: what somebody at the USB port may ask for."""
        with self._lock:
            self._go_on()
            self._begin_homing(direction)

    @property
    def is_homing(self) -> bool:
        return self._homing is not None

    @property
    def told(self) -> tuple[int, int]:
        """What it was told to do last: HALTED, POSITION or VELOCITY, and which."""
        return self._input

    @property
    def velocity(self) -> int:
        return round(self._direction * self._speed * 10_000)

    @property
    def ramp(self) -> list[int]:
        """Starting speed, max speed, max deceleration, max acceleration."""
        return list(self._ramp)

    @property
    def errors(self) -> int:
        bits = (
            self._deenergized, self.driver_fault, self.low_vin, self.kill_switch, False, self._serial_error,
            self._timed_out, self._safe_start_violation, self.err_line_high,
        )  # fmt: skip
        return sum(bit << place for place, bit in enumerate(bits))

    def _load_ramp(self) -> None:
        starting, fastest, deceleration, acceleration = self.stored_ramp
        self._ramp = [starting, fastest, deceleration or acceleration, acceleration]

    # What comes in.

    def _take(self, byte: int) -> bytes:
        if byte & 0x80:
            if self._partial:
                self._note_serial_error(FORMAT)
            self._partial = bytearray()
            if byte not in LENGTHS:
                self._note_serial_error(FORMAT)
                return b""
        elif not self._partial:
            self._note_serial_error(FORMAT)
            return b""
        self._partial.append(byte)
        if len(self._partial) < LENGTHS[self._partial[0]] + self.crc_for_commands:
            return b""
        whole, self._partial = bytes(self._partial), bytearray()
        if self.crc_for_commands:
            whole, crc = whole[:-1], whole[-1]
            if crc != crc_7(whole):
                self._note_serial_error(CRC)
                return b""
        self.commands.append(whole)
        return self._obey(whole)

    def _note_serial_error(self, which: int) -> None:
        self.errors_occurred |= which
        if self.control_mode == 0:
            self._serial_error = True
        self._evaluate()

    def _obey(self, whole: bytes) -> bytes:
        command = whole[0]
        if command in READ:
            memory = self._settings() if command == 0xA8 else self._variables()
            if whole[1] + whole[2] > len(memory):
                return b""
            answer = memory[whole[1] : whole[1] + whole[2]]
            if command == 0xA2:
                self.errors_occurred = self.errors
            assert 1 <= whole[2] <= 15
            return answer + (bytes([crc_7(answer)]) if self.crc_for_responses else b"")
        if command in ENDS_SERIAL_ERROR | {0x8C}:
            self._heard_s, self._timed_out = self._now_s, False
        if command in ENDS_SERIAL_ERROR:
            self._serial_error = False
        if command in WRITE_32:
            self._write(command, whole)
        elif command == GO_HOME:
            self._begin_homing(1 if whole[1] else -1)
        else:
            self._do(command)
        self._evaluate()
        return b""

    def _write(self, command: int, whole: bytes) -> None:
        data = bytes(byte | (whole[1] >> place & 1) << 7 for place, byte in enumerate(whole[2:]))
        value = int.from_bytes(data, "little", signed=command in (0xE0, 0xE3, 0xEC))
        low, high = {0xE0: (-(2**31), 2**31 - 1), 0xEC: (-(2**31), 2**31 - 1), 0xE3: (-500_000_000, 500_000_000),
                     0xE9: (100, 2**31 - 1), 0xEA: (100, 2**31 - 1)}.get(command, (0, 500_000_000))  # fmt: skip
        if not low <= value <= high:
            self.out_of_range.append((command, value))
        if command == 0xE5:
            self._ramp[0] = value
        elif command == 0xE6:
            self._ramp[1] = value
        elif command == 0xE9:
            self._ramp[2] = max(100, value) if value else self._ramp[3]
        elif command == 0xEA:
            self._ramp[3] = max(100, value)
        elif self.control_mode == 0:
            if command == 0xEC:
                self._halt()
                self.position, self.position_uncertain = value, False
            else:
                self._input = (POSITION if command == 0xE0 else VELOCITY, value)
                if self.targets_end_homing:
                    self._homing = None

    def _do(self, command: int) -> None:
        if command == 0x89 and self.control_mode == 0:
            self._halt()
            self.position_uncertain = True
        elif command in (0x85, 0x86):
            self._deenergized = command == 0x86
        elif command == 0x83 and self.control_mode == 0:
            self._safe_start_violation, self._safe_until_s = False, self._now_s + EXIT_LASTS_S
        elif command == 0x8F:
            self._safe_start_violation = not self.disable_safe_start

    def _halt(self) -> None:
        self._speed, self.planning, self._input, self._homing = 0.0, OFF, (HALTED, 0), None

    # What it tells.

    def _variables(self) -> bytes:
        flags = (self.energized, self.position_uncertain, self.forward_limit, self.reverse_limit, self.is_homing)
        memory = bytearray(0x55)
        struct.pack_into("<BBHI", memory, 0, self.state, sum(f << n for n, f in enumerate(flags)), self.errors,
                         self.errors_occurred)  # fmt: skip
        struct.pack_into("<Bii", memory, 0x09, self.planning, self._target_position, self._target_velocity)
        struct.pack_into("<4Iii", memory, 0x12, *self._ramp, self.position, self.velocity)
        struct.pack_into("<I", memory, 0x35, round((self._now_s - self._up_since_s) * 1000) % 2**32)
        memory[0x49:0x4C] = self.step_mode, self.current_limit, self.decay_mode
        struct.pack_into("<B", memory, 0x4C, self._input[0])
        struct.pack_into("<i", memory, 0x51, self._input[1])
        return bytes(memory)

    def _settings(self) -> bytes:
        memory = bytearray(SETTINGS_END)
        for layout, start, values in NEW_SETTINGS:
            struct.pack_into(layout, memory, start, *values)
        memory[0x01], memory[0x03] = self.control_mode, self.disable_safe_start
        struct.pack_into("<H", memory, 0x09, self.command_timeout_ms)
        memory[0x0B] = self.crc_for_commands | self.crc_for_responses << 1
        struct.pack_into("<4I", memory, 0x43, *self.stored_ramp)
        struct.pack_into("<Bi", memory, 0x53, self.soft_error_response, self.soft_error_position)
        struct.pack_into("<II", memory, 0x61, self.homing_speed_towards, self.homing_speed_away)
        for address, byte in self.other_settings.items():
            memory[address] = byte
        return bytes(memory[: self.settings_end])

    # Time, errors, and what they do.

    def _go_on(self) -> None:
        now_s = self._clock()
        while self._now_s + SLICE_S <= now_s:
            self._now_s += SLICE_S
            self._evaluate()
            if self.state == NORMAL:
                (self._homing or self._obey_input)()
            else:
                self._homing = None
            self._step_for(SLICE_S)

    def _evaluate(self) -> None:
        if self.control_mode == 0 and 0 < self.command_timeout_ms < (self._now_s - self._heard_s) * 1000:
            self._timed_out = True
        is_guarded = self.control_mode == 0 and not self.disable_safe_start
        if is_guarded and self.state != NORMAL and self._now_s >= self._safe_until_s:
            self._safe_start_violation = True
        self.errors_occurred |= self.errors
        before, self.state = self.state, self._next_state()
        if before == RESET and self.state != RESET:
            self._steady_at_s = self._now_s + CURRENT_STEADY_S
            self.state = self._next_state()
        if self.state in (RESET, DEENERGIZED):
            self._cut_power()
        elif self.state in (STARTING_UP, NORMAL):
            self.energized = True
        elif before == NORMAL:
            self._respond_to_soft_error()

    def _next_state(self) -> int:
        if self.driver_fault or self.low_vin:
            return RESET
        if self._deenergized:
            return DEENERGIZED
        if self.kill_switch or self._serial_error or self._timed_out or self._safe_start_violation:
            return SOFT_ERROR
        if self.err_line_high:
            return WAITING_FOR_ERR_LINE
        return STARTING_UP if self._now_s < self._steady_at_s else NORMAL

    def _cut_power(self) -> None:
        self.energized, self.position_uncertain = False, True
        self._speed, self.planning = 0.0, OFF

    def _respond_to_soft_error(self) -> None:
        if self.soft_error_response == DEENERGIZE:
            self._cut_power()
        elif self.soft_error_response == HALT_AND_HOLD:
            self._speed, self.planning, self.position_uncertain = 0.0, OFF, True
        elif self.soft_error_response == DECELERATE_TO_HOLD:
            self.planning, self._target_velocity = AT_VELOCITY, 0
        else:
            self.planning, self._target_position = TO_POSITION, self.soft_error_position

    def _obey_input(self) -> None:
        kind, value = self._input
        if kind == POSITION:
            self.planning, self._target_position = TO_POSITION, value
        elif kind == VELOCITY:
            self.planning, self._target_velocity = AT_VELOCITY, value

    # Homing: section 5.6.

    def _begin_homing(self, direction: int) -> None:
        if self.control_mode == 0 and self.state == NORMAL:
            self.position_uncertain, self._home_at_s = True, math.inf
            self._homing = lambda: self._go_towards_switch(direction)

    def _go_towards_switch(self, direction: int) -> None:
        self.planning, self._target_velocity = AT_VELOCITY, direction * self.homing_speed_towards
        if self.forward_limit if direction > 0 else self.reverse_limit:
            self._home_at_s = min(self._home_at_s, self._now_s + AT_HOME_S)
        if self._now_s >= self._home_at_s:
            self._homing = lambda: self._leave_switch(direction)

    def _leave_switch(self, direction: int) -> None:
        self.planning, self._target_velocity = AT_VELOCITY, -direction * self.homing_speed_away
        if not (self.forward_limit if direction > 0 else self.reverse_limit):
            self._halt()
            self.position, self.position_uncertain = 0, False

    # The motor, step by step.

    def _step_for(self, left_s: float) -> None:
        while self.planning != OFF:
            if self._speed and self._may_stop_at_once():
                self._speed = 0.0
            if not self._speed and not self._set_out():
                return
            if self._wait_s > left_s:
                self._wait_s -= left_s
                return
            left_s -= self._wait_s
            self.position += self._direction
            self.steps += 1
            self._speed = self._next_speed()
            self._wait_s = self._step_wait_s()

    def _set_out(self) -> bool:
        ahead = self._target_position - self.position if self.planning == TO_POSITION else self._target_velocity
        if not ahead or (self.forward_limit if ahead > 0 else self.reverse_limit) or self._ramp[1] < 7:
            return False
        self._direction = 1 if ahead > 0 else -1
        starting, _, _, acceleration = self._in_steps()
        self._speed = min(max(starting, math.sqrt(2 * acceleration)), self._top_speed())
        self._wait_s = self._step_wait_s()
        return self._speed > 0

    def _step_wait_s(self) -> float:
        """Return how long the step lasts that begins: whole ticks of its timer, rounded down."""
        if not self._speed:
            return 0.0
        self.waits.append(int(30_000_000_000 // round(self._speed * 10_000)))
        return self.waits[-1] / 3e6

    def _in_steps(self) -> tuple[float, float, float, float]:
        starting, fastest, deceleration, acceleration = self._ramp
        return starting / 10_000, fastest / 10_000, deceleration / 100, acceleration / 100

    def _top_speed(self) -> float:
        fastest = self._in_steps()[1]
        return min(fastest, abs(self._target_velocity) / 10_000) if self.planning == AT_VELOCITY else fastest

    def _may_stop_at_once(self) -> bool:
        starting, _, deceleration, _ = self._in_steps()
        is_wanted = self.planning == AT_VELOCITY and self._target_velocity * self._direction <= 0
        return is_wanted and self._speed <= max(starting, math.sqrt(2 * deceleration))

    def _next_speed(self) -> float:
        """Return the speed after a step: v² changes by twice the acceleration a step."""
        starting, _, deceleration, acceleration = self._in_steps()
        if self.forward_limit if self._direction > 0 else self.reverse_limit:
            return 0.0
        stops_at = max(starting, math.sqrt(2 * deceleration))
        if self.planning == TO_POSITION:
            left = (self._target_position - self.position) * self._direction
        else:
            left = 2**31 if self._target_velocity * self._direction > 0 else 0
        if left <= 0:
            if self._speed <= stops_at * 1.000001:
                return 0.0
            return math.sqrt(max(stops_at**2, self._speed**2 - 2 * deceleration))
        most = min(self._top_speed() ** 2, stops_at**2 + 2 * deceleration * (left - 1))
        if self._speed**2 > most:
            return math.sqrt(max(most, self._speed**2 - 2 * deceleration))
        return math.sqrt(min(most, max(starting**2, self._speed**2 + 2 * acceleration)))


class TicOnACable(PseudoTerminal):
    """A Tic at a pseudo-terminal, plugged in while the context lasts."""

    def __init__(self, tic: TicEmulator | None = None) -> None:
        super().__init__()
        self.tic = tic or TicEmulator()

    def exchange(self, data: bytes) -> bytes:
        return self.tic.exchange(data)
