from firmware import protocol as p
from firmware.controller.client import WHOLE_COMMIT, Controller, started
from firmware.controller.ramps import OTHER, RAMP
from firmware.controller_host import Driver
from firmware.protocol import Settings, for_axes


def test_settings_are_used_stored_and_rolled_back(driver: Driver) -> None:
    controller = started(driver)
    assert controller.settings() == Settings().packed()
    controller.push(RAMP)
    changed = Settings(both_edges=3, enable_lead_ms=500).packed()
    controller.ok(p.WRITE_SETTINGS, changed)
    assert (controller.settings(), controller.status().flags & p.ON_TRIAL) == (changed, p.ON_TRIAL)
    assert controller.hello().in_use == p.STORED_IN_USE
    controller.ok(p.ROLL_BACK)
    assert (controller.settings(), controller.status().flags & p.ON_TRIAL) == (Settings().packed(), 0)
    controller.ok(p.WRITE_SETTINGS, changed)
    controller.ok(p.COMMIT)
    controller.run(WHOLE_COMMIT)
    controller = started(driver)
    assert (controller.settings(), controller.read(), controller.status().sequence) == (changed, RAMP.image(), 2)
    assert controller.status().flags & p.ON_TRIAL == 0


def test_settings_stay_on_trial_through_a_delivery_that_is_dropped(controller: Controller) -> None:
    controller.push(RAMP)
    changed = Settings(direction_inverted=1).packed()
    controller.deliver(OTHER.image())
    controller.ok(p.WRITE_SETTINGS, changed)
    controller.ok(p.MOVE_BY, for_axes({0: 1}))
    assert controller.settings() == changed


def test_bad_settings_are_refused(controller: Controller) -> None:
    for bad, detail in [
        (Settings(outputs=2), 0),
        (Settings(direction_inverted=16), 3),
        (Settings(direction_setup_us=19), 6),
        (Settings(enable_lead_ms=1001), 8),
    ]:
        assert controller.refused(p.WRITE_SETTINGS, bad.packed()) == (p.OUT_OF_RANGE, detail)
    assert controller.settings() == Settings().packed()
    assert controller.status().flags == 0
