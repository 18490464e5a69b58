import struct

from firmware import protocol as p
from firmware.controller.client import WHOLE_COMMIT, Controller, started
from firmware.controller.ramps import FOUR_AXES, OTHER, RAMP
from firmware.controller_host import Driver
from firmware.protocol import Settings, for_axes


def test_a_ramp_on_trial(controller: Controller) -> None:
    controller.push(RAMP)
    controller.check(FOUR_AXES)
    controller.ok(p.TRY)
    hello, status = controller.hello(), controller.status()
    assert (hello.sequence, hello.crc, hello.in_use) == (1, p.crc16(FOUR_AXES), p.TRIAL_IN_USE)
    assert (status.sequence, status.crc, status.flags & p.ON_TRIAL) == (1, p.crc16(FOUR_AXES), p.ON_TRIAL)
    assert (controller.read(p.STORED), controller.read(p.RAM)) == (RAMP.image(), FOUR_AXES)
    controller.ok(p.MOVE_BY, for_axes({0: 5, 3: -9}))
    controller.run_until_idle()
    assert controller.steps() == [5, 0, 0, -9]
    controller.ok(p.ROLL_BACK)
    hello = controller.hello()
    assert (hello.sequence, hello.crc, hello.in_use) == (1, p.crc16(RAMP.image()), p.STORED_IN_USE)
    assert controller.status().flags & p.ON_TRIAL == 0
    assert controller.refused(p.MOVE_BY, for_axes({3: 1})) == (p.OUT_OF_RANGE, 8)
    assert [controller.status(axis).position for axis in range(4)] == [5, 0, 0, -9]


def test_a_ramp_on_trial_is_forgotten_without_power_and_by_a_new_delivery(driver: Driver) -> None:
    controller = started(driver)
    controller.push(RAMP)
    controller.check(OTHER.image())
    controller.ok(p.TRY)
    controller.ok(p.BEGIN, struct.pack("<HH", 10, 0))
    assert (controller.hello().crc, controller.hello().in_use) == (p.crc16(RAMP.image()), p.STORED_IN_USE)
    controller.check(OTHER.image())
    controller.ok(p.TRY)
    controller = started(driver)
    assert controller.hello().crc == p.crc16(RAMP.image())


def test_a_ramp_on_trial_can_be_stored(controller: Controller) -> None:
    controller.check(OTHER.image())
    controller.ok(p.TRY)
    assert controller.hello().sequence == 0
    controller.ok(p.COMMIT)
    controller.run(WHOLE_COMMIT)
    assert (controller.hello().sequence, controller.hello().in_use) == (1, p.STORED_IN_USE)
    assert controller.read() == OTHER.image()


def test_rolling_back_a_trial_with_nothing_stored(controller: Controller) -> None:
    controller.check(RAMP.image())
    controller.ok(p.TRY)
    controller.ok(p.WRITE_SETTINGS, Settings(pulse_width_us=9).packed())
    controller.ok(p.ROLL_BACK)
    assert (controller.hello().in_use, controller.settings()) == (p.NO_RAMP_IN_USE, Settings().packed())
    assert controller.refused(p.ROLL_BACK) == (p.NO_RAMP, 0)
    assert controller.refused(p.MOVE_BY, for_axes({0: 1})) == (p.NO_RAMP, 0)


def test_rolling_back_to_the_previous_ramp_and_its_settings(driver: Driver) -> None:
    controller = started(driver)
    controller.push(RAMP)
    assert controller.refused(p.ROLL_BACK) == (p.NO_RAMP, 0)
    controller.ok(p.WRITE_SETTINGS, Settings(pulse_width_us=5).packed())
    controller.push(OTHER)
    assert controller.read(p.PREVIOUS) == RAMP.image()
    for sequence, ramp, width in [(3, RAMP, 0), (4, OTHER, 5), (5, RAMP, 0)]:
        controller.ok(p.ROLL_BACK)
        assert controller.status().state == p.WRITING
        assert controller.refused(p.MOVE_BY, for_axes({0: 1})) == (p.BUSY, 0)
        controller.run(WHOLE_COMMIT)
        for _ in range(2):
            assert (controller.read(), controller.read(p.RAM)) == (ramp.image(), ramp.image())
            assert controller.settings() == Settings(pulse_width_us=width).packed()
            assert (controller.status().sequence, controller.status().flags & ~p.ENABLED) == (sequence, 0)
            controller = started(driver)
    assert controller.read(p.PREVIOUS) == OTHER.image()
    controller.ok(p.MOVE_BY, for_axes({0: 3}))


def test_rolling_back_drops_a_delivery_first(controller: Controller) -> None:
    controller.push(RAMP)
    controller.push(OTHER)
    controller.deliver(RAMP.image())
    controller.ok(p.ROLL_BACK)
    assert (controller.status().state, controller.read(p.RAM)) == (p.IDLE, OTHER.image())
    controller.ok(p.ROLL_BACK)
    controller.run(WHOLE_COMMIT)
    assert controller.read() == RAMP.image()
