import pytest

from stepramp.controllers.stepramp.frames import crc16
from stepramp.controllers.stepramp.settings import StepRampSettings
from stepramp.controllers.virtual.memory import LARGEST_IMAGE_BYTES, WRITE_TIME_S, Slot, VirtualMemory

OLD, NEW = b"the old ramp", b"the new ramp, a longer one"
SETTINGS = StepRampSettings().pack()
OTHER = StepRampSettings(pulse_width_us=9).pack()


def written(image: bytes, into: VirtualMemory, settings: bytes = SETTINGS) -> VirtualMemory:
    into.begin_write(settings, image, 0.0)
    into.settle(60.0)
    assert not into.writing
    return into


def test_nothing_is_stored_at_first() -> None:
    assert VirtualMemory().active() == VirtualMemory().previous() == Slot(0, b"", b"")


def test_the_largest_image_leaves_room_for_header_and_settings() -> None:
    assert LARGEST_IMAGE_BYTES == 440


def test_a_slot_byte_by_byte() -> None:
    memory = written(b"xyz", VirtualMemory(), OTHER)
    content = OTHER + b"xyz"
    fields = b"\x53\x02" + len(content).to_bytes(2, "little") + b"\1\0\0\0" + crc16(content).to_bytes(2, "little")
    assert bytes(memory.cells[: 12 + len(content)]) == fields + crc16(fields).to_bytes(2, "little") + content


def test_each_image_goes_to_the_other_slot_and_counts_up() -> None:
    memory = VirtualMemory()
    for sequence in range(1, 6):
        image = bytes([sequence]) * 440
        assert written(image, memory, OTHER).active() == Slot(sequence, OTHER, image)
    assert memory.previous() == Slot(4, OTHER, bytes([4]) * 440)


def test_the_previous_content_comes_back_by_its_header_alone() -> None:
    memory = written(NEW, written(OLD, VirtualMemory(), OTHER))
    before = bytes(memory.cells)
    memory.begin_restore(0.0)
    memory.settle(13 * WRITE_TIME_S)
    assert memory.active() == Slot(3, OTHER, OLD)
    assert memory.previous() == Slot(2, SETTINGS, NEW)
    changed = [place for place, (old, new) in enumerate(zip(before, memory.cells, strict=True)) if old != new]
    assert set(changed) <= set(range(12))


def test_a_changed_byte_takes_its_time_and_an_equal_one_none() -> None:
    memory = written(OLD, written(OLD, VirtualMemory()))
    memory.begin_write(SETTINGS, OLD, 0.0)
    memory.settle(WRITE_TIME_S * 10)
    assert not memory.writing
    memory.begin_write(SETTINGS, NEW, 1.0)
    memory.settle(1.0 + WRITE_TIME_S * 10)
    assert memory.writing


@pytest.mark.parametrize("bytes_written", range(54))
def test_a_power_cut_leaves_the_old_content_or_the_new_one(bytes_written: int) -> None:
    memory = written(OLD, VirtualMemory())
    memory.begin_write(OTHER, NEW, 0.0)
    memory.settle(WRITE_TIME_S * bytes_written)
    memory.cut_power()
    assert memory.active() in (Slot(1, SETTINGS, OLD), Slot(2, OTHER, NEW))
    assert written(NEW, memory).active().image == NEW


@pytest.mark.parametrize("bytes_written", range(14))
def test_a_power_cut_in_a_restore_leaves_one_or_the_other(bytes_written: int) -> None:
    memory = written(NEW, written(OLD, VirtualMemory()))
    memory.begin_restore(0.0)
    memory.settle(WRITE_TIME_S * bytes_written)
    memory.cut_power()
    assert memory.active() in (Slot(2, SETTINGS, NEW), Slot(3, SETTINGS, OLD))
    assert {memory.active().image, memory.previous().image} == {OLD, NEW}, "neither is lost"
    memory.begin_restore(9.0)
    memory.settle(60.0)
    assert memory.active().sequence in (3, 4)


@pytest.mark.parametrize("place", [0, 1, 2, 4, 8, 10, 11, 12, 20, 30])
def test_a_flipped_bit_makes_the_other_slot_active(place: int) -> None:
    memory = written(NEW, written(OLD, VirtualMemory()))
    memory.cells[512 + place] ^= 1
    assert memory.active() == Slot(1, SETTINGS, OLD)


def test_a_slot_with_a_damaged_number_is_the_older_one() -> None:
    memory = written(NEW, written(OLD, VirtualMemory()))
    memory.cells[512 + 4] ^= 8
    assert memory.previous() == Slot(0, SETTINGS, NEW)
