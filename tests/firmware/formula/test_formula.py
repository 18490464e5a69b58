import itertools
import struct
from collections.abc import Iterator

import numpy as np
import pytest
from hypothesis import HealthCheck, assume, example, given, settings
from hypothesis import strategies as st

from firmware.formula.machine import MOST_AT_ONCE, Machine, build_for_chip, build_for_host
from firmware.host import missing_compiler
from ramp.test_fixed_point import State, newton_step, taylor_step
from ramp.test_on_chip import METHODS, both_slopes, methods, nearest, possible
from simulator.avr import missing_tools
from stepramp.controllers.stepramp.formula_image import FORMULA_BYTES, encode_formula
from stepramp.methods.common.fixed_point import Format, Output, Scaled
from stepramp.ramp.on_chip import MotorState, OnChipMotor, OnChipRamp, slopes_refusal
from stepramp.shapes.constant import ConstantAcceleration as Slope
from tools import require

LONGEST_ON_THE_CHIP_STEPS = 1500
UP_AT, SIDE_BYTES = 15, 39
DOWN, COMPROMISE, NEWTON = 1, 2, 4
LONGEST_STEPPED = 0xC0000000
"""Up to here x² + x⁴ is below 1; p1 of a ramp from rest is at 0.7071 · 2³²."""
per_machine = settings(suppress_health_check=[HealthCheck.function_scoped_fixture])


@pytest.fixture(scope="module")
def host(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Machine]:
    require(*missing_compiler())
    with Machine(build_for_host(tmp_path_factory.mktemp("formula"))) as running:
        yield running


@pytest.fixture(scope="module")
def chip(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Machine]:
    require(*missing_tools())
    with Machine(build_for_chip(tmp_path_factory.mktemp("formula"))) as running:
        yield running


@pytest.fixture(params=["host", "chip"])
def machine(request: pytest.FixtureRequest) -> Machine:
    found: Machine = request.getfixturevalue(request.param)
    return found


def play(machine: Machine, ramp: OnChipRamp, steps: int) -> list[int]:
    """Play a move as a controller does, several intervals at a time."""
    assert machine.check(encode_formula(ramp))
    played: list[int] = []
    while (intervals := machine.up(16, steps - len(played))).size:
        played += intervals.tolist()
    status = machine.status()
    hold = status.hold_interval if played else status.creep_interval
    played += [hold] * (steps - len(played) - status.steps_down)
    while (intervals := machine.down(MOST_AT_ONCE)).size:
        played += intervals.tolist()
    return played


