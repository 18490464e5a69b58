"""The settings that a Tic keeps, as its settings file names them: User's Guide (Pololu 0J71), section 6."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass

from stepramp.controllers.tic.variables import Block
from stepramp.controllers.tic.wire import MOST_BLOCK_BYTES, Read

FIRST, LATER, PRODUCT, END = 0x00, 0x5E, 0x6C, 0x70
"""Addresses: the first setting, those that came with later firmwares, those that differ from product to product, and
where what is read ends. The driver of a 36v4 has more of them, from 0xF2 on: no address that a serial port is told by
the guide goes so far."""
BAUD_RATE_FACTOR = 12_000_000
PINS = ("scl", "sda", "tx", "rx", "rc")
POLARITIES = 0x36
"""A bit for each of the pins."""

CONTROL_MODES = (
    "serial", "step_dir", "rc_position", "rc_speed", "analog_position", "analog_speed", "encoder_position",
    "encoder_speed",
)  # fmt: skip
RESPONSES = ("deenergize", "halt_and_hold", "decel_to_hold", "go_to_position")
DEGREES = ("linear", "quadratic", "cubic")
PIN_FUNCTIONS = (
    "default", "user_io", "user_input", "pot_power", "serial", "rc", "encoder", "kill_switch", "limit_switch_forward",
    "limit_switch_reverse",
)  # fmt: skip
STEP_MODES = ("1", "2", "4", "8", "16", "32", "2_100p", "64", "128", "256")


@dataclass(frozen=True)
class Setting:
    """A line of a settings file."""

    name: str
    addresses: tuple[int, ...]
    """Of its bytes, the least one first."""
    told: Callable[[int], str] = str
    """Makes a value of what they are; IndexError for what the guide has no word for."""


def word(words: tuple[str, ...]) -> Callable[[int], str]:
    """Return what tells a number as one of some words."""
    return lambda value: words[value]


def flag(bit: int = 0) -> Callable[[int], str]:
    """Return what tells whether a bit is set."""
    return lambda value: "true" if value >> bit & 1 else "false"


def _signed(bits: int) -> Callable[[int], str]:
    return lambda value: str(value - (1 << bits) if value >> bits - 1 else value)


def _baud_rate(value: int) -> str:
    return str((BAUD_RATE_FACTOR + (value + 1) // 2) // (value + 1))


def _device_number(value: int) -> str:
    return str(value & 0x7F | (value >> 8 & 0x7F) << 7)


def _pin(place: int) -> Callable[[int], str]:
    """Return what tells a pin's byte and, above it, that of all polarities."""

    def told(value: int) -> str:
        marks = (("pullup", 7), ("analog", 6), ("active_high", 8 + place))
        return " ".join([PIN_FUNCTIONS[value & 0x0F], *(mark for mark, bit in marks if value >> bit & 1)])

    return told


def _at(address: int, length: int) -> tuple[int, ...]:
    return tuple(range(address, address + length))


