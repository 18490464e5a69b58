import json
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from controllers.ramps import IMAGE, SIDE, four_axes, image_of
from designs import design
from stepramp.controllers.stepramp.formula_image import FORMULA_BYTES
from stepramp.controllers.stepramp.frames import crc16
from stepramp.controllers.stepramp.playback import formula_ramp, unpacked
from stepramp.controllers.stepramp.ramp_image import (
    HEADER,
    MOST_SEGMENTS,
    BadRampImage,
    FormulaRamp,
    IntervalLimits,
    RampImage,
    SegmentRamp,
)
from stepramp.controllers.virtual.controller import HELLO
from stepramp.ramp.plan import ramp_of
from stepramp.ramp.segments import Segment

REFERENCE = json.loads((Path(__file__).parent.parent / "reference" / "protocol_frames.json").read_text())
LIMITS = IntervalLimits(40, 480, 2**24 - 1, 8)
SLOW = range(5, 2**24)


@st.composite
def segments(draw: st.DrawFn) -> Segment:
    interval = draw(st.integers(40, 2**24 - 1))
    count = draw(st.integers(1, 65535))
    steps = max(count - 1, 1)
    add = draw(st.integers(-((interval - 40) // steps), (2**24 - 1 - interval) // steps))
    return Segment(interval, count, max(-(2**15), min(add, 2**15 - 1)))


LISTS = st.lists(segments(), max_size=60).map(tuple)
RAMPS = st.builds(SegmentRamp, LISTS, st.integers(40, 2**24 - 1), LISTS)
IMAGES = st.builds(RampImage, st.booleans(), st.lists(RAMPS, min_size=1, max_size=4).map(tuple))


@pytest.mark.parametrize("reference", REFERENCE["ramp_images"], ids=lambda each: each.get("name", "image"))
def test_reference_images(reference: dict) -> None:
    image = RampImage.decode(bytes.fromhex(reference["image"]))
    assert image.encode().hex() == reference["image"]
    assert crc16(image.encode()) == reference["crc"]


def test_an_image_byte_by_byte() -> None:
    # Format, flags, axes, ramps, number of each axis' ramp; kind and length of the ramp; flags, segments up and down,
    # slew interval, bytes of the up list; count, zigzag interval, zigzag add of each segment.
    image = RampImage(True, (SegmentRamp((Segment(300, 2, -3),), 290, (Segment(290, 1, 0),)),))
    assert image.encode().hex() == "02010101 00 001100 000101 22010000 0400 02d80405 01c40400".replace(" ", "")


@given(IMAGES)
def test_images_come_back(image: RampImage) -> None:
    assert RampImage.decode(image.encode(), LIMITS) == image


def test_axes_share_ramps() -> None:
    image = four_axes()
    assert image.encode()[:8] == bytes([2, 0, 4, 2, 0, 1, 0, 1])
    assert len(image.ramps) == 2
    assert image.sent_segments == 5 + 1
    assert RampImage.decode(image.encode()) == image


@given(LISTS, st.integers(40, 2**24 - 1))
def test_a_list_that_serves_both_ways_is_sent_once(side: tuple[Segment, ...], slew: int) -> None:
    image = image_of(SegmentRamp(side, slew, side))
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
    assert all(ramp.keeps(SLOW) for ramp in decoded.ramps if isinstance(ramp, SegmentRamp))


@given(st.binary(max_size=100))
def test_noise_is_an_image_or_none(noise: bytes) -> None:
    try:
        RampImage.decode(noise, LIMITS)
    except BadRampImage:
        return


@given(IMAGES, st.data())
def test_a_part_of_an_image_is_none(image: RampImage, data: st.DataObject) -> None:
    encoded = image.encode()
    with pytest.raises(BadRampImage):
        RampImage.decode(encoded[: data.draw(st.integers(0, len(encoded) - 1))])


def ramp(*up: tuple[int, int, int], slew: int = 2000, down: tuple = ()) -> bytes:
    return image_of(SegmentRamp(tuple(Segment(*each) for each in up), slew, down)).encode()


@pytest.mark.parametrize(
    ("image", "where"),
    [
        (b"\x02\x00\x01", (HEADER, HEADER)),
        (b"\x03" + IMAGE.encode()[1:], (HEADER, HEADER)),
        (b"\x02\x02" + IMAGE.encode()[2:], (HEADER, HEADER)),
        (b"\x02\x00\x01\x02" + IMAGE.encode()[4:], (HEADER, HEADER)),
        (b"\x02\x00\x05\x01" + IMAGE.encode()[4:], (HEADER, HEADER)),
        (IMAGE.encode() + b"\0", (HEADER, HEADER)),
        (b"\x02\x00\x01\x01\x00\x00\x09", (0, HEADER)),
        (b"\x02\x00\x01\x01\x00\x00\x09\x00", (0, HEADER)),
        (b"\x02\x00\x01\x01\x00\x02\x00\x00", (0, HEADER)),
        (b"\x02\x00\x01\x01\x00\x01\x00\x00", (0, HEADER)),
        (b"\x02\x00\x01\x01\x00\x00\x08\x00" + bytes(8), (0, HEADER)),
        (b"\x02\x00\x01\x01\x00\x00\x09\x00\x02\x00\x00\xd0\x07\x00\x00\x00\x00", (0, HEADER)),
        (b"\x02\x00\x01\x01\x00\x00\x09\x00\x01\x00\x01\xd0\x07\x00\x00\x00\x00", (0, HEADER)),
        (b"\x02\x00\x01\x01\x00\x00\x09\x00\x01\x00\x00\xd0\x07\x00\x00\x01\x00", (0, HEADER)),
        (b"\x02\x00\x01\x01\x00\x00\x09\x00\x00\x80\x7b\xd0\x07\x00\x00\x00\x00", (0, HEADER)),
        (b"\x02\x00\x01\x01\x00\x00\x0a\x00\x01\x00\x00\xd0\x07\x00\x00\x00\x00\x00", (0, 0)),
        (ramp((5000, 10, 0), slew=4), (0, HEADER)),
        (ramp((5000, 10, 0), (2**24, 1, 0)), (0, 1)),
        (ramp((5000, 10, 0), (100, 10, -11)), (0, 1)),
        (ramp((5000, 0, 0)), (0, 0)),
        (ramp((5000, 65536, 0)), (0, 0)),
        (ramp((5000, 2, 0), (5000, 1, 32768)), (0, 1)),
        (ramp((5000, 2, 0), down=(Segment(3, 1, 0),)), (0, 1)),
    ],
)
def test_where_an_image_is_bad(image: bytes, where: tuple[int, int]) -> None:
    with pytest.raises(BadRampImage) as caught:
        RampImage.decode(image, LIMITS)
    assert (caught.value.ramp, caught.value.segment) == where
    assert caught.value.detail == where[0] * 256 + where[1]


@pytest.mark.parametrize(
    ("number", "reason"),
    [
        (b"\xff\xff\xff\xff\x07", "an interval of"),
        (b"\x80\x80\x80\x80\x08", "31 bits"),
        (b"\x80\x80\x80\x80\x10", "31 bits"),
        (b"\x80\x80\x80\x80\x80\x00", "31 bits"),
    ],
)
def test_numbers_have_31_bits(number: bytes, reason: str) -> None:
    lists = b"\x01" + number + b"\x00"
    body = b"\x00\x01\x00\xd0\x07\x00\x00" + bytes([len(lists), 0]) + lists
    with pytest.raises(BadRampImage, match=reason):
        RampImage.decode(b"\x02\x00\x01\x01\x00\x00" + bytes([len(body), 0]) + body)


def test_the_most_segments() -> None:
    side = tuple(Segment(5000 + index, 1, 0) for index in range(MOST_SEGMENTS))
    assert RampImage.decode(image_of(SegmentRamp(side, 2000, side)).encode()).ramps == (SegmentRamp(side, 2000, side),)


def test_limits_of_the_two_clocks() -> None:
    limits = IntervalLimits.of(HELLO)
    assert limits.of_segments(fast_clock=True) == range(106, 2**28)
    assert limits.of_segments(fast_clock=False) == range(14, 2**28)
    assert limits.by_formula(fast_clock=False) == range(200, 2**28)


def test_the_clock_decides_what_is_too_short() -> None:
    fast, slow = (RampImage(clock, (SegmentRamp(SIDE, 39, SIDE),)).encode() for clock in (True, False))
    assert RampImage.decode(slow, LIMITS).fast_clock is False
    with pytest.raises(BadRampImage):
        RampImage.decode(fast, LIMITS)


@pytest.mark.parametrize("method", ["first_order", "compromise", "newton"])
@pytest.mark.parametrize("deceleration", [None, 2500, 9000])
def test_ramps_by_formula_come_back_and_are_those_of_the_plan(method: str, deceleration: float | None) -> None:
    wanted = design(method__name=method, method__arithmetic="fixed", ramp__deceleration_steps_per_s2=deceleration)
    made = formula_ramp(wanted, range(200, 2**28))
    assert isinstance(made, FormulaRamp)
    assert RampImage.decode(image_of(made).encode(), LIMITS) == image_of(made)
    sent, planned = unpacked(made), ramp_of(wanted)
    assert sent.up.tolist() == planned.up.tolist()
    assert sent.down.tolist() == planned.down.tolist()
    assert sent.slew == planned.slew


def test_what_is_not_computed_on_the_controller() -> None:
    assert formula_ramp(design(method__name="first_order"), range(200, 2**28)) is None
    fixed = design(method__name="newton", method__arithmetic="fixed")
    assert formula_ramp(fixed, range(60, 10_000)) is None


@given(st.integers(0, FORMULA_BYTES - 1), st.integers(1, 255))
def test_damaged_constants_are_sound_or_none(place: int, flipped: int) -> None:
    made = formula_ramp(design(method__name="newton", method__arithmetic="fixed"), range(200, 2**28))
    assert made is not None
    constants = bytearray(made.constants)
    constants[place] ^= flipped
    encoded = image_of(FormulaRamp(bytes(constants))).encode()
    try:
        assert RampImage.decode(encoded).encode() == encoded
    except BadRampImage as bad:
        assert (bad.ramp, bad.segment) == (0, HEADER)
