"""Storing ramps on the simulated chip: EEPROM, resets, power cuts; and the serial line and the stack meanwhile."""

import struct
from collections.abc import Callable
from pathlib import Path

import pytest

from firmware.protocol import BUSY, COMMIT, DATA, END, STATUS, WRITING, Client, Ramp, crc16, encode_frame
from firmware.test_simulator_moves import LEAD_SCREW
from simulator.avr import SimulatedController, pulses

Make = Callable[..., SimulatedController]
GAUGE = Ramp([(10_000, 9, 0), (3000, 20, 0), (2000, 70, 0), (1600, 50, 0), (1200, 150, 0)], 1200, [(10_000, 9, 0)])
LARGEST = Ramp([(16_000 - 60 * i, 200, -1 if i % 2 else 1) for i in range(98)], 1000, [])
"""Nearly the largest image."""


def test_a_ramp_survives_a_reset_and_a_power_cycle(simulated_controller: Make) -> None:
    with simulated_controller() as simulated, Client(simulated.port) as client:
        client.hello()
        client.push(LEAD_SCREW)
        simulated.press_reset()
        hello = client.hello_until_answered()
        assert struct.unpack("<IH", hello[-6:]) == (1, crc16(LEAD_SCREW.image()))
        client.push(GAUGE)
    with simulated, Client(simulated.port) as client:
        assert struct.unpack("<IH", client.hello()[-6:]) == (2, crc16(GAUGE.image()))
        assert client.read(0) == GAUGE.image()
        client.move_by(3)
        client.wait_until_idle()
    assert len(pulses(simulated.edges())) == 3


def test_opening_the_port_resets_and_the_boot_loader_is_deaf(simulated_controller: Make) -> None:
    with simulated_controller(boot_ms=500) as simulated, Client(simulated.port) as client:
        client.hello_until_answered()
        client.push(GAUGE)
        assert client.read(0) == GAUGE.image()


def test_a_reset_in_the_middle_of_a_move_lets_go_of_the_motor(simulated_controller: Make) -> None:
    with simulated_controller() as simulated, Client(simulated.port) as client:
        client.hello()
        client.push(LEAD_SCREW)
        client.move_by(1_000_000)
        while client.status().steps_made < 400:
            pass
        simulated.press_reset()
        client.hello_until_answered()
        made = len(pulses(simulated.edges()))
        status = client.status()
        assert (status.state, status.position) == (0, 0)
    assert len(pulses(simulated.edges())) == made


def test_the_largest_image_is_stored(simulated_controller: Make, record_property: Callable[..., None]) -> None:
    assert 490 < len(LARGEST.image()) <= 500
    with simulated_controller(real_time=False) as simulated, Client(simulated.port) as client:
        client.hello()
        client.push(LEAD_SCREW)
        client.push(LARGEST)
        assert client.read(0) == client.read(1) == LARGEST.image()
        client.move_by(200)
        client.wait_until_idle()
    statistics = simulated.statistics
    with simulated, Client(simulated.port) as client:
        client.hello()
        assert client.read(0) == LARGEST.image()
    record_property("untouched_stack_bytes", statistics["untouched_stack_bytes"])
    assert statistics["stack_bytes"] >= 250
    assert statistics["untouched_stack_bytes"] >= 64
    assert statistics["lost_bytes"] == 0


def test_requests_are_answered_while_a_ramp_is_written(simulated_controller: Make) -> None:
    with simulated_controller() as simulated, Client(simulated.port) as client:
        client.hello()
        client.push(GAUGE)
        client.stage(LARGEST.image())
        client.expect_ok(COMMIT)
        answers = 0
        while True:
            stored, refusal = client.read(0), client.request(END)
            if client.status().state != WRITING:
                break
            assert (stored, refusal[0]) == (GAUGE.image(), BUSY)
            answers += 1
        assert answers > 5
        assert client.read(0) == LARGEST.image()
    assert simulated.statistics["lost_bytes"] == 0


@pytest.mark.parametrize("cut", [1, 2, 20, 35, 36, 40, 46, 47])
def test_a_power_cut_leaves_the_old_ramp_or_the_new_one(simulated_controller: Make, tmp_path: Path, cut: int) -> None:
    eeprom = tmp_path / "kept.bin"
    with simulated_controller(real_time=False, eeprom=eeprom) as simulated, Client(simulated.port) as client:
        client.hello()
        client.push(GAUGE)
    with simulated_controller(real_time=False, eeprom=eeprom, cut_power_at_write=cut) as simulated:
        with Client(simulated.port) as client:
            client.hello()
            client.stage(LEAD_SCREW.image())
            client.send(COMMIT)
            simulated.wait_for_power_cut()
        simulated.stop()
        assert simulated.statistics["power_was_cut"]
        simulated.start()
        with Client(simulated.port) as client:
            (sequence,) = struct.unpack("<I", client.hello()[-6:-2])
            assert (sequence, client.read(0)) == (1, GAUGE.image())
            client.push(LEAD_SCREW)
            assert client.read(0) == LEAD_SCREW.image()


def test_damaged_frames_are_dropped_and_the_next_one_is_answered(simulated_controller: Make) -> None:
    with simulated_controller() as simulated, Client(simulated.port) as client:
        client.hello()
        client.send_raw(b"\x05noise without an end" * 9 + b"\0")
        client.send_raw(encode_frame(struct.pack("<BHB", DATA, 1, 2) + bytes(48))[:-3] + b"\0\0")
        assert client.request(STATUS)[0] == 0
