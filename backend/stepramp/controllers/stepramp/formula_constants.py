"""The constants of a ramp by formula, from the bytes of a ramp image; formula_image makes them."""

import struct

from stepramp.controllers.stepramp.formula_image import FORMULA_BYTES, METHODS, encode_formula
from stepramp.methods.common.fixed_point import (
    EXPONENTS,
    LEAST_MANTISSA,
    MANTISSA_LIMIT,
    RAMP_INDEX_BITS,
    Format,
    Output,
    Scaled,
)
from stepramp.ramp.on_chip import Factor, OnChipRamp, OnChipSide

_METHOD_AND_SLEW = struct.Struct("<BI")
_FACTOR = struct.Struct("<Ib")
_X = struct.Struct("<IB")
_U24 = 3
_TICKS = 4


def decode_formula(constants: bytes, limits: range) -> OnChipRamp:
    """Return the ramp of packed constants; ValueError when they make no sense, or an interval lies beyond limits."""
    if len(constants) != FORMULA_BYTES:
        raise ValueError(f"{len(constants)} bytes of constants, where {FORMULA_BYTES} are allowed")
    method, slew = _METHOD_AND_SLEW.unpack_from(constants)
    if method not in METHODS.values():
        raise ValueError(f"method {method} is not known")
    at = _METHOD_AND_SLEW.size
    down_carry = Factor(*_FACTOR.unpack_from(constants, at))
    up_carry = Factor(*_FACTOR.unpack_from(constants, at + _FACTOR.size))
    sides = constants[at + 2 * _FACTOR.size :]
    half = len(sides) // 2
    ramp = OnChipRamp(
        method=next(name for name, number in METHODS.items() if number == method),
        up=_side(sides[:half], up_carry),
        down=_side(sides[half:], down_carry),
        slew_interval=slew,
    )
    if encode_formula(ramp) != constants:
        raise ValueError("constants that contradict each other")
    for interval in (slew, ramp.up.longest_interval, ramp.down.longest_interval):
        if interval not in limits:
            raise ValueError(f"an interval of {interval:,} ticks, where {limits[0]:,} to {limits[-1]:,} is allowed")
    return ramp


def _side(packed: bytes, carry: Factor) -> OnChipSide:
    at = _U24 + _TICKS
    longest, shortest = (_scaled(*_X.unpack_from(packed, at + number * _X.size)) for number in range(2))
    at += 2 * _X.size
    outputs = [
        Output(
            int.from_bytes(packed[at + 4 * number : at + 4 * number + _U24], "little"),
            8 * packed[at + 4 * number + _U24],
        )
        for number in range(EXPONENTS)
    ]
    index = packed[at + 4 * EXPONENTS :]
    fraction, whole = int.from_bytes(index[:_U24], "little"), int.from_bytes(index[_U24:], "little")
    form = Format(
        longest=longest,
        shortest=shortest,
        first_ramp_index=whole << RAMP_INDEX_BITS | fraction,
        outputs=tuple(outputs),
    )
    steps = int.from_bytes(packed[:_U24], "little")
    if steps < 1 or any(output.fraction_bits > 24 for output in outputs):
        raise ValueError(f"{steps} steps with outputs {outputs}")
    return OnChipSide(steps, form, carry if any(carry) else None)


def _scaled(mantissa: int, exponent: int) -> Scaled:
    if not LEAST_MANTISSA <= mantissa < MANTISSA_LIMIT or exponent >= EXPONENTS:
        raise ValueError(f"x of {mantissa} with exponent {exponent}")
    return Scaled(mantissa, exponent)
