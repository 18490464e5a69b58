import pytest

from firmware import protocol as p
from firmware.controller.client import WHOLE_COMMIT, Controller, started
from firmware.controller.ramps import OTHER, RAMP, TWO_AXES
from firmware.controller.slots import slot
from firmware.controller_host import Driver
from firmware.protocol import Settings, for_axes


def test_slots_lie_in_eeprom_as_documented(controller: Controller) -> None:
    controller.push(RAMP)
    controller.ok(p.WRITE_SETTINGS, Settings(pulse_width_us=3).packed())
    controller.push(TWO_AXES)
    assert (
        controller.driver.ask("eeprom") == (slot(1, RAMP.image()) + slot(2, TWO_AXES, Settings(0, 0, 0, 0, 0, 3))).hex()
    )


def test_the_newer_ramp_is_found_at_start(driver: Driver) -> None:
    controller = started(driver)
    for sequence, ramp in enumerate([RAMP, OTHER, RAMP, OTHER, OTHER], 1):
        controller.push(ramp)
        controller = started(driver)
        status = controller.status()
        assert (status.sequence, status.crc) == (sequence, p.crc16(ramp.image()))
        assert controller.read() == ramp.image()


BAD_CONTENTS = [
    slot(9, b"\1" + OTHER.image()[1:]),
    slot(9, b""),
    slot(9, OTHER.image(), Settings(outputs=7)),
    slot(9, OTHER.image())[:30] + b"\0" + slot(9, OTHER.image())[31:],
    b"\0" * 512,
    b"\x53\2" + b"\xff" * 510,
    b"\x53\1" + slot(9, OTHER.image())[2:],
    b"\x53\2\0\0" + slot(9, OTHER.image())[4:],
]


@pytest.mark.parametrize("bad", BAD_CONTENTS)
def test_a_slot_that_is_not_sound_is_not_used(driver: Driver, bad: bytes) -> None:
    for content in (slot(1, RAMP.image()) + bad, bad + slot(1, RAMP.image())):
        driver.ask("eeprom", content.hex())
        controller = started(driver)
        hello = controller.hello()
        assert (hello.sequence, hello.crc) == (1, p.crc16(RAMP.image()))
        assert (controller.read(), controller.read(p.PREVIOUS)) == (RAMP.image(), b"")
        assert controller.refused(p.ROLL_BACK) == (p.NO_RAMP, 0)
    driver.ask("eeprom", (bad + bad).hex())
    assert started(driver).hello().in_use == p.NO_RAMP_IN_USE


def test_a_slot_with_a_header_cut_while_rolling_back_is_the_older_one(driver: Driver) -> None:
    torn = bytearray(slot(8, OTHER.image()))
    torn[4:8] = b"\xff\0\0\0"
    driver.ask("eeprom", (bytes(torn) + slot(5, RAMP.image())).hex())
    controller = started(driver)
    assert (controller.hello().sequence, controller.read(p.PREVIOUS)) == (5, OTHER.image())
    controller.ok(p.ROLL_BACK)
    controller.run(WHOLE_COMMIT)
    assert (controller.hello().sequence, controller.read()) == (6, OTHER.image())
    driver.ask("eeprom", torn.hex())
    controller = started(driver)
    assert (controller.hello().sequence, controller.read()) == (1, OTHER.image())


def test_bytes_that_are_there_already_are_not_written(controller: Controller) -> None:
    controller.push(RAMP)
    controller.push(RAMP)
    before = int(controller.driver.ask("writes"))
    controller.push(RAMP)
    changed = {i for i, (a, b) in enumerate(zip(slot(1, RAMP.image()), slot(3, RAMP.image()), strict=True)) if a != b}
    assert int(controller.driver.ask("writes")) - before == len(changed | {0}) + 1


def test_a_write_that_fails_keeps_the_ramp(controller: Controller) -> None:
    controller.push(RAMP)
    writes = int(controller.driver.ask("writes"))
    controller.driver.ask("cut", writes + 20)
    controller.push(OTHER)
    status = controller.status()
    assert (status.state, status.write_failed, status.sequence) == (p.IDLE, True, 1)
    assert (controller.read(), controller.read(p.PREVIOUS)) == (RAMP.image(), b"")
    controller.driver.ask("cut", 0)
    controller.ok(p.COMMIT)
    controller.run(WHOLE_COMMIT)
    assert (controller.status().write_failed, controller.read()) == (False, OTHER.image())


def test_a_roll_back_that_fails_keeps_the_ramp(controller: Controller) -> None:
    controller.push(RAMP)
    controller.push(OTHER)
    writes = int(controller.driver.ask("writes"))
    controller.driver.ask("cut", writes + 2)
    controller.ok(p.ROLL_BACK)
    controller.run(WHOLE_COMMIT)
    status = controller.status()
    assert (status.state, status.write_failed, status.sequence) == (p.IDLE, True, 2)
    assert controller.read() == controller.read(p.RAM) == OTHER.image()
    assert status.crc == p.crc16(OTHER.image())


def test_a_previous_ramp_that_has_gone_bad_is_not_rolled_back_to(controller: Controller) -> None:
    """Its bytes change after the start, when it was still good."""
    controller.push(RAMP)
    controller.push(OTHER)
    content = bytearray.fromhex(controller.driver.ask("eeprom"))
    content[40] ^= 1
    controller.driver.ask("eeprom", content.hex())
    assert controller.refused(p.ROLL_BACK) == (p.NO_RAMP, 0)
    assert controller.read(p.RAM) == OTHER.image()
    controller.ok(p.MOVE_BY, for_axes({0: 1}))
