"""The watchdog behind real boot loaders: optiboot 4.4, as Arduino's Uno comes, and that of old Nanos, which hangs."""

from __future__ import annotations

import time
from pathlib import Path

from firmware.checker import ENABLE_PIN, STEP_PINS, of_pin
from firmware.protocol import Client
from firmware.rig import Make
from firmware.test_simulator_storage import GAUGE
from simulator.avr import SimulatedController, build_firmware, build_harness

WATCHDOG = 8
ENABLED = 0
"""The level of the enable pin at which drivers are enabled."""


def move_by(client: Client, steps: int) -> None:
    """Give it a ramp, and wait until it has moved."""
    client.push(GAUGE)
    client.move_by(steps)
    client.wait_until_idle()


def test_the_program_begins_behind_it_and_claims_to_know_no_cause(simulated_controller: Make, optiboot: Path) -> None:
    with simulated_controller(boot_loader=optiboot) as simulated, Client(simulated.port) as client:
        assert client.hello().reset_cause == 0
        move_by(client, 300)
        assert client.status().position == 300


def test_the_watchdog_is_told_and_keeps_the_motors_enabled(simulated_controller: Make, optiboot: Path) -> None:
    with simulated_controller(boot_loader=optiboot) as simulated, Client(simulated.port) as client:
        client.hello()
        move_by(client, 100)
        before = of_pin(simulated.edges(), ENABLE_PIN)
        assert before["value"][-1] == ENABLED
        simulated.overwrite_variables()
        assert client.hello_until_answered().reset_cause == WATCHDOG
        client.status()
    # No motor is let go of: the pin isn't seen at the other level again.
    after = of_pin(simulated.edges(), ENABLE_PIN)[len(before) :]
    assert set(after["value"]) <= {ENABLED}


def test_the_button_is_no_watchdog(simulated_controller: Make, optiboot: Path) -> None:
    """The boot loader waits for a program, and then has a watchdog of its own begin the one that is there."""
    with simulated_controller(boot_loader=optiboot) as simulated, Client(simulated.port) as client:
        client.hello()
        move_by(client, 100)
        simulated.press_reset()
        assert client.hello_until_answered().reset_cause == 0
        assert client.status().position == 0


def test_built_without_a_watchdog_it_lives_behind_a_loader_that_hangs_after_one(
    tmp_path: Path, old_loader: Path
) -> None:
    build_harness()
    firmware = build_firmware("WATCHDOG=no")
    with SimulatedController(firmware, tmp_path, boot_loader=old_loader) as simulated, Client(simulated.port) as client:
        client.hello_until_answered()
        client.push(GAUGE)
        client.move_by(1_000_000)
        while client.status().steps_made < 100:
            pass
        # What is behind its variables was overwritten: it makes no step more, and waits for the button.
        simulated.overwrite_variables()
        made = -1
        while made != (made := len(of_pin(simulated.edges(), STEP_PINS[0]))):
            time.sleep(0.2)
        assert 100 < made < 1_000_000
        simulated.press_reset()
        client.hello_until_answered()
        assert client.status().position == 0
    assert simulated.statistics["resets"] == 1
