"""A controller on a cable: run with `./dev test tests/hardware --device-port /dev/ttyACM0 --allow-moves`.

Nothing is stored: a ramp is tried in RAM, and dropped at the end. Motors move only with --allow-moves, a few hundred
steps forward and back at 1000 steps/s or less; let nothing be in their way.
"""

import os
from collections.abc import Iterator

import pytest

from firmware.protocol import (
    HALT,
    IDLE,
    NO_RAMP_IN_USE,
    RAM,
    ROLL_BACK,
    STOP,
    STORED_IN_USE,
    TRIAL_IN_USE,
    Client,
    Hello,
    Ramp,
    crc16,
)

RAMP = Ramp([(20_000, 10, -1000), (10_000, 40, -150)], 4000, [(20_000, 10, -1000), (10_000, 40, -150)])
"""Up to 500 steps/s."""
STEPS = 200


@pytest.fixture
def port(request: pytest.FixtureRequest) -> str:
    port: str | None = request.config.getoption("--device-port")
    if os.environ.get("CI") == "true":
        pytest.skip("CI has no controller")
    return port or pytest.skip("needs a controller: --device-port PORT")


@pytest.fixture
def moves_allowed(request: pytest.FixtureRequest) -> bool:
    return bool(request.config.getoption("--allow-moves")) or pytest.skip("would move motors: --allow-moves")


@pytest.fixture
def controller(port: str) -> Iterator[Client]:
    """Return a client; what it has tried out is dropped in the end."""
    with Client(port) as client:
        before = client.hello_until_answered()
        assert client.status().state == IDLE
        yield client
        client.expect_ok(HALT)
        if client.hello().in_use == TRIAL_IN_USE:
            client.expect_ok(ROLL_BACK)
        check_is_as_before(client.hello(), before)


def check_is_as_before(now: Hello, before: Hello) -> None:
    assert now.sequence == before.sequence
    if before.in_use != TRIAL_IN_USE:
        assert (now.in_use, now.crc) == (before.in_use, before.crc)


def test_hello(controller: Client) -> None:
    hello = controller.hello()
    assert hello.version == 2
    assert (hello.fast_clock_hz, hello.slow_clock_hz) == (16_000_000, 2_000_000)
    assert 1 <= hello.axes <= 4
    assert hello.in_use in (NO_RAMP_IN_USE, STORED_IN_USE)


def test_a_ramp_is_tried_in_ram(controller: Client) -> None:
    before = controller.hello()
    controller.try_out(RAMP)
    assert controller.read(RAM) == RAMP.image()
    now = controller.hello()
    assert (now.in_use, now.crc, now.sequence) == (TRIAL_IN_USE, crc16(RAMP.image()), before.sequence)
    controller.expect_ok(ROLL_BACK)
    check_is_as_before(controller.hello(), before)


@pytest.mark.usefixtures("moves_allowed")
def test_a_move_there_and_back(controller: Client) -> None:
    controller.try_out(RAMP)
    start = controller.status().position
    for steps in (STEPS, -STEPS):
        controller.move_by(steps)
        status = controller.wait_until_idle()
        assert (status.steps_made, status.starved) == (STEPS, 0)
    assert status.position == start


@pytest.mark.usefixtures("moves_allowed")
@pytest.mark.parametrize("kind", [STOP, HALT])
def test_a_move_is_ended_early(controller: Client, kind: int) -> None:
    controller.try_out(RAMP)
    start = controller.status().position
    controller.move_by(20 * STEPS)
    while controller.status().steps_made < STEPS // 2:
        pass
    controller.expect_ok(kind)
    status = controller.wait_until_idle()
    assert STEPS // 2 <= status.position - start < 20 * STEPS
    assert status.target == status.position
    controller.move_to(start)
    assert controller.wait_until_idle().position == start
