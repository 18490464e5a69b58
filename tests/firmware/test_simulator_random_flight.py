"""Motors never wait: random requests in flight on the simulated chip, at the limits of what it grants and below.

Each session is made by its seed alone, and plays the same way to the cycle. One that fails is run again with, say,

    pytest tests/firmware/test_simulator_random_flight.py -k seed_017
"""

from collections.abc import Callable
from pathlib import Path

import pytest

from firmware.flight.judge import judge
from firmware.flight.judgement import Judgement
from firmware.session import session_of
from simulator.avr import build_firmware, build_harness, converse, missing_tools
from tools import require

SEEDS = range(80)
REQUESTS_IN_FLIGHT = 10_000


@pytest.fixture(scope="module")
def judged() -> dict[int, Judgement]:
    """The sessions so far, by their seeds."""
    require(*missing_tools())
    build_harness()
    return {}


@pytest.mark.parametrize("seed", SEEDS, ids=lambda seed: f"seed_{seed:03}")
def test_motors_never_wait(
    tmp_path: Path, judged: dict[int, Judgement], record_property: Callable[..., None], seed: int
) -> None:
    session = session_of(seed)
    judgement = judged[seed] = judge(converse(build_firmware(), tmp_path, session.asked), session.setting)
    record_property("session", session.title)
    assert not judgement.faults, "\n".join([session.title, *judgement.faults])


def test_there_were_enough_of_them(judged: dict[int, Judgement], record_property: Callable[..., None]) -> None:
    if len(judged) < len(SEEDS):
        pytest.skip("only some of the sessions have been run")
    requests = sum(one.in_flight for one in judged.values())
    record_property("requests_in_flight", int(requests))
    record_property("starved", int(sum(one.starved for one in judged.values())))
    record_property("latest_step_us", float(max(one.latest_us for one in judged.values())))
    record_property("slowest_stop_ms", float(max(one.slowest_stop_ms for one in judged.values())))
    assert requests >= REQUESTS_IN_FLIGHT
