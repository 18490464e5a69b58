"""ramp_image.c: what it unpacks, and what it refuses."""

import json
import struct
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware.host import Host
from firmware.protocol import Ramp, Segment, leb128, pack_list, zigzag
from firmware.strategies import LONGEST, SHORTEST, ramps

REFERENCE = json.loads((Path(__file__).parent.parent / "reference" / "protocol_frames.json").read_text())
HEADER_IS_BAD = 0xFFFF


def shown(ramp: Ramp) -> str:
    """Return a ramp as the driver prints it."""
    up, down = (
        "".join(f" {interval}:{count}:{add}" for interval, count, add in segments) for segments in (ramp.up, ramp.down)
    )
    return f"{ramp.slew}{up} /{down}"


def image(up: list[Segment], *, version: int = 1, flags: int = 0, slew: int = 100, down: int = 0) -> bytes:
    return struct.pack("<BBBBI", version, flags, len(up), down, slew) + pack_list(up)


@pytest.mark.parametrize("case", REFERENCE["ramp_images"])
def test_reference_images(host: Host, case: dict[str, object]) -> None:
    ramp = Ramp(
        [tuple(segment) for segment in case["up"]], case["slew_interval_ticks"], [tuple(s) for s in case["down"]]
    )
    assert ramp.image().hex() == case["image"]
    assert host.ask("image", case["image"]) == shown(ramp)


@given(ramp=ramps())
def test_any_ramp_is_unpacked_as_it_was_packed(host: Host, ramp: Ramp) -> None:
    assert host.ask("image", ramp.image().hex()) == shown(ramp)


def test_the_most_segments(host: Host) -> None:
    up = [(1000 - i, 1, 0) for i in range(120)]
    assert host.ask("image", image(up).hex()) == shown(Ramp(up, 100, []))
    assert host.ask("image", image([*up, (800, 1, 0)]).hex()) == f"bad {HEADER_IS_BAD}"


@given(ramp=ramps(), data=st.data())
def test_a_mutated_image_is_refused_or_means_what_it_says(host: Host, ramp: Ramp, data: st.DataObject) -> None:
    mutated = bytearray(ramp.image())
    for _ in range(data.draw(st.integers(1, 3))):
        mutated[data.draw(st.integers(0, len(mutated) - 1))] = data.draw(st.integers(0, 255))
    cut = data.draw(st.integers(0, len(mutated)))
    mutated = mutated[: data.draw(st.sampled_from([cut, len(mutated)]))]
    answer = host.ask("image", mutated.hex() or "-")
    understood = read_image(bytes(mutated))
    assert answer == (shown(understood) if isinstance(understood, Ramp) else f"bad {understood}")


def read_image(data: bytes) -> Ramp | int:
    """Return the ramp, or the index of the first bad segment, as the document has it; numbers without a limit."""
    if len(data) < 8:
        return HEADER_IS_BAD
    version, flags, n_up, n_down, slew = struct.unpack_from("<BBBBI", data)
    if version != 1 or flags > 1 or n_up + n_down > 120 or (flags and n_down) or not SHORTEST <= slew <= LONGEST:
        return HEADER_IS_BAD
    rest, found = data[8:], []
    for index in range(n_up + n_down):
        before = found[-1] if index not in (0, n_up) else (0, 0, 0)
        segment, rest = read_segment(rest, before)
        if segment is None:
            return index
        found.append(segment)
    return Ramp(found[:n_up], slew, found[:n_up] if flags else found[n_up:]) if not rest else n_up + n_down


def read_segment(data: bytes, before: Segment) -> tuple[Segment | None, bytes]:
    """Return a segment, None if it is bad, and the bytes after it."""
    numbers = []
    for _ in range(3):
        length = next((i for i, byte in enumerate(data, 1) if byte < 128), 0)
        number = sum((byte & 127) << 7 * i for i, byte in enumerate(data[:length]))
        if not 1 <= length <= 5 or number >= 2**32:
            return None, data
        numbers.append(number)
        data = data[length:]
    changes = [number // 2 if number % 2 == 0 else -(number + 1) // 2 for number in numbers]
    interval, count, add = before[0] + before[1] * before[2] + changes[1], numbers[0], before[2] + changes[2]
    last = interval + (count - 1) * add
    good = 1 <= count <= 65535 and -32768 <= add <= 32767
    good = good and SHORTEST <= interval <= LONGEST and SHORTEST <= last <= LONGEST
    return ((interval, count, add) if good else None), data


@pytest.mark.parametrize(
    ("bad", "segment"),
    [
        (b"", HEADER_IS_BAD),
        (image([])[:7], HEADER_IS_BAD),
        (image([], version=2), HEADER_IS_BAD),
        (image([], flags=2), HEADER_IS_BAD),
        (image([], flags=1, down=1), HEADER_IS_BAD),
        (image([], slew=39), HEADER_IS_BAD),
        (image([], slew=2**24), HEADER_IS_BAD),
        (image([(39, 1, 0)]), 0),
        (image([(2**24, 1, 0)]), 0),
        (image([(50, 1, 0), (50, 12, -1)]), 1),
        (image([(50, 1, 0), (50, 0, 0)]), 1),
        (image([(50, 65536, 0)]), 0),
        (image([(50, 1, 32768)]), 0),
        (image([(50, 1, -32769)]), 0),
        (image([(50, 65535, 32767)]), 0),
        (image([(2**24 - 1, 65535, -32768)]), 0),
        (image([(50, 1, 0)]) + b"\0", 1),
        (image([(50, 1, 0)])[:-1], 0),
        (image([(50, 1, 0)], down=1), 1),
        (image([])[:2] + b"\1" + image([])[3:] + leb128(1) + leb128(zigzag(50)) + b"\x80\x80\x80\x80\x10", 0),
        (image([])[:2] + b"\1" + image([])[3:] + leb128(1) + leb128(zigzag(50)) + b"\x80" * 9 + b"\0", 0),
    ],
)
def test_images_that_are_refused(host: Host, bad: bytes, segment: int) -> None:
    assert read_image(bad) == segment
    assert host.ask("image", bad.hex() or "-") == f"bad {segment}"


def test_the_limits_themselves_are_allowed(host: Host) -> None:
    ramp = Ramp([(LONGEST, 512, -32768), (SHORTEST, 513, 32767)], SHORTEST, [(LONGEST, 65535, 0), (SHORTEST, 65535, 0)])
    assert host.ask("image", ramp.image().hex()) == shown(ramp)
