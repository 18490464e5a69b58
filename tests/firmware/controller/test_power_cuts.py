import pytest

from firmware import protocol as p
from firmware.controller.client import WHOLE_COMMIT, started
from firmware.controller.ramps import OLDER, OTHER, RAMP
from firmware.controller.slots import slot
from firmware.controller_host import Driver
from firmware.protocol import Settings

KEPT = {
    "one ramp": slot(1, RAMP.image()),
    "two ramps": slot(4, OLDER.image()) + slot(5, RAMP.image()),
}
CUT_LEAVES = (0xFF, 0x00, 0x53, 0xA5, -1)
"""What a power cut leaves of the byte that is being written; -1: what was there."""


@pytest.mark.parametrize("kept", KEPT)
@pytest.mark.parametrize("left", CUT_LEAVES)
def test_a_power_cut_at_any_write_of_a_commit(driver: Driver, kept: str, left: int) -> None:
    """Leaves the old ramp with its settings, or the new one with its own."""
    sequence = 5 if len(KEPT[kept]) > 512 else 1
    old = (sequence, RAMP.image(), Settings().packed())
    changed = Settings(pulse_width_us=8).packed()
    outcomes = []
    for cut in range(1, 200):
        driver.ask("eeprom", KEPT[kept].hex())
        controller = started(driver)
        controller.ok(p.WRITE_SETTINGS, changed)
        driver.ask("cut", cut, left)
        controller.push(OTHER)
        after, is_done = after_power_cut(driver, cut)
        outcomes.append(after)
        if is_done:
            break
    new = (sequence + 1, OTHER.image(), changed)
    count_old = outcomes.index(new)
    assert outcomes[:count_old] == [old] * count_old
    assert outcomes[count_old:] == [new] * (len(outcomes) - count_old)
    assert len(outcomes) >= 20
    assert len(outcomes) - count_old <= 2


@pytest.mark.parametrize("left", CUT_LEAVES)
def test_a_power_cut_at_any_write_of_a_roll_back(driver: Driver, left: int) -> None:
    """Leaves the one ramp or the other, and the other one can still be rolled back to. Sequence numbers whose bytes are
    written one by one may come out mixed; they only have to tell which one is newer."""
    outcomes = set()
    for old_sequence in (1, 254, 255, 256, 65_535, 2**24 - 1):
        for cut in range(1, 20):
            kept = slot(old_sequence, OLDER.image(), Settings(0, 1)) + slot(old_sequence + 1, RAMP.image())
            driver.ask("eeprom", kept.hex())
            controller = started(driver)
            driver.ask("cut", cut, left)
            controller.ok(p.ROLL_BACK)
            controller.run(WHOLE_COMMIT)
            (_, image, settings), is_done = after_power_cut(driver, cut)
            outcomes.add((image, settings))
            assert image == OLDER.image() or not is_done
            other = started(driver)
            assert {image, other.read(p.PREVIOUS)} == {RAMP.image(), OLDER.image()}
            other.ok(p.ROLL_BACK)
            other.run(WHOLE_COMMIT)
            assert {image, other.read()} == {RAMP.image(), OLDER.image()}
            if is_done:
                break
        assert is_done
    assert outcomes == {(OLDER.image(), Settings(0, 1).packed()), (RAMP.image(), Settings().packed())}


def after_power_cut(driver: Driver, cut: int) -> tuple[tuple[int, bytes, bytes], bool]:
    """Switch on again; return sequence number, image and settings, and whether all was written before the cut."""
    is_done = int(driver.ask("writes")) < cut
    driver.ask("eeprom", driver.ask("eeprom"))
    controller = started(driver)
    return (controller.hello().sequence, controller.read(), controller.settings()), is_done
