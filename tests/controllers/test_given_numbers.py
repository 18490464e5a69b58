"""What controllers are given in mm: never less than the least that they keep, and never more than was asked for."""

from __future__ import annotations

from contextlib import suppress
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from designs import design
from stepramp.controllers.fluidnc.ramp import FLUIDNC
from stepramp.controllers.given_numbers import typed
from stepramp.controllers.grbl.ramp import LEAST, LEAST_RATE, GrblRamp
from stepramp.controllers.klipper.ramp import KLIPPER
from stepramp.controllers.marlin.ramp import MARLIN
from stepramp.controllers.per_mm import PerMm, Terms
from stepramp.errors import Rejected

SCALES = st.sampled_from([0.5, 8.889, 80.0, 250.0, 1000.0, 3200.0])
NEAR_THE_LEAST = st.floats(0.9, 3.0) | st.sampled_from([1.0, 1.5, 2.0]) | st.floats(1.0, 1e6)


@pytest.mark.parametrize("terms", [FLUIDNC, MARLIN, KLIPPER], ids=lambda terms: terms.name)
@given(SCALES, NEAR_THE_LEAST, NEAR_THE_LEAST)
@example(1000.0, 6000.0, 1.0)
@example(1000.0, 1.0, 1000.0)
def test_least_sent_and_asked(terms: Terms, scale: float, speeds: float, gains: float) -> None:
    own = typed(scale)
    speed = float(f"{float(terms.speed.least * own / terms.seconds) * speeds:.9g}")
    gain = float(f"{float(terms.acceleration.least * own) * gains:.9g}")
    with suppress(Rejected):
        asked = design(ramp__slew_speed_steps_per_s=speed, ramp__acceleration_steps_per_s2=gain)
        given = PerMm.of(asked, terms, own=own)
        assert terms.speed.least <= Fraction(given.speed)
        assert terms.acceleration.least <= Fraction(given.acceleration)
        assert 0 < given.speed_steps_per_s <= typed(speed)
        assert 0 < given.acceleration_steps_per_s2 <= typed(gain)


@given(SCALES, NEAR_THE_LEAST, NEAR_THE_LEAST)
def test_least_sent_and_asked_of_grbl(scale: float, speeds: float, gains: float) -> None:
    speed = float(f"{LEAST_RATE * scale / 60 * speeds:.9g}")
    gain = float(f"{float(LEAST) * scale * gains:.9g}")
    with suppress(Rejected):
        asked = design(ramp__slew_speed_steps_per_s=speed, ramp__acceleration_steps_per_s2=gain)
        ramp = GrblRamp.of(asked, np.float32(scale))
        assert LEAST_RATE <= Fraction(ramp.rate_text) <= typed(speed) * 60 / typed(scale) * (1 + Fraction(1, 10**6))
        # With 0.001 it doesn't hang yet.
        assert Fraction(1, 1000) <= Fraction(ramp.acceleration_text)
        assert ramp.speed_steps_per_s <= speed
        assert ramp.acceleration_steps_per_s2 <= gain


def test_what_would_be_sent_as_0_is_rejected_by_a_limit_that_does() -> None:
    """As float32, 0.001 mm/s² is a little more."""
    with pytest.raises(Rejected) as caught:
        PerMm.of(design(ramp__acceleration_steps_per_s2=1), FLUIDNC, own=Fraction(1000))
    [rejection] = caught.value.rejections
    assert rejection.limits is not None
    least = rejection.limits.lowest
    assert least is not None
    assert 1 < least < 1.0001
    assert PerMm.of(design(ramp__acceleration_steps_per_s2=least), FLUIDNC, own=Fraction(1000)).acceleration == "0.001"
