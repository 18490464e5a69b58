"""Ramps that a board makes itself, from speeds and accelerations, against the exact intervals."""

import struct
import subprocess
from collections.abc import Iterator
from pathlib import Path

import mpmath
import pytest

from firmware.host import Host, missing_compiler
from tools import require

HERE = Path(__file__).parent
SOURCES = HERE.parents[1] / "firmware" / "src"
TICKS_HZ = 2_000_000
FAST_TICKS_HZ = 16_000_000
HEADER = struct.Struct("<BHBBBIH")
FINENESS = (512, 256, 128, 64)


@pytest.fixture(scope="module")
def maker(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Host]:
    require(*missing_compiler())
    program = tmp_path_factory.mktemp("ramp_maker") / "driver"
    flags = ["-std=c99", "-g", "-O1", "-Wall", "-Wextra", "-Werror", "-fsanitize=address,undefined"]
    sources = [str(SOURCES / "stepramp" / "store" / "ramp_maker.c"), str(HERE / "ramp_maker_driver.c")]
    command = ["gcc", *flags, "-fno-sanitize-recover=all", f"-I{SOURCES}", "-o", str(program), *sources, "-lm"]
    subprocess.run(command, check=True)
    with Host(program) as host:
        yield host


def intervals_in(data: bytes) -> list[int]:
    """Return the intervals of a packed list, as docs/serial_protocol.md has it."""
    numbers, value, shift = [], 0, 0
    for byte in data:
        value |= (byte & 0x7F) << shift
        shift += 7
        if byte < 0x80:
            numbers.append(value)
            value = shift = 0
    intervals: list[int] = []
    expected = add = 0
    for count, first_zigzag, add_zigzag in zip(numbers[::3], numbers[1::3], numbers[2::3], strict=True):
        first = expected + (first_zigzag >> 1 ^ -(first_zigzag & 1))
        add += add_zigzag >> 1 ^ -(add_zigzag & 1)
        intervals += [first + i * add for i in range(count)]
        expected = first + count * add
    return intervals


def exact_intervals(speed: float, base: float, acceleration: float, ticks_hz: int = TICKS_HZ) -> list[mpmath.mpf]:
    """Return those of constant acceleration: the time from one step to the next [ticks]."""
    steps = int((speed**2 - base**2) / (2 * acceleration))
    slew = round(ticks_hz / speed)

    def time(step: int) -> mpmath.mpf:
        return (mpmath.sqrt(mpmath.mpf(base) ** 2 + 2 * mpmath.mpf(acceleration) * step) - base) / acceleration

    return [max((time(i + 1) - time(i)) * ticks_hz, mpmath.mpf(slew)) for i in range(steps)]


def fineness_of(made: list[int], exact: list[mpmath.mpf]) -> int:
    """Return the finest promise that all intervals keep."""
    assert len(made) == len(exact)
    # A millionth more for the float of an AVR, whose mantissa has 24 bits.
    kept = [
        fine
        for fine in FINENESS
        if all(abs(m - e) <= e / fine + 1.5 + e * 1e-6 for m, e in zip(made, exact, strict=True))
    ]
    return max(kept, default=0)


def made_ramp(maker: Host, *wish: float, room: int, ticks_hz: int = TICKS_HZ) -> tuple[int, list[int], list[int]]:
    """Return slew interval and both lists [ticks]."""
    data = bytes.fromhex(maker.ask(*wish, ticks_hz, room))
    kind, length, flags, up_segments, down_segments, slew, up_bytes = HEADER.unpack_from(data)
    lists = data[HEADER.size :]
    assert (kind, length) == (0, len(data) - 3)
    assert len(data) <= room
    assert up_segments + down_segments <= 250
    up, down = intervals_in(lists[:up_bytes]), intervals_in(lists[up_bytes:])
    assert flags == (0 if down else 1)
    return slew, up, down or up


@pytest.mark.parametrize(
    ("wish", "fineness"),
    [
        ((1000, 0, 2000, 2000), 512),
        ((1000, 0, 2000, 4000), 512),
        ((1500, 0, 10_000, 10_000), 512),
        ((400, 50, 2000, 800), 512),
        ((2500, 0, 500, 500), 256),
        ((20_000, 100, 20_000, 50_000), 128),
        ((0.5, 0, 0.1, 0.1), 512),
        ((100, 0, 1e6, 1e6), 512),
    ],
)
def test_a_ramp_is_that_of_constant_acceleration(maker: Host, wish: tuple[float, ...], fineness: int) -> None:
    """As fine as 1000 bytes and 250 segments allow."""
    speed, base, acceleration, deceleration = wish
    slew, up, down = made_ramp(maker, *wish, room=1000)
    assert slew == round(TICKS_HZ / speed)
    assert fineness_of(up, exact_intervals(speed, base, acceleration)) >= fineness
    assert fineness_of(down, exact_intervals(speed, base, deceleration)) >= fineness
    assert min([slew, *up, *down]) == slew


@pytest.mark.parametrize("wish", [(100_000, 0, 200_000, 400_000), (25_000, 500, 1e6, 1e6), (50_000, 0, 10_000, 10_000)])
def test_a_ramp_for_the_fast_clock(maker: Host, wish: tuple[float, ...]) -> None:
    speed, base, acceleration, deceleration = wish
    slew, up, down = made_ramp(maker, *wish, room=1000, ticks_hz=FAST_TICKS_HZ)
    assert slew == round(FAST_TICKS_HZ / speed)
    assert fineness_of(up, exact_intervals(speed, base, acceleration, FAST_TICKS_HZ)) >= 64
    assert fineness_of(down, exact_intervals(speed, base, deceleration, FAST_TICKS_HZ)) >= 64
    assert min([slew, *up, *down]) == slew


def test_with_less_room_it_is_coarser_and_at_last_there_is_none(maker: Host) -> None:
    exact = exact_intervals(1500, 0, 10_000)
    found = {}
    for room in (120, 100, 80, 70, 60, 55, 50, 45, 40):
        answer = maker.ask(1500, 0, 10_000, 10_000, TICKS_HZ, room)
        if answer != "-":
            found[room] = fineness_of(made_ramp(maker, 1500, 0, 10_000, 10_000, room=room)[1], exact)
    assert found[120] == 512
    assert sorted(found.values(), reverse=True) == list(found.values())
    assert min(found.values()) in {64, 128}
    assert maker.ask(1500, 0, 10_000, 10_000, TICKS_HZ, 20) == "-"


def test_a_ramp_of_too_many_steps_has_no_room(maker: Host) -> None:
    assert maker.ask(2500, 0, 0.2, 0.2, TICKS_HZ, 1000) == "-"
