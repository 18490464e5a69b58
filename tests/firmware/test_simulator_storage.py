"""Storing ramps on the simulated chip: EEPROM, resets, power cuts; and the serial line and the stack meanwhile."""

import struct
from collections import Counter
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path

from firmware.protocol import (
    BEGIN,
    BUSY,
    COMMIT,
    DATA,
    END,
    IN_MOTION,
    PREVIOUS,
    RAM,
    READ_SETTINGS,
    ROLL_BACK,
    STATUS,
    STORED,
    WRITING,
    Client,
    Hello,
    Ramp,
    Settings,
    crc16,
    encode_frame,
    image_of,
)
from simulator.avr import SimulatedController, build_firmware, pulses

Make = Callable[..., SimulatedController]
GAUGE = Ramp([(10_000, 9, 0), (3000, 20, 0), (2000, 70, 0), (1600, 50, 0), (1200, 150, 0)], 1200, [(10_000, 9, 0)])
SMALL = Ramp([(9000, 7, -11)], 1234, [])
OTHER_SMALL = Ramp([(5000, 60, -30)], 3000, [])
LARGEST = Ramp([(16_000 - 60 * i, 200, -1 if i % 2 else 1) for i in range(84)], 1000, []).image()
"""Nearly the largest image."""
CHANGED = Settings(pulse_width_us=3, enable_hold_ms=5000)


def stored(hello: Hello) -> tuple[int, int]:
    return hello.sequence, hello.crc


def test_a_ramp_and_settings_survive_a_reset_and_a_power_cycle(simulated_controller: Make) -> None:
    with simulated_controller() as simulated, Client(simulated.port) as client:
        client.hello()
        client.push(SMALL)
        simulated.press_reset()
        assert stored(client.hello_until_answered()) == (1, crc16(SMALL.image()))
        client.write_settings(CHANGED)
        client.push(GAUGE)
    with simulated, Client(simulated.port) as client:
        assert stored(client.hello()) == (2, crc16(GAUGE.image()))
        assert (client.read(STORED), client.read(PREVIOUS)) == (GAUGE.image(), SMALL.image())
        client.move_by(3)
        client.wait_until_idle()
    assert len(pulses(simulated.edges())) == 3


def test_hello_tells_why_it_was_reset(simulated_controller: Make) -> None:
    with simulated_controller() as simulated, Client(simulated.port) as client:
        assert client.hello().reset_cause & 1
        simulated.press_reset()
        assert client.hello_until_answered().reset_cause & 2


def test_a_ramp_is_rolled_back(simulated_controller: Make) -> None:
    with simulated_controller(real_time=False) as simulated, Client(simulated.port) as client:
        client.hello()
        client.push(SMALL)
        client.push(OTHER_SMALL)
        client.expect_ok(ROLL_BACK)
        client.wait_while(WRITING)
        assert (client.read(STORED), client.read(PREVIOUS)) == (SMALL.image(), OTHER_SMALL.image())
    with simulated, Client(simulated.port) as client:
        assert stored(client.hello()) == (3, crc16(SMALL.image()))


def test_opening_the_port_resets_and_the_boot_loader_is_deaf(simulated_controller: Make) -> None:
    with simulated_controller(boot_ms=500) as simulated, Client(simulated.port) as client:
        client.hello_until_answered()
        client.push(GAUGE)
        assert client.read(STORED) == GAUGE.image()


def test_a_reset_in_the_middle_of_a_move_lets_go_of_the_motor(simulated_controller: Make) -> None:
    with simulated_controller() as simulated, Client(simulated.port) as client:
        client.hello()
        client.push(GAUGE)
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
    assert 420 < len(LARGEST) <= 440
    with simulated_controller(real_time=False) as simulated, Client(simulated.port) as client:
        client.hello()
        client.push(GAUGE)
        client.push(LARGEST)
        assert client.read(STORED) == client.read(RAM) == LARGEST
        client.move_by(200)
        client.wait_until_idle()
    statistics = simulated.statistics
    with simulated, Client(simulated.port) as client:
        client.hello()
        assert client.read(STORED) == LARGEST
        client.expect_ok(BEGIN, struct.pack("<HH", len(LARGEST), 0))
        client.move_by(1)
        assert client.read(RAM) == LARGEST
    record_property("stack_bytes", statistics["stack_bytes"])
    record_property("untouched_stack_bytes", statistics["untouched_stack_bytes"])
    assert statistics["untouched_stack_bytes"] >= 32
    assert statistics["lost_bytes"] == 0


def test_requests_are_answered_while_a_ramp_is_written(simulated_controller: Make) -> None:
    with simulated_controller() as simulated, Client(simulated.port) as client:
        client.hello()
        client.push(GAUGE)
        client.deliver(LARGEST)
        client.expect_ok(COMMIT)
        answers = 0
        while True:
            kept, refusal = client.read(STORED), client.request(END)
            if client.status().state != WRITING:
                break
            assert (kept, refusal[0]) == (GAUGE.image(), BUSY)
            answers += 1
        assert answers > 5
        assert client.read(STORED) == LARGEST
    assert simulated.statistics["lost_bytes"] == 0
    assert simulated.statistics["longest_answer_cycles"] < 1_600_000


