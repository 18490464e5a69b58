import pytest
from hypothesis import given
from hypothesis import strategies as st

from stepramp.controllers.stepramp.settings import OFFSETS, StepRampSettings
from stepramp.errors import Rejected

AXES = st.lists(st.integers(0, 3), max_size=6)
SETTINGS = st.builds(
    StepRampSettings,
    outputs=st.sampled_from(["step_and_direction", "gauges"]),
    both_edges=AXES,
    step_inverted=AXES,
    direction_inverted=AXES,
    enable_level=st.sampled_from(["low", "high"]),
    pulse_width_us=st.integers(0, 100),
    direction_setup_us=st.integers(20, 15_000),
    enable_lead_ms=st.integers(0, 1000),
    enable_hold_ms=st.none() | st.integers(0, 65_534),
)


def test_the_defaults() -> None:
    assert StepRampSettings().pack().hex() == "0000000000001e000100ffff"


@given(SETTINGS)
def test_settings_come_back(settings: StepRampSettings) -> None:
    assert StepRampSettings.unpack(settings.pack()) == settings


def test_settings_byte_by_byte() -> None:
    settings = StepRampSettings(
        outputs="gauges",
        both_edges=(0, 3),
        step_inverted=(1,),
        direction_inverted=(2, 1, 2),
        enable_level="high",
        pulse_width_us=100,
        direction_setup_us=15_000,
        enable_lead_ms=1000,
        enable_hold_ms=256,
    )
    assert settings.pack().hex() == "0109020601" + "64" + "983a" + "e803" + "0001"
    assert settings.direction_inverted == (1, 2)
    assert [OFFSETS[name] for name in StepRampSettings.model_fields] == [0, 1, 2, 3, 4, 5, 6, 8, 10]


@pytest.mark.parametrize(
    ("packed", "field"),
    [
        ("0200000000001e000100ffff", "outputs"),
        ("0010000000001e000100ffff", "both_edges.0"),
        ("0000000002001e000100ffff", "enable_level"),
        ("0000000000651e000100ffff", "pulse_width_us"),
        ("00000000000013000100ffff", "direction_setup_us"),
        ("0000000000001e00e903ffff", "enable_lead_ms"),
    ],
)
def test_packed_settings_out_of_range(packed: str, field: str) -> None:
    with pytest.raises(Rejected) as caught:
        StepRampSettings.unpack(bytes.fromhex(packed))
    assert [each.field for each in caught.value.rejections] == [field]


@pytest.mark.parametrize(
    ("given_", "field", "allowed"),
    [
        ({"outputs": "relays"}, "outputs", "step_and_direction, gauges"),
        ({"both_edges": 3}, "both_edges", "a list of up to 16 axes, whole numbers from 0 to 3"),
        ({"both_edges": [4]}, "both_edges.0", "a whole number from 0 to 3"),
        ({"pulse_width_us": 1.5}, "pulse_width_us", "a whole number from 0 to 100 µs"),
        ({"enable_hold_ms": 65_535}, "enable_hold_ms", "or null: they stay on"),
        ({"pulse_us": 5}, "pulse_us", "no such field"),
    ],
)
def test_settings_that_cant_be(given_: dict, field: str, allowed: str) -> None:
    with pytest.raises(Rejected) as caught:
        StepRampSettings.checked(given_)
    [rejection] = caught.value.rejections
    assert rejection.field == field
    assert allowed in rejection.allowed


def test_too_few_bytes() -> None:
    with pytest.raises(ValueError, match="12"):
        StepRampSettings.unpack(bytes(11))
