"""driver_settings.c: what is allowed, and that nothing is lost on the way."""

from collections.abc import Iterator
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware.controller_host import Driver, missing_compiler
from firmware.protocol import Settings
from tools import require

SETTINGS_BYTES = 12
OFFSETS = {
    "outputs": 0,
    "both_edges": 1,
    "step_inverted": 2,
    "direction_inverted": 3,
    "enable_flags": 4,
    "pulse_width_us": 5,
    "direction_setup_us": 6,
    "enable_lead_ms": 8,
    "enable_hold_ms": 10,
}
RANGES = {
    "outputs": (0, 1),
    "both_edges": (0, 15),
    "step_inverted": (0, 15),
    "direction_inverted": (0, 15),
    "enable_flags": (0, 1),
    "pulse_width_us": (0, 100),
    "direction_setup_us": (20, 15_000),
    "enable_lead_ms": (0, 1000),
    "enable_hold_ms": (0, 65_535),
}


@pytest.fixture(scope="module")
def driver() -> Iterator[Driver]:
    require(*missing_compiler())
    with Driver() as running:
        yield running


def check(driver: Driver, packed: bytes) -> int:
    """Return the first bad byte. Also sees that unpacking and packing changes nothing."""
    bad, again = driver.ask("settings", packed.hex()).split()
    assert again == packed.hex()
    return int(bad)


@given(packed=st.binary(min_size=SETTINGS_BYTES, max_size=SETTINGS_BYTES))
def test_any_bytes(driver: Driver, packed: bytes) -> None:
    settings = Settings(*packed[:6], *(int.from_bytes(packed[i : i + 2], "little") for i in (6, 8, 10)))
    bad = [OFFSETS[name] for name, (low, high) in RANGES.items() if not low <= getattr(settings, name) <= high]
    assert check(driver, packed) == (bad[0] if bad else SETTINGS_BYTES)


@pytest.mark.parametrize("name", RANGES)
def test_the_limits(driver: Driver, name: str) -> None:
    low, high = RANGES[name]
    largest = 65_535 if OFFSETS[name] > 5 else 255
    for value in (low, high):
        assert check(driver, replace(Settings(), **{name: value}).packed()) == SETTINGS_BYTES
    for value in {low - 1, high + 1} & set(range(largest + 1)):
        assert check(driver, replace(Settings(), **{name: value}).packed()) == OFFSETS[name]