def test_a_delivery_is_loaded_back_from_eeprom_by_a_move(simulated_controller: Make) -> None:
    """The stored ramp has to be loaded first; the answer still comes in time."""
    two = image_of([GAUGE.packed(), SMALL.packed()], [0, 1])
    with simulated_controller() as simulated, Client(simulated.port) as client:
        client.hello()
        client.push(LARGEST)
        client.deliver(two)
        client.move_by(5)
        assert client.status().state == IN_MOTION
        assert client.wait_until_idle().position == 5
        assert client.read(RAM) == LARGEST
    assert simulated.statistics["longest_answer_cycles"] < 1_600_000


# ---- power cuts at every write


def slot(sequence: int, image: bytes, settings: Settings) -> bytes:
    content = settings.packed() + image
    header = struct.pack("<BBHIH", 0x53, 2, len(content), sequence, crc16(content))
    return (header + struct.pack("<H", crc16(header)) + content).ljust(512, b"\xff")


def commit(client: Client) -> None:
    client.write_settings(CHANGED)
    client.deliver(OTHER_SMALL.image())
    client.send(COMMIT)


def roll_back(client: Client) -> None:
    client.send(ROLL_BACK)


Found = tuple[int, bytes, bytes, bytes]
"""Sequence number, the stored image, the previous one, the settings."""


def begin_and_cut(simulated: SimulatedController, what: Callable[[Client], None]) -> None:
    with simulated, Client(simulated.port) as client:
        client.hello()
        what(client)
        simulated.wait_for_power_cut()


def found_in(simulated: SimulatedController) -> Found:
    with simulated, Client(simulated.port) as client:
        hello = client.hello()
        assert not client.status().write_failed
        return hello.sequence, client.read(STORED), client.read(PREVIOUS), client.expect_ok(READ_SETTINGS)


def after_power_cut(folder: Path, kept: bytes, what: Callable[[Client], None], cut: int) -> Found:
    """Let the power fail in the middle of an EEPROM write of what is done; return what is there then."""
    place = folder / f"cut-{cut}"
    place.mkdir()
    eeprom = place / "kept.bin"
    eeprom.write_bytes(kept)
    simulated = SimulatedController(build_firmware(), place, real_time=False, eeprom=eeprom, cut_power_at_write=cut)
    begin_and_cut(simulated, what)
    assert simulated.statistics["power_was_cut"]
    return found_in(simulated)


def writes_of(simulated: SimulatedController, what: Callable[[Client], None]) -> int:
    with simulated, Client(simulated.port) as client:
        client.hello()
        what(client)
        client.read_frame()
        client.wait_while(WRITING)
    return int(simulated.statistics["eeprom_writes"])


def outcomes_of_cuts(make: Make, folder: Path, kept: bytes, what: Callable[[Client], None]) -> list[Found]:
    """Cut the power at each write in turn, two at a time."""
    eeprom = folder / "whole.bin"
    eeprom.write_bytes(kept)
    writes = writes_of(make(real_time=False, eeprom=eeprom), what)
    with ThreadPoolExecutor(2) as pool:
        return list(pool.map(partial(after_power_cut, folder, kept, what), range(1, writes + 1)))


OLD = SMALL.image(), b"", Settings().packed()


def test_a_power_cut_at_each_write_of_a_commit(
    simulated_controller: Make, tmp_path: Path, record_property: Callable[..., None]
) -> None:
    kept = slot(1, SMALL.image(), Settings()).ljust(1024, b"\xff")
    outcomes = outcomes_of_cuts(simulated_controller, tmp_path, kept, commit)
    names = {(1, *OLD): "old", (2, OTHER_SMALL.image(), SMALL.image(), CHANGED.packed()): "new"}
    counts = Counter(names.get(outcome, "neither") for outcome in outcomes)
    for name in ("old", "new", "neither"):
        record_property(name, counts[name])
    assert counts["neither"] == 0
    assert counts["old"] == len(outcomes) >= 40  # the last write of all is the one that makes it whole


def test_a_power_cut_at_each_write_of_a_roll_back(
    simulated_controller: Make, tmp_path: Path, record_property: Callable[..., None]
) -> None:
    kept = slot(255, SMALL.image(), Settings()) + slot(256, OTHER_SMALL.image(), CHANGED)
    outcomes = outcomes_of_cuts(simulated_controller, tmp_path, kept, roll_back)
    names = {
        (OTHER_SMALL.image(), SMALL.image(), CHANGED.packed()): "old",
        (SMALL.image(), OTHER_SMALL.image(), Settings().packed()): "new",
    }
    counts = Counter(names.get(outcome[1:], "neither") for outcome in outcomes)
    for name in ("old", "new", "neither"):
        record_property(name, counts[name])
    assert counts["neither"] == 0
    assert len(outcomes) >= 4


def test_damaged_frames_are_dropped_and_the_next_one_is_answered(simulated_controller: Make) -> None:
    with simulated_controller() as simulated, Client(simulated.port) as client:
        client.hello()
        client.send_raw(b"\x05noise without an end" * 9 + b"\0")
        client.send_raw(encode_frame(struct.pack("<BHB", DATA, 1, 2) + bytes(48))[:-3] + b"\0\0")
        assert client.request(STATUS, b"\0")[0] == 0