COMMON = (
    Setting("control_mode", (0x01,), word(CONTROL_MODES)),
    Setting("never_sleep", (0x02,), flag()),
    Setting("disable_safe_start", (0x03,), flag()),
    Setting("ignore_err_line_high", (0x04,), flag()),
    Setting("auto_clear_driver_error", (0x08,), flag()),
    Setting("soft_error_response", (0x53,), word(RESPONSES)),
    Setting("soft_error_position", _at(0x54, 4), _signed(32)),
    Setting("serial_baud_rate", _at(0x05, 2), _baud_rate),
    Setting("serial_device_number", (0x07, 0x69), _device_number),
    Setting("serial_alt_device_number", (0x6A, 0x6B), _device_number),
    Setting("serial_enable_alt_device_number", (0x6A,), flag(7)),
    Setting("serial_14bit_device_number", (0x0B,), flag(3)),
    Setting("command_timeout", _at(0x09, 2)),
    Setting("serial_crc_for_commands", (0x0B,), flag(0)),
    Setting("serial_crc_for_responses", (0x0B,), flag(1)),
    Setting("serial_7bit_responses", (0x0B,), flag(2)),
    Setting("serial_response_delay", (0x5E,)),
    Setting("vin_calibration", _at(0x14, 2), _signed(16)),
    Setting("input_averaging_enabled", (0x2E,), flag()),
    Setting("input_hysteresis", _at(0x2F, 2)),
    Setting("input_scaling_degree", (0x20,), word(DEGREES)),
    Setting("input_invert", (0x21,), flag()),
    Setting("input_min", _at(0x22, 2)),
    Setting("input_neutral_min", _at(0x24, 2)),
    Setting("input_neutral_max", _at(0x26, 2)),
    Setting("input_max", _at(0x28, 2)),
    Setting("output_min", _at(0x2A, 4), _signed(32)),
    Setting("output_max", _at(0x32, 4), _signed(32)),
    Setting("encoder_prescaler", _at(0x58, 4)),
    Setting("encoder_postscaler", _at(0x37, 4)),
    Setting("encoder_unlimited", (0x5C,), flag()),
    *(Setting(f"{pin}_config", (0x3B + place, POLARITIES), _pin(place)) for place, pin in enumerate(PINS)),
    Setting("invert_motor_direction", (0x1B,), flag()),
    Setting("max_speed", _at(0x47, 4)),
    Setting("starting_speed", _at(0x43, 4)),
    Setting("max_accel", _at(0x4F, 4)),
    Setting("max_decel", _at(0x4B, 4)),
    Setting("step_mode", (0x41,), word(STEP_MODES)),
    Setting("auto_homing", (0x02,), flag(1)),
    Setting("auto_homing_forward", (0x02,), flag(2)),
    Setting("homing_speed_towards", _at(0x61, 4)),
    Setting("homing_speed_away", _at(0x65, 4)),
)
"""Those that mean the same with every product."""


UNHEEDED = (
    Setting("low_vin_timeout", _at(0x0C, 2)),
    Setting("low_vin_shutoff_voltage", _at(0x0E, 2)),
    Setting("low_vin_startup_voltage", _at(0x10, 2)),
    Setting("high_vin_shutoff_voltage", _at(0x12, 2)),
    Setting("rc_max_pulse_period", _at(0x16, 2)),
    Setting("rc_bad_signal_timeout", _at(0x18, 2)),
    Setting("rc_consecutive_good_pulses", (0x1A,)),
    Setting("input_error_min", _at(0x1C, 2)),
    Setting("input_error_max", _at(0x1E, 2)),
    Setting("kill_switch_map", (0x5D,)),
    Setting("limit_switch_forward_map", (0x5F,)),
    Setting("limit_switch_reverse_map", (0x60,)),
)
"""Those that ticcmd leaves out of a settings file: no firmware heeds them, or they follow from others."""


def blocks(start: int, end: int) -> Iterator[Block]:
    """Yield the blocks that the settings between two addresses are asked for in."""
    for address in range(start, end, MOST_BLOCK_BYTES):
        yield Block(Read.SETTINGS, address, f"{min(MOST_BLOCK_BYTES, end - address)}B")


@dataclass(frozen=True)
class Settings:
    """All that a Tic keeps."""

    bytes: Mapping[int, int]
    """By address; those that it didn't tell are missing, as with an old firmware."""

    def told(self, settings: Iterable[Setting]) -> dict[str, str]:
        """Return the values of those settings that it told, and that there is a word for."""
        values = ((each.name, self.value(each)) for each in settings)
        return {name: value for name, value in values if value is not None}

    def value(self, setting: Setting) -> str | None:
        """Return a value as a settings file has it; None for what was not told, or has no word."""
        number = self.number(setting)
        try:
            return None if number is None else setting.told(number)
        except IndexError:
            return None

    def number(self, setting: Setting) -> int | None:
        """Return a value as it is kept; None for what was not told."""
        if not self.bytes.keys() >= set(setting.addresses):
            return None
        return int.from_bytes(bytes(self.bytes[each] for each in setting.addresses), "little")
