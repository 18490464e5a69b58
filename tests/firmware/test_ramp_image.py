"""The check of ramp images, and what is played of good ones, against a reading of the format of its own."""

import struct
from collections.abc import Iterator

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from firmware.host import Host, missing_compiler
from firmware.motion import Machine, StoredRamp, build, image_of, leb128, packed
from tools import require

SHORTEST = {False: 14, True: 106}
LONGEST = 2**28 - 1


@pytest.fixture(scope="module")
def host(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Host]:
    require(*missing_compiler())
    with Host(build(tmp_path_factory.mktemp("image"))) as running:
        yield running


def check(host: Host, image: bytes) -> str:
    return host.ask("check", image.hex() or "-")


class Bad(Exception):
    """An image is bad at a ramp, and there at a segment; 255 stands for a header."""


class Reader:
    def __init__(self, data: bytes) -> None:
        self.data = data

    def number(self) -> int | None:
        for length in range(1, min(5, len(self.data)) + 1):
            if self.data[length - 1] < 0x80:
                value = sum((byte & 0x7F) << 7 * place for place, byte in enumerate(self.data[:length]))
                self.data = self.data[length:]
                return value if value < 2**32 else None
        return None


def unzigzag(value: int) -> int:
    return value // 2 if value % 2 == 0 else -(value + 1) // 2


def check_list(data: bytes, segments: int, first_index: int, ramp: int, shortest: int) -> None:
    reader, expected, add = Reader(data), 0, 0
    for index in range(segments):
        count, change, add_change = reader.number(), reader.number(), reader.number()
        if count is None or change is None or add_change is None or not 1 <= count < 2**16:
            raise Bad(ramp, first_index + index)
        add += unzigzag(add_change)
        first = expected + unzigzag(change)
        last = first + (count - 1) * add
        if not -(2**15) <= add < 2**15 or not shortest <= first <= LONGEST or not shortest <= last <= LONGEST:
            raise Bad(ramp, first_index + index)
        expected = last + add
    if reader.data:
        raise Bad(ramp, first_index + segments)


def check_segments(body: bytes, ramp: int, shortest: int) -> None:
    if len(body) < 9:
        raise Bad(ramp, 255)
    flags, up, down, slew, up_bytes = struct.unpack_from("<BBBIH", body)
    wrong = flags > 1 or up + down > 250 or (flags and down) or not shortest <= slew <= LONGEST
    if wrong or up_bytes > len(body) - 9:
        raise Bad(ramp, 255)
    check_list(body[9 : 9 + up_bytes], up, 0, ramp, shortest)
    check_list(body[9 + up_bytes :], down, up, ramp, shortest)


def expected_of(image: bytes) -> str:
    """Return what the check must say of an image without formulas."""
    try:
        if len(image) < 4 or image[0] != 2 or image[1] > 1 or not 1 <= image[2] <= 4 or not 1 <= image[3] <= image[2]:
            raise Bad(255, 255)
        axes, ramps = image[2], image[3]
        if len(image) < 4 + axes or set(image[4 : 4 + axes]) != set(range(ramps)):
            raise Bad(255, 255)
        rest = image[4 + axes :]
        for ramp in range(ramps):
            if len(rest) < 3 or int.from_bytes(rest[1:3], "little") > len(rest) - 3 or rest[0] != 0:
                raise Bad(ramp, 255)
            length = int.from_bytes(rest[1:3], "little")
            check_segments(rest[3 : 3 + length], ramp, SHORTEST[bool(image[1])])
            rest = rest[3 + length :]
        if rest:
            raise Bad(255, 255)
    except Bad as bad:
        ramp, segment = bad.args
        return f"bad {ramp << 8 | segment}"
    return f"good {image[2]} {image[3]}"


intervals = st.lists(st.integers(1, 3000), max_size=6).map(tuple)
ramps = st.builds(StoredRamp, intervals, st.integers(1, 3000), intervals)
images = st.builds(
    lambda some, fast: image_of(*some, fast=fast), st.lists(ramps, min_size=1, max_size=4), st.booleans()
)


@given(image=images)
@example(image=image_of(StoredRamp((LONGEST,), LONGEST, ())))
@example(image=image_of(StoredRamp((LONGEST + 1,), LONGEST, ())))
def test_images(host: Host, image: bytes) -> None:
    assert check(host, image) == expected_of(image)


@given(image=images, data=st.data())
def test_damaged_images(host: Host, image: bytes, data: st.DataObject) -> None:
    """A byte changed, taken out or put in: nothing is read past the end, and nothing accepted that is not an image."""
    at = data.draw(st.integers(0, len(image) - 1))
    with_byte = bytes([data.draw(st.integers(0, 255))])
    damaged = data.draw(
        st.sampled_from(
            [image[:at] + with_byte + image[at + 1 :], image[:at], image[:at] + image[at + 1 :], image + with_byte]
        )
    )
    answer = check(host, damaged)
    if expected_of(damaged).startswith("good") or 1 not in damaged[4:]:
        assert answer == expected_of(damaged)


@given(image=st.binary(max_size=60))
def test_noise_is_no_image(host: Host, image: bytes) -> None:
    assert check(host, image).startswith("bad")


@pytest.mark.parametrize(
    ("segments", "bad"),
    [
        ([(2000, 1, 0), (13, 1, 0)], 1),
        ([(2000, 3, -1000)], 0),
        ([(2000, 65_535, 32_767)], 0),
        ([(70_000, 65_535, -32_768)], 0),
        ([(2000, 65_535, -1)], 0),
    ],
)
def test_an_interval_out_of_range(host: Host, segments: list[tuple[int, int, int]], bad: int) -> None:
    data = packed(segments)
    body = struct.pack("<BBBIH", 1, len(segments), 0, 2000, len(data)) + data
    image = bytes([2, 0, 1, 1, 0, 0]) + struct.pack("<H", len(body)) + body
    assert check(host, image) == f"bad {bad}"


def test_numbers_may_be_longer_than_they_must(host: Host) -> None:
    """80 00 is 0 as well, read from either end."""
    data = leb128(3)[:-1] + b"\x83\x80\x00" + b"\xa0\x9f\x00" + b"\x80\x80\x80\x80\x00"
    body = struct.pack("<BBBIH", 1, 1, 0, 2000, len(data)) + data
    image = bytes([2, 0, 1, 1, 0, 0]) + struct.pack("<H", len(body)) + body
    assert check(host, image) == expected_of(image) == "good 1 1"


def test_down_may_be_the_same_list_as_up(host: Host) -> None:
    data = packed([(4000, 1, 0), (3000, 1, 0)])
    body = struct.pack("<BBBIH", 1, 2, 0, 2000, len(data)) + data
    image = bytes([2, 0, 1, 1, 0, 0]) + struct.pack("<H", len(body)) + body
    machine = Machine(host, image)
    machine.move(6)
    machine.rest()
    assert machine.steps().intervals == [4000, 3000, 2000, 2000, 3000]
