"""Version 2 and 3 understand each other."""

from firmware import protocol as p
from firmware.controller.client import WHOLE_COMMIT, Controller
from firmware.controller.ramps import RAMP
from firmware.controller_host import Driver
from firmware.inputs.machine import ROLES, Machine
from firmware.protocol import InputSettings, Settings

FORMULAS, GAUGES, INPUTS, KEEPS, SOFT_LIMITS = 1, 2, 4, 8, 16
SLOT_BYTES = 512


def test_hello_tells_capabilities_and_lengths(machine: Machine) -> None:
    reply = machine.ok(p.HELLO, b"\3")
    assert len(reply) == 47
    assert reply[0] == 3
    assert list(reply[44:]) == [FORMULAS | GAUGES | INPUTS | KEEPS | SOFT_LIMITS, 24, 32]
    assert len(machine.ok(p.STATUS, b"\0")) == 31
    assert len(machine.ok(p.READ_SETTINGS)) == 24


def test_without_inputs_it_says_so() -> None:
    with Driver() as driver:
        driver.ask("begin")
        controller = Controller(driver)
        reply = controller.ok(p.HELLO, b"\3")
        assert (reply[0], list(reply[44:])) == (3, [FORMULAS | GAUGES | KEEPS, 12, 27])
        assert len(controller.ok(p.STATUS, b"\0")) == 26
        assert len(controller.ok(p.READ_SETTINGS)) == 12
        assert controller.refused(p.ACKNOWLEDGE) == (p.UNKNOWN_KIND, p.ACKNOWLEDGE)
        assert controller.refused(p.READ_LIMITS, b"\0") == (p.UNKNOWN_KIND, p.READ_LIMITS)
        assert controller.refused(p.WRITE_LIMITS, bytes(9)) == (p.UNKNOWN_KIND, p.WRITE_LIMITS)
        assert controller.refused(p.HOME, bytes(11))[0] == p.UNKNOWN_KIND
        long = Settings().packed() + InputSettings().packed()
        assert controller.refused(p.WRITE_SETTINGS, long) == (p.BAD_LENGTH, 24)


def test_a_client_of_version_2_gets_what_it_knows(machine: Machine) -> None:
    reply = machine.ok(p.HELLO, b"\2")
    assert (len(reply), reply[0]) == (44, 2)
    assert len(machine.ok(p.STATUS, b"\0")) == 26
    assert machine.ok(p.READ_SETTINGS) == Settings().packed()


def test_settings_of_version_2_leave_the_inputs_as_they_are(machine: Machine) -> None:
    machine.ok(p.HELLO, b"\2")
    machine.ok(p.WRITE_SETTINGS, Settings(enable_lead_ms=7).packed())
    machine.ok(p.HELLO, b"\3")
    assert machine.settings() == Settings(enable_lead_ms=7).packed() + InputSettings(roles=ROLES).packed()


def test_other_versions_are_refused(machine: Machine) -> None:
    for version in (0, 1, 4, 255):
        assert machine.refused(p.HELLO, bytes([version])) == (p.VERSION, 3)


def test_settings_are_kept_with_their_inputs(driver: Driver, machine: Machine) -> None:
    machine.ok(p.COMMIT)
    machine.run(WHOLE_COMMIT)
    driver.ask("begin")
    machine = Machine(driver)
    machine.ok(p.HELLO, b"\3")
    assert machine.settings() == Settings().packed() + InputSettings(roles=ROLES).packed()
    assert machine.read() == RAMP.image()


def test_what_a_controller_without_inputs_has_kept_is_found(driver: Driver) -> None:
    """A program with inputs takes the place of one without."""
    with Driver() as older:
        older.ask("begin")
        controller = Controller(older)
        controller.hello()
        controller.ok(p.WRITE_SETTINGS, Settings(enable_lead_ms=77).packed())
        controller.push(RAMP)
        kept = older.ask("eeprom")
    driver.ask("eeprom", kept)
    driver.ask("begin")
    machine = Machine(driver)
    machine.ok(p.HELLO, b"\3")
    assert machine.settings() == Settings(enable_lead_ms=77).packed() + InputSettings().packed()
    assert machine.read() == RAMP.image()
    assert machine.status().sequence == 1
    # What is stored next goes to the other slot, and both are read.
    machine.low = set()
    machine.give()
    machine.ok(p.COMMIT)
    machine.run(WHOLE_COMMIT)
    assert machine.read(p.PREVIOUS) == RAMP.image()
    slots = bytes.fromhex(driver.ask("eeprom"))
    assert (slots[1], slots[SLOT_BYTES + 1]) == (2, 4)
    machine.ok(p.ROLL_BACK)
    machine.run(WHOLE_COMMIT)
    assert machine.settings() == Settings(enable_lead_ms=77).packed() + InputSettings().packed()
    assert machine.read() == RAMP.image()