@pytest.mark.parametrize("method", METHODS)
def test_moves_are_those_of_the_host(host: Machine, method: str) -> None:
    for sides in possible(method, 200_000):
        ramp = OnChipRamp.of(*sides, method)
        whole = ramp.up.steps + ramp.down.steps
        # The long ones are alike all the way: what is of interest is that they are right at all.
        lengths = {1, 2, whole // 2, whole - 1, whole + 3} if whole < 5000 else {whole + 3}
        for steps in lengths - {0}:
            np.testing.assert_array_equal(play(host, ramp, steps), ramp.move(steps), err_msg=f"{ramp} {steps}")


@pytest.mark.parametrize("method", METHODS)
def test_moves_on_the_chip_are_those_of_the_host(chip: Machine, method: str) -> None:
    for sides in possible(method, LONGEST_ON_THE_CHIP_STEPS):
        ramp = OnChipRamp.of(*sides, method)
        for steps in (ramp.up.steps // 2 + 1, ramp.up.steps + ramp.down.steps + 3):
            np.testing.assert_array_equal(play(chip, ramp, steps), ramp.move(steps), err_msg=f"{ramp} {steps}")


commands = st.lists(st.tuples(st.sampled_from(["up", "down", "fit"]), st.integers(0, MOST_AT_ONCE)), max_size=15)


@given(sides=both_slopes, method=methods, given_commands=commands)
@per_machine
def test_any_way_is_that_of_the_host(
    machine: Machine, sides: tuple[Slope, Slope], method: str, given_commands: list[tuple[str, int]]
) -> None:
    assume(slopes_refusal(*sides, method) is None)
    ramp = OnChipRamp.of(*sides, method)
    motor = OnChipMotor(ramp)
    assert machine.check(encode_formula(ramp))
    for command, count in given_commands:
        if command == "fit":
            steps_left = motor.steps_down + count // 2
            fitting = motor.fitting(steps_left, count)
            assert machine.up(count, steps_left).tolist() == motor.up(fitting).tolist()
        elif command == "up":
            assert machine.up(count).tolist() == motor.up(count).tolist()
        else:
            assert machine.down(count).tolist() == motor.down(count).tolist()
        status = machine.status()
        assert status.steps_down == motor.steps_down
        assert status.slews == motor.slews
        assert status.creep_interval == ramp.creep_interval
        if motor.state is not MotorState.REST:
            assert status.hold_interval == motor.hold_interval


# Single steps from any state. The expected ones are those of unbounded integers, of tests/ramp/test_fixed_point.py.

exponents = st.integers(0, 3)


@st.composite
def ways(draw: st.DrawFn) -> Format:
    """Any way that formula_check accepts for formulas (20) and (23), but for its intervals."""
    first, last = sorted((draw(exponents), draw(exponents)))
    mantissas = st.integers(15 << 24, (240 << 24) - 1)
    longest, shortest = Scaled(draw(mantissas), first), Scaled(draw(mantissas), last)
    assume(first != last or shortest.mantissa < longest.mantissa)
    assume(first != 0 or longest.mantissa <= LONGEST_STEPPED)
    outputs = st.builds(Output, st.integers(0, 2**24 - 2**15 - 1), st.sampled_from([0, 8, 16, 24]))
    fraction = draw(st.integers(0, 2**24 - 1))
    return Format(longest, shortest, fraction, tuple(draw(outputs) for _ in range(4)))


def bytes_of(way: Format) -> bytes:
    ends = struct.pack("<IIBIB", 0, *way.longest, *way.shortest)
    outputs = b"".join(struct.pack("<I", output.multiplier | output.fraction_bits // 8 << 24) for output in way.outputs)
    return bytes(3) + ends + outputs + way.first_ramp_index.to_bytes(6, "little")


@given(way=ways(), part=st.floats(0, 1), count=st.integers(1, 9), down=st.booleans(), compromise=st.booleans())
@settings(per_machine, max_examples=300)
def test_steps_by_20_and_23_are_those_of_unbounded_integers(
    machine: Machine, way: Format, part: float, count: int, down: bool, compromise: bool
) -> None:
    exponent = round(way.longest.exponent + part * (way.shortest.exponent - way.longest.exponent))
    most = way.longest.mantissa if exponent == way.longest.exponent else (240 << 24) - 1
    least = way.shortest.mantissa if exponent == way.shortest.exponent else 15 << 24
    x = State(least + int((part * 1e6 % 1) * (most - least)), exponent)
    # The ends of the way are not looked at here.
    open_way = Format(Scaled(2**32 - 1, 0), Scaled(15 << 24, 3), way.first_ramp_index, way.outputs)
    expected = [x]
    for _ in range(count):
        assume(expected[-1].exponent > 0 or expected[-1].mantissa <= LONGEST_STEPPED)
        assume(expected[-1] != open_way.shortest)
        expected.append(taylor_step(expected[-1], (1 << 16) * compromise, not down, open_way))

    stepped = machine.step(count, DOWN * down + COMPROMISE * compromise, 0, *x, bytes_of(way))

    assert stepped.intervals.tolist() == [nearest(x, way) for x in expected[1:]]
    assert (stepped.mantissa, stepped.exponent) == expected[-1]


ROUNDED_UP = Format(Scaled(2**32 - 1, 0), Scaled(15 << 24, 3), 0, tuple(Output(each, 0) for each in (1, 2, 3, 4)))
"""With an x just below 15/16, which is rounded up to it and then doesn't change: the exponent does."""


@given(
    way=ways(),
    exponent=exponents,
    mantissa=st.integers(15 << 24, (240 << 24) - 1),
    product=st.floats(0.2, 1.05),
    down=st.booleans(),
)
@example(way=ROUNDED_UP, exponent=3, mantissa=(240 << 24) - 48, product=0.5, down=False)
@settings(per_machine, max_examples=500)
def test_steps_by_newton_are_those_of_unbounded_integers(
    machine: Machine, way: Format, exponent: int, mantissa: int, product: float, down: bool
) -> None:
    # k x² of up to 1.05, where 1/2 is what it converges to
    k = int(product / (mantissa / 2**32 / 16**exponent) ** 2 * 2**24) >> 24
    assume(1 <= k < min(256**exponent * 255, 2**24 - 9))
    x = State(mantissa, exponent)
    expected, index = [x], k << 24 | way.first_ramp_index
    for _ in range(3):
        index += (-1 if down else 1) << 24
        assume(expected[-1].exponent > 0 or expected[-1].mantissa < 0.75 * 2**32)
        assume(2**24 <= index < 2**48 and index >> 8 * expected[-1].exponent < 2**32)
        wide = newton_without_limit(expected[-1], index)
        assume(wide is not None)
        expected.append(wide)

    stepped = machine.step(3, DOWN * down + NEWTON, k, *x, bytes_of(way))

    assert stepped.intervals.tolist() == [nearest(x, way) for x in expected[1:]]
    assert (stepped.mantissa, stepped.exponent) == expected[-1]


def newton_without_limit(x: State, k: int) -> State | None:
    """A step as in tests/ramp/test_fixed_point.py, where it may also go beyond 32 bits and be normalised from there."""
    try:
        return newton_step(x, k)
    except AssertionError:
        rounded = (x.mantissa + 2**15) // 2**16
        grown = rounded * 2**16 + rounded * ((2**31 - product_of(rounded, k >> 8 * x.exponent)) // 256) // 256
        return State(grown // 16, x.exponent - 1) if grown >= 2**32 and x.exponent > 0 else None


def product_of(x: int, k: int) -> int:
    return sum((k >> 8 * position & 255) * (x * x >> 8 * (3 - position)) for position in range(4))


# Untrusted bytes.


def good_ramps() -> list[bytes]:
    sides = [(100.0, 100.0), (100.0, 450.0), (3000.0, 20.0), (1.1, 5.5)]
    return [
        encode_formula(OnChipRamp.of(Slope(2e6, base, 900, 900**2 / up), Slope(2e6, base, 900, 900**2 / down), method))
        for method, (up, down), base in itertools.product(METHODS, sides, [0, 300])
        if slopes_refusal(Slope(2e6, base, 900, 900**2 / up), Slope(2e6, base, 900, 900**2 / down), method) is None
    ]


changes = st.lists(
    st.tuples(
        st.integers(0, FORMULA_BYTES - 1), st.integers(0, 255) | st.sampled_from([0, 1, 15, 16, 127, 128, 240, 255])
    ),
    min_size=1,
    max_size=3,
)


@given(st.sampled_from(good_ramps()), st.sampled_from(good_ramps()), st.integers(0, FORMULA_BYTES), changes, commands)
@settings(max_examples=2000, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_bytes_that_are_found_good_are_safe(
    host: Machine,
    constants: bytes,
    other: bytes,
    cut: int,
    changed: list[tuple[int, int]],
    given_commands: list[tuple[str, int]],
) -> None:
    mixed = bytearray(constants[:cut] + other[cut:])
    for at, byte in changed:
        mixed[at] = byte
    if not host.check(bytes(mixed), (60, 2**28 - 1)):
        return
    for command, count in given_commands:
        if command == "down":
            intervals = host.down(count)
        else:
            intervals = host.up(count, count if command == "fit" else 2**32 - 1)
        assert intervals.size <= count
        assert ((intervals >= 60) & (intervals < 2**28)).all()
    left = host.status().steps_down
    assert left < 2**24
    if left < 20_000:
        while (intervals := host.down(MOST_AT_ONCE)).size:
            left -= intervals.size
            assert ((intervals >= 60) & (intervals < 2**28)).all()
        assert left == 0
    host.status()


@pytest.mark.parametrize("constants", good_ramps(), ids=itertools.count())
def test_limits_are_kept(machine: Machine, constants: bytes) -> None:
    slew, p1_up, p1_down = (struct.unpack_from("<I", constants, at)[0] for at in (1, UP_AT + 3, UP_AT + SIDE_BYTES + 3))
    longest = max(p1_up, p1_down)
    assert machine.check(constants, (slew, longest))
    assert not machine.check(constants, (slew + 1, longest))
    assert not machine.check(constants, (slew, longest - 1))


@pytest.mark.parametrize(
    ("at", "byte"),
    [(0, 3), (UP_AT + 11, 4), (UP_AT + 10, 14), (UP_AT + 15, 240), (UP_AT, 0), (UP_AT + 6, 16), (4, 16), (2, 0)],
)
def test_a_bad_byte_is_found(host: Machine, at: int, byte: int) -> None:
    sides = Slope(2e6, 0, 900, 900**2 / 200), Slope(2e6, 0, 900, 900**2 / 500)
    good = encode_formula(OnChipRamp.of(*sides, "compromise"))
    assert host.check(good, (1000, 2**28 - 1))
    bad = bytearray(good)
    bad[at] = byte
    assert not host.check(bytes(bad), (1000, 2**28 - 1))
