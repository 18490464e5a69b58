"""What a module is sent of a design, and what its chip makes of that."""

from __future__ import annotations

import math
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from designs import design
from stepramp.controllers.tmcl.ramp import TmclRamp, is_kept, tmcl_losses
from stepramp.controllers.tmcl.units import UnitMode, Units
from stepramp.errors import Rejected

PPS = Units(UnitMode.STEPS, 16_000_000)
CHIP = Units(UnitMode.CHIP, 16_000_000)
F = 16_000_000


def ramp_of(units: Units, **changes: object) -> TmclRamp:
    return TmclRamp.of(design(**{f"ramp__{name}": value for name, value in changes.items()}), units)


def test_a_design_in_microsteps() -> None:
    changes = {"base_speed_steps_per_s": 12.9, "slew_speed_steps_per_s": 1000.7, "deceleration_steps_per_s2": 2500.9}
    sent = ramp_of(PPS, **changes)
    assert sent == TmclRamp(vmax=1000, amax=5000, dmax=2500, vstart=12, vstop=12, a1=5000, v1=0, d1=2500)


def test_a_design_in_the_chip_s_units() -> None:
    """v · 2²⁴ / f and a · 2⁴¹ / f²: 1048.576 and 42.95; 12 steps/s are 12.58."""
    sent = ramp_of(CHIP, base_speed_steps_per_s=12)
    assert sent == TmclRamp(vmax=1048, amax=42, dmax=42, vstart=12, vstop=12, a1=42, v1=0, d1=42)
    assert ramp_of(PPS, base_speed_steps_per_s=12).of_the_chip(PPS) == sent


def test_without_a_base_speed_there_is_still_a_stopping_speed() -> None:
    for units in (PPS, CHIP):
        sent = ramp_of(units)
        assert (sent.vstart, sent.vstop) == (0, 10)
        assert any("VSTOP is 9.536743164 steps/s" in loss for loss in tmcl_losses(design(), units))
        assert not any("VSTOP" in loss for loss in tmcl_losses(design(ramp__base_speed_steps_per_s=10), units))


@given(st.decimals("2", "7999500", places=3), st.decimals("117", "7629000", places=3))
def test_figures_are_rounded_down_and_never_further_than_one_unit(speed: object, rate: object) -> None:
    typed = {"slew_speed_steps_per_s": float(str(speed)), "acceleration_steps_per_s2": float(str(rate))}
    v, a = Fraction(str(speed)), Fraction(str(rate))
    if v > 1_000_000:
        typed["slew_speed_steps_per_s"], v = 1_000_000.0, Fraction(1_000_000)
    for units in (PPS, CHIP):
        sent = ramp_of(units, **typed)
        quantum_v, quantum_a = (1, 1) if units is PPS else (Fraction(F, 2**24), Fraction(F**2, 2**41))
        assert 0 <= v / quantum_v - sent.vmax < 1
        assert 0 <= a / quantum_a - sent.amax < 1
        assert sent.amax == sent.a1 == sent.dmax == sent.d1


@pytest.mark.parametrize(
    ("changes", "field", "allowed"),
    [
        ({"slew_speed_steps_per_s": 0.5}, "slew_speed_steps_per_s", "a number from 2 to "),
        ({"slew_speed_steps_per_s": 1.9073}, "slew_speed_steps_per_s", "a number from 2 to "),
        ({"acceleration_steps_per_s2": 100}, "acceleration_steps_per_s2", "a number from 117 to 7,62"),
        ({"acceleration_steps_per_s2": 7_629_300}, "acceleration_steps_per_s2", "a number from 117 to 7,62"),
        ({"deceleration_steps_per_s2": 116}, "deceleration_steps_per_s2", "a number from 117 to 7,62"),
        (
            {"base_speed_steps_per_s": 250_000, "slew_speed_steps_per_s": 300_000},
            "base_speed_steps_per_s",
            "a number from 0 to 249,999 steps/s",
        ),
    ],
)
def test_what_is_beyond_a_module_or_would_hang_it_is_rejected(
    changes: dict[str, float], field: str, allowed: str
) -> None:
    """The chip's least acceleration is 116.4 steps/s²; what becomes 0 never ends a move."""
    with pytest.raises(Rejected) as caught:
        ramp_of(PPS, **changes)
    [rejection] = caught.value.rejections
    assert (rejection.field, rejection.value) == (f"ramp.{field}", changes[field])
    assert rejection.allowed.startswith(allowed)
    assert rejection.allowed.endswith("with a TMCL module")


