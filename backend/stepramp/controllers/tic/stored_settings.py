"""All that a Tic keeps without power, as bytes: the names and places of User's Guide (Pololu 0J71), section 7.

Over its serial port they are read and not written: that takes its USB port. So a backup has them as comments, which
`ticcmd` and its Control Center pass over, and a restore says which are others by now.
"""

import re
import struct
from collections.abc import Iterator
from dataclasses import dataclass

from stepramp.controllers.tic.variables import Block
from stepramp.controllers.tic.wire import MOST_BLOCK_BYTES, Read
from stepramp.errors import Count, Rejected, Rejection

LENGTH = 0x5D
"""What the first firmware has; a later one may have more, of homing, that it isn't known to tell."""
BLOCKS = tuple(
    Block(Read.SETTINGS, offset, f"<{min(MOST_BLOCK_BYTES, LENGTH - offset)}B")
    for offset in range(0, LENGTH, MOST_BLOCK_BYTES)
)
_STORED = re.compile(r"# stored (?P<offset>[0-9a-f]{2}): (?P<bytes>[0-9a-f]{2}(?: [0-9a-f]{2})*)")
ALLOWED = f"lines '# stored 00: …' with {LENGTH} bytes in all, as a backup has them"


@dataclass(frozen=True)
class Setting:
    """One of them. layout: as the module struct has it."""

    name: str
    offset: int
    layout: str = "<B"

    def told(self, stored: bytes) -> int:
        """Return its value, in the Tic's own units."""
        return int(struct.unpack_from(self.layout, stored, self.offset)[0])


NAMED = (
    Setting("control_mode", 0x01),
    Setting("never_sleep", 0x02),
    Setting("disable_safe_start", 0x03),
    Setting("ignore_err_line_high", 0x04),
    Setting("serial_baud_rate_generator", 0x05, "<H"),
    Setting("serial_device_number", 0x07),
    Setting("auto_clear_driver_error", 0x08),
    Setting("command_timeout", 0x09, "<H"),
    Setting("serial_crc_enabled", 0x0B),
    Setting("low_vin_timeout", 0x0C, "<H"),
    Setting("low_vin_shutoff_voltage", 0x0E, "<H"),
    Setting("low_vin_startup_voltage", 0x10, "<H"),
    Setting("high_vin_shutoff_voltage", 0x12, "<H"),
    Setting("vin_calibration", 0x14, "<h"),
    Setting("rc_max_pulse_period", 0x16, "<H"),
    Setting("rc_bad_signal_timeout", 0x18, "<H"),
    Setting("rc_consecutive_good_pulses", 0x1A),
    Setting("invert_motor_direction", 0x1B),
    Setting("input_error_min", 0x1C, "<H"),
    Setting("input_error_max", 0x1E, "<H"),
    Setting("input_scaling_degree", 0x20),
    Setting("input_invert", 0x21),
    Setting("input_min", 0x22, "<H"),
    Setting("input_neutral_min", 0x24, "<H"),
    Setting("input_neutral_max", 0x26, "<H"),
    Setting("input_max", 0x28, "<H"),
    Setting("output_min", 0x2A, "<i"),
    Setting("input_averaging_enabled", 0x2E),
    Setting("input_hysteresis", 0x2F, "<H"),
    Setting("current_limit_during_error", 0x31),
    Setting("output_max", 0x32, "<i"),
    Setting("encoder_postscaler", 0x37, "<I"),
    Setting("scl_config", 0x3B),
    Setting("sda_config", 0x3C),
    Setting("tx_config", 0x3D),
    Setting("rx_config", 0x3E),
    Setting("rc_config", 0x3F),
    Setting("current_limit", 0x40),
    Setting("step_mode", 0x41),
    Setting("decay_mode", 0x42),
    Setting("starting_speed", 0x43, "<I"),
    Setting("max_speed", 0x47, "<I"),
    Setting("max_decel", 0x4B, "<I"),
    Setting("max_accel", 0x4F, "<I"),
    Setting("soft_error_response", 0x53),
    Setting("soft_error_position", 0x54, "<i"),
    Setting("encoder_prescaler", 0x58, "<I"),
    Setting("encoder_unlimited", 0x5C),
)


def lines_of(stored: bytes) -> Iterator[str]:
    """Yield lines that tell all of them, as comments: for people, and for a restore as bytes."""
    yield "# What the Tic keeps without power, in its own units. Only its USB port writes that."
    yield from (f"# {each.name}: {each.told(stored)}" for each in NAMED)
    for block in BLOCKS:
        data = stored[block.offset : block.offset + block.length]
        yield f"# stored {block.offset:02x}: {data.hex(' ')}"


def stored_in(text: str) -> bytes | None:
    """Return what a backup tells of them; None for one that doesn't, as a settings file or an older backup.

    Raises Rejected when a part of it is missing.
    """
    parts = list(filter(None, map(_STORED.fullmatch, (line.strip() for line in text.splitlines()))))
    if not parts:
        return None
    told = {int(each["offset"], 16): bytes.fromhex(each["bytes"]) for each in parts}
    stored = b"".join(told.get(block.offset, b"")[: block.length] for block in BLOCKS)
    if len(stored) != LENGTH:
        raise Rejected([Rejection("text", Count(f"{len(stored)} bytes of settings"), ALLOWED)])
    return stored


def differing(stored: bytes, present: bytes) -> Iterator[str]:
    """Yield which settings are others than those that were stored in a backup, as sentences."""
    names = []
    covered = {0x00}
    for each in NAMED:
        covered |= set(range(each.offset, each.offset + struct.calcsize(each.layout)))
        if each.told(stored) != each.told(present):
            names.append(f"{each.name} {each.told(present)} (in the backup {each.told(stored)})")
    names += [
        f"byte 0x{offset:02x} {present[offset]} (in the backup {stored[offset]})"
        for offset in range(LENGTH)
        if offset not in covered and stored[offset] != present[offset]
    ]
    if names:
        others = ", ".join(names)
        yield f"The Tic keeps other settings than in the backup: {others}. The Tic Control Center writes them."
