import json
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from stepramp.controllers.frames import crc16
from stepramp.controllers.ramp_image import HEADER, MOST_SEGMENTS, BadRampImage, RampImage
from stepramp.ramp.segments import Segment

REFERENCE = json.loads((Path(__file__).parent.parent / "reference" / "protocol_frames.json").read_text())
LIMITS = range(40, 2**24)


@st.composite
def segments(draw: st.DrawFn) -> Segment:
    interval = draw(st.sampled_from(LIMITS))
    count = draw(st.integers(1, 65535))
    steps = max(count - 1, 1)
    add = draw(st.integers(-((interval - 40) // steps), (2**24 - 1 - interval) // steps))
    return Segment(interval, count, max(-(2**15), min(add, 2**15 - 1)))


LISTS = st.lists(segments(), max_size=60).map(tuple)
IMAGES = st.builds(RampImage, LISTS, st.sampled_from(LIMITS), LISTS)


def image_of(*up: tuple[int, int, int], slew: int = 2000, down: tuple = ()) -> RampImage:
    return RampImage(tuple(Segment(*each) for each in up), slew, down)


@pytest.mark.parametrize("reference", REFERENCE["ramp_images"], ids=["two lists", "one list"])
def test_reference_images(reference: dict) -> None:
    up, down = (tuple(Segment(*each) for each in reference[name]) for name in ("up", "down"))
    image = RampImage(up, reference["slew_interval_ticks"], down)
    assert image.encode().hex() == reference["image"]
    assert crc16(image.encode()) == reference["crc"]
    assert RampImage.decode(bytes.fromhex(reference["image"]), LIMITS) == image


@given(IMAGES)
def test_images_come_back(image: RampImage) -> None:
    assert RampImage.decode(image.encode(), LIMITS) == image
    assert image.keeps(LIMITS)


@given(LISTS, st.sampled_from(LIMITS))
def test_a_list_that_serves_both_ways_is_sent_once(side: tuple[Segment, ...], slew: int) -> None:
    image = RampImage(side, slew, side)
    assert image.sent_segments == len(side)
    assert RampImage.decode(image.encode(), LIMITS) == image


@given(IMAGES, st.data())
def test_a_damaged_image_is_a_sound_one_or_none(image: RampImage, data: st.DataObject) -> None:
    damaged = bytearray(image.encode())
    damaged[data.draw(st.integers(0, len(damaged) - 1))] ^= data.draw(st.integers(1, 255))
    try:
        decoded = RampImage.decode(bytes(damaged), LIMITS)
    except BadRampImage:
        return
    assert decoded.keeps(LIMITS)


@given(st.binary(max_size=100))
def test_noise_is_an_image_or_none(noise: bytes) -> None:
    try:
        image = RampImage.decode(noise, LIMITS)
    except BadRampImage:
        return
    assert image.keeps(LIMITS)


@given(IMAGES, st.data())
def test_a_part_of_an_image_is_none(image: RampImage, data: st.DataObject) -> None:
    encoded = image.encode()
    with pytest.raises(BadRampImage):
        RampImage.decode(encoded[: data.draw(st.integers(0, len(encoded) - 1))])


@pytest.mark.parametrize(
    ("image", "segment"),
    [
        (b"", HEADER),
        (b"\x02\x00\x00\x00\xd0\x07\x00\x00", HEADER),
        (b"\x01\x02\x00\x00\xd0\x07\x00\x00", HEADER),
        (b"\x01\x01\x00\x01\xd0\x07\x00\x00", HEADER),
        (bytes([1, 0, 61, 60, 0xD0, 7, 0, 0]), HEADER),
        (b"\x01\x01\x00\x00\x27\x00\x00\x00", HEADER),
        (b"\x01\x01\x00\x00\xd0\x07\x00\x00\x00", 0),
        (image_of((5000, 10, 0), slew=2000).encode() + b"\x01", 1),
        (image_of((5000, 10, 0), (2**24, 1, 0)).encode(), 1),
        (image_of((5000, 10, 0), (100, 10, -10)).encode(), 1),
        (image_of((5000, 0, 0)).encode(), 0),
        (image_of((5000, 65536, 0)).encode(), 0),
        (image_of((5000, 2, 0), (5000, 1, 32768)).encode(), 1),
        (image_of((5000, 1, 0)).encode()[:-1] + b"\x80\x80\x80\x80\x80\x00", 0),
    ],
)
def test_the_first_bad_segment_is_named(image: bytes, segment: int) -> None:
    with pytest.raises(BadRampImage) as caught:
        RampImage.decode(image, LIMITS)
    assert caught.value.segment == segment


def test_the_most_segments_that_fit_a_byte() -> None:
    side = tuple(Segment(5000 + index, 1, 0) for index in range(MOST_SEGMENTS))
    assert RampImage.decode(RampImage(side, 2000, side).encode()).down == side
