"""The constants of a ramp that a controller computes while it plays it, as bytes of a ramp image.

docs/serial_protocol.md has the format.
"""

import struct

from stepramp.methods.common.fixed_point import RAMP_INDEX_BITS, Format
from stepramp.ramp.on_chip import ON_CHIP, Factor, OnChipRamp, OnChipSide

FORMULA_BYTES = 93
METHODS = {name: method.number for name, method in ON_CHIP.items()}
"""The number of each method."""

_FACTOR = struct.Struct("<Ib")
_X = struct.Struct("<IB")


def encode_formula(ramp: OnChipRamp) -> bytes:
    """Return a ramp's constants as FORMULA_BYTES bytes."""
    return b"".join(
        (
            struct.pack("<BI", METHODS[ramp.method], ramp.slew_interval),
            _FACTOR.pack(*ramp.down.carry or Factor(0, 0)),
            _FACTOR.pack(*ramp.up.carry or Factor(0, 0)),
            _packed(ramp.up),
            _packed(ramp.down),
        )
    )


def _packed(side: OnChipSide) -> bytes:
    form: Format = side.form
    whole, fraction = divmod(form.first_ramp_index, 1 << RAMP_INDEX_BITS)
    return b"".join(
        (
            _u24(side.steps),
            struct.pack("<I", side.longest_interval),
            _X.pack(*form.longest),
            _X.pack(*form.shortest),
            *(_u24(output.multiplier) + bytes((output.fraction_bits // 8,)) for output in form.outputs),
            _u24(fraction),
            _u24(whole),
        )
    )


def _u24(number: int) -> bytes:
    return number.to_bytes(3, "little")