@pytest.mark.parametrize("edge", ["lowest", "highest"])
@pytest.mark.parametrize("field", ["slew_speed_steps_per_s", "acceleration_steps_per_s2", "base_speed_steps_per_s"])
@pytest.mark.parametrize("units", [PPS, CHIP])
def test_what_is_told_as_allowed_is_allowed(units: Units, field: str, edge: str) -> None:
    beyond = {"slew_speed_steps_per_s": 0.5, "acceleration_steps_per_s2": 1.0}
    changes = {field: beyond.get(field, 260_000.0), "slew_speed_steps_per_s": 300_000.0} | (
        {field: beyond[field]} if field in beyond else {}
    )
    with pytest.raises(Rejected) as caught:
        ramp_of(units, **changes)
    limits = caught.value.rejections[0].limits
    assert limits is not None
    allowed = min(getattr(limits, edge), 1_000_000)
    assert ramp_of(units, **(changes | {field: allowed})).lacks() is None


def test_each_field_that_is_beyond_a_module_is_named() -> None:
    both = {"ramp__acceleration_steps_per_s2": 5, "ramp__deceleration_steps_per_s2": 6}
    with pytest.raises(Rejected) as caught:
        TmclRamp.of(design(**both), PPS, "axes.1.")
    assert [each.field for each in caught.value.rejections] == [
        "axes.1.ramp.acceleration_steps_per_s2",
        "axes.1.ramp.deceleration_steps_per_s2",
    ]


def test_every_loss_is_named() -> None:
    lost = design(
        schema="stepramp/2",
        ramp__deceleration_steps_per_s2=2500,
        ramp__shape={"name": "cosine"},
        method={"name": "ideal"},
    )
    told = " ".join(tmcl_losses(lost, PPS))
    for words in (
        "VSTOP is 9.536743164 steps/s",
        "Deceleration 2,500",
        "with the acceleration, 5,000",
        "Slew speed 1,000 steps/s is rounded down to 999.45",
        "The shape ",
        "The method",
    ):
        assert words in told
    assert "The lookup table is not kept" in " ".join(tmcl_losses(design(method__name="table"), PPS))


@given(st.integers(0, 65535), st.booleans())
def test_an_acceleration_that_is_read_is_sent_so_that_the_chip_has_it_again(register: int, reads_up: bool) -> None:
    exact = register * Fraction(F**2, 2**41)
    read = int(exact) + (reads_up and exact.denominator > 1)
    assert PPS.chip_acceleration_units(PPS.acceleration_again(read)) == register
    assert CHIP.acceleration_again(register) == register


@given(st.floats(0, 2000), st.integers(117, 7_000_000))
def test_a_stop_takes_as_many_steps_as_its_energy(speed: float, rate: int) -> None:
    """v² / (2 a), and at most one more, so that a step isn't cut."""
    ramp = TmclRamp(vmax=5000, amax=rate, dmax=200, vstart=0, vstop=10, a1=rate, v1=0, d1=200)
    exact = Fraction(speed) ** 2 / (2 * rate)
    assert exact - Fraction(1, 10**6) <= ramp.steps_to_rest(speed, PPS) < exact + 1 + Fraction(1, 10**6)
    assert ramp.steps_to_rest(-speed, PPS) == ramp.steps_to_rest(speed, PPS)


@pytest.mark.parametrize("clock_hz", [8_000_000, 12_000_000, 16_000_000, 16_777_216, 20_000_000])
@given(data=st.data())
def test_what_is_accepted_is_told_again_as_more_than_nothing(clock_hz: int, data: st.DataObject) -> None:
    """Worked out here as the chip's data sheet has it: v · 2²⁴ / f, rounded down, and back the same way."""
    units, unit = Units(UnitMode.STEPS, clock_hz), Fraction(clock_hz, 2**24)

    def told(pps: int) -> int:
        return math.floor(math.floor(pps / unit) * unit)

    speed = data.draw(st.decimals("0.5", "9", places=3))
    least = next(pps for pps in range(1, 9) if told(pps))
    if speed < least:
        with pytest.raises(Rejected, match=f"allowed: a number from {least} to"):
            ramp_of(units, slew_speed_steps_per_s=float(speed))
    else:
        sent = ramp_of(units, slew_speed_steps_per_s=float(speed)).vmax
        assert sent == math.floor(speed)
        assert is_kept("vmax", sent, told(sent), units)


def test_a_starting_speed_may_be_told_as_nothing() -> None:
    """1 step/s is one of the chip's units, 0.954 steps/s."""
    sent = ramp_of(PPS, base_speed_steps_per_s=1).vstart
    assert (sent, is_kept("vstart", sent, 0, PPS), is_kept("vstart", 2, 0, PPS)) == (1, True, False)


def test_what_is_told_as_nothing_is_never_taken_for_what_was_sent() -> None:
    # The chip's least acceleration is 116.4 steps/s²: 117 becomes 1 of them, which is told as 116.
    assert is_kept("amax", 117, 116, PPS)
    assert not is_kept("amax", 117, 0, PPS)
    assert is_kept("v1", 0, 0, PPS)
