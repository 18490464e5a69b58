import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware.host import Host
from firmware.machine.ramps import QUICK, SHARP
from firmware.motion import Machine, image_of


@given(wait=st.integers(0, 300_000))
def test_a_report_counts_the_steps_made(host: Host, wait: int) -> None:
    machine = Machine(host, image_of(SHARP))
    machine.move(500)
    machine.do("wait", wait)
    report = machine.report()
    assert report.position == report.steps_made == machine.steps().travel
    assert report.target == 500


@pytest.mark.parametrize(("k", "steps"), [(1, 60), (7, 300), (64, 2000)])
def test_trace(host: Host, k: int, steps: int) -> None:
    """The timer's value at the first step and every k-th after it."""
    machine = Machine(host, image_of(QUICK))
    machine.do("trace", 0, k)
    machine.move(steps)
    machine.rest()
    times = machine.steps().times
    assert machine.traced() == [(i + 1, times[i] % 2**16) for i in range(0, steps, k)]
