from pathlib import Path

import pytest

from firmware.host import Host
from firmware.machine.ramps import QUICK
from firmware.motion import Machine, image_of


def test_the_motor_is_enabled_in_time_and_let_go(program: Path) -> None:
    """Enabled 3 ms before the first step at least, and for 10 ms after the last interval."""
    settings = bytes([0, 0, 0, 0, 0, 0]) + (30).to_bytes(2, "little") + (3).to_bytes(2, "little") + b"\x0a\x00"
    with Host(program) as host:
        machine = Machine(host, image_of(QUICK), settings)
        machine.move(10)
        ended = machine.rest()
        machine.do("wait", 100_000)
        *before, (on, is_on), (off, is_off) = machine.enabled()
        assert not any(was_on for _, was_on in before)
        assert (is_on, is_off) == (1, 0)
        assert machine.steps().times[0] - on >= 3 * 2000
        assert 9 * 2000 <= off - ended <= 12 * 2000


def enable_times(lead_ms: int, hold_ms: int) -> bytes:
    """Return settings with these."""
    return bytes(6) + b"".join(value.to_bytes(2, "little") for value in (30, lead_ms, hold_ms))


@pytest.mark.parametrize("pause_ms", [1500, 65_550, 66_000, 131_100])
def test_motors_that_have_held_for_long_begin_at_once(program: Path, pause_ms: int) -> None:
    """Also when a count of milliseconds in 16 bits comes round."""
    with Host(program) as host:
        machine = Machine(host, image_of(QUICK), enable_times(1000, 0xFFFF), round_ticks=2000)
        machine.move(10)
        machine.rest()
        on = machine.enabled()[-1][0]
        assert machine.steps().times[0] - on >= 1000 * 2000
        while (left := on + pause_ms * 2000 - machine.rest()) > 0:
            machine.do("wait", left)
        asked = machine.rest()
        machine.move(20)
        machine.rest()
        assert machine.steps().times[0] - asked <= 10 * 2000


def test_motors_that_are_not_held_are_let_go_at_rest_and_not_before(program: Path) -> None:
    with Host(program) as host:
        machine = Machine(host, image_of(QUICK), enable_times(0, 0))
        machine.move(10)
        ended = machine.rest()
        machine.do("wait", 10_000)
        *_, (on, is_on), (off, is_off) = machine.enabled()
        assert (is_on, is_off) == (1, 0)
        assert on < machine.steps().times[0]
        assert off >= ended - 100


def test_motors_are_let_go_after_the_longest_hold(program: Path) -> None:
    """Also when the main loop takes 4 ms for a round, and so misses the last of 65,536 ms."""
    with Host(program) as host:
        machine = Machine(host, image_of(QUICK), enable_times(1, 65_534), round_ticks=8_000)
        machine.move(10)
        ended = machine.rest()
        machine.do("wait", 70_000 * 2000)
        *_, (on, is_on), (off, is_off) = machine.enabled()
        assert (is_on, is_off) == (1, 0)
        assert 65_520 * 2000 <= off - ended <= 65_550 * 2000
        assert on < ended
