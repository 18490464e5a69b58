import pytest
from hypothesis import given
from hypothesis import strategies as st

from stepramp.controllers.stepramp.settings import OFFSETS, StepRampSettings
from stepramp.controllers.stepramp.soft_limits import NO_LIMITS
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
ROLES = st.sampled_from(
    [
        {"input": "A0", "role": "emergency_stop", "active": "high"},
        {"input": "A1", "role": "driver_fault", "pull_up": False},
        {"input": "A5", "role": "limit", "axis": 3, "end": "high", "stops": "at_once"},
        {"input": "D11", "role": "limit", "axis": 0, "end": "low", "stops": "ramp"},
    ]
)
INPUT_SETTINGS = st.builds(
    StepRampSettings,
    silence_s=st.integers(2, 200).map(lambda steps: steps * 0.256),
    silence_ends_moves=st.booleans(),
    looks=st.integers(1, 10),
    inputs=st.lists(ROLES, max_size=4, unique_by=lambda role: role["input"]),
)
USUAL = bytes.fromhex("0000000000001e000100ffff 04 00 04 000000000000000000")


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
    assert [*OFFSETS.values()] == [0, 1, 2, 3, 4, 5, 6, 8, 10, 12, 13, 14, 15]


@given(INPUT_SETTINGS)
def test_settings_of_inputs_come_back(settings: StepRampSettings) -> None:
    assert StepRampSettings.unpack(settings.pack(USUAL)) == settings


def test_settings_of_inputs_byte_by_byte() -> None:
    settings = StepRampSettings.checked(
        {
            "silence_s": 1.5,
            "silence_ends_moves": True,
            "looks": 10,
            "inputs": [
                {"input": "D11", "role": "limit", "axis": 3, "end": "high", "stops": "at_once", "active": "high"},
                {"input": "A0", "role": "emergency_stop"},
                {"input": "A5", "role": "emergency_stop", "active": "high"},
                {"input": "A1", "role": "driver_fault", "pull_up": False},
                {"input": "D9", "role": "limit", "axis": 2, "end": "low"},
            ],
        }
    )
    assert settings.pack(USUAL) == USUAL[:12] + bytes.fromhex("06 01 0a  01 82 00 00 00 41 0a 00 6f")
    assert settings.silence_s == 1.536
    assert [role.input for role in settings.inputs or ()] == ["A0", "A1", "A5", "D9", "D11"]


def test_soft_limits_byte_by_byte() -> None:
    limits = [{"axis": 3, "highest_steps": 1}, {"axis": 0, "lowest_steps": -2}, {"axis": 2}]
    settings = StepRampSettings.checked({"soft_limits": limits})
    none = "00000080" + "ffffff7f"
    packed = bytes.fromhex("feffffff" + "ffffff7f" + none + none + "00000080" + "01000000")
    assert settings.pack_limits(NO_LIMITS) == packed
    assert StepRampSettings.unpack(USUAL, packed).soft_limits == settings.soft_limits
    assert [limit.axis for limit in settings.soft_limits or ()] == [0, 3]
    # What isn't given stays as it is.
    assert StepRampSettings().pack_limits(packed) == packed
    assert StepRampSettings(soft_limits=()).pack_limits(packed) == NO_LIMITS
    assert StepRampSettings.unpack(USUAL).soft_limits is None


def test_what_isnt_given_stays_as_it_is_and_what_isnt_known_too() -> None:
    before = USUAL[:12] + bytes.fromhex("06 01 0a  01 82 00 00 00 41 0a 00 6f  ab cd")
    assert StepRampSettings(pulse_width_us=9).pack(before)[12:] == before[12:]
    changed = StepRampSettings(looks=1, inputs=())
    assert changed.pack(before)[12:] == bytes.fromhex("06 01 01" + 9 * "00" + "ab cd")
    assert StepRampSettings.unpack(before).looks == 10
    assert (changed.given_of_inputs, StepRampSettings().given_of_inputs) == (["looks", "inputs"], [])


def test_without_inputs_their_settings_are_null() -> None:
    settings = StepRampSettings.unpack(USUAL[:12])
    assert (settings.silence_s, settings.silence_ends_moves, settings.looks, settings.inputs) == (None,) * 4


@pytest.mark.parametrize(("number", "byte"), [(0, 3), (0, 0x10), (0, 0x20), (0, 0x21), (6, 1), (8, 0x22), (2, 0x40)])
def test_bytes_that_are_no_role(number: int, byte: int) -> None:
    packed = bytearray(USUAL)
    packed[15 + number] = byte
    with pytest.raises(Rejected) as caught:
        StepRampSettings.unpack(bytes(packed))
    assert [each.field for each in caught.value.rejections] == [f"inputs.{number}"]


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
        ({"silence_s": 0.5}, "silence_s", "from 0.512 to 51.2 s, or null: it stays as it is"),
        ({"looks": 0}, "looks", "a whole number from 1 to 10"),
        ({"inputs": [{"input": "D8", "role": "limit"}]}, "inputs.0.input", "A0, A1"),
        ({"inputs": [{"input": "A0", "role": "stop"}]}, "inputs.0.role", "emergency_stop, driver_fault, limit"),
        ({"inputs": [{"input": "D9", "role": "emergency_stop"}]}, "inputs.0.input", "one of A0, A1, A2, A3, A4, A5"),
        ({"inputs": [{"input": "A0", "role": "limit", "end": "low"}]}, "inputs.0.axis", "a whole number from 0 to 3"),
        ({"inputs": [{"input": "A0", "role": "limit", "axis": 1}]}, "inputs.0.end", "low or high"),
        ({"inputs": [{"input": "A0", "role": "driver_fault", "axis": 1}]}, "inputs.0.axis", "null, since driver_fault"),
        (
            {"inputs": [{"input": "A2", "role": "driver_fault"}, {"input": "A2", "role": "emergency_stop"}]},
            "inputs.1.input",
            "each input once",
        ),
        ({"soft_limits": [{"axis": 4}]}, "soft_limits.0.axis", "a whole number from 0 to 3"),
        ({"soft_limits": [{"axis": 1}, {"axis": 1}]}, "soft_limits.1.axis", "each axis once"),
        (
            {"soft_limits": [{"axis": 0, "highest_steps": 2**31}]},
            "soft_limits.0.highest_steps",
            "a whole number from -2,147,483,648 to 2,147,483,647 steps, or null: no limit on that side",
        ),
        (
            {"soft_limits": [{"axis": 0, "lowest_steps": 8, "highest_steps": 7}]},
            "soft_limits.0.lowest_steps",
            "at most highest_steps, which is 7",
        ),
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
