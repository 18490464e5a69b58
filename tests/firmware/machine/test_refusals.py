import pytest

from firmware.host import Host
from firmware.motion import NO_RAMP, OK, TOO_FAST, Machine, StoredRamp, image_of


def test_without_a_ramp(host: Host) -> None:
    machine = Machine(host, b"")
    assert machine.move(5) == (NO_RAMP, 0)
    assert machine.ask("run", 1, 5000) == (NO_RAMP, 0)
    assert machine.ask("line", 1, 0, 5) == (NO_RAMP, 0)


@pytest.mark.parametrize(("fast", "slew", "status"), [(True, 106, OK), (True, 105, None), (False, 14, OK)])
def test_the_fastest_slew_of_one_axis(host: Host, fast: bool, slew: int, status: int | None) -> None:  # a table
    """150,000 steps/s are 106.7 cycles; a shorter interval is refused by the check of the image."""
    image = image_of(StoredRamp((), slew, ()), fast=fast)
    checked = host.ask("check", image.hex())
    assert checked == ("good 1 1" if status is not None else f"bad {0 << 8 | 255}")
    if status is not None:
        assert Machine(host, image, round_ticks=1000).move(10) == (status, 0)


def test_too_fast_is_a_share_of_the_processor(host: Host) -> None:
    """Wide pulses take their time, and as much again for all else: 200 us of an interval of 100 us."""
    settings = bytes([0, 0, 0, 0, 0, 100]) + (30).to_bytes(2, "little") + bytes(4)
    machine = Machine(host, image_of(StoredRamp((), 200, ())), settings)
    status, percent = machine.move(5)
    assert status == TOO_FAST
    assert percent == (106 + 100 * 32) * 100 // 1600
