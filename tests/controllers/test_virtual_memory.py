import pytest

from stepramp.controllers.virtual_memory import WRITE_TIME_S, VirtualMemory

OLD, NEW = b"the old ramp", b"the new ramp, a longer one"


def written(image: bytes, into: VirtualMemory) -> VirtualMemory:
    into.begin_write(image, 0.0)
    into.settle(60.0)
    assert not into.writing
    return into


def test_nothing_is_stored_at_first() -> None:
    assert VirtualMemory().active() == (0, b"")


def test_each_image_goes_to_the_other_slot_and_counts_up() -> None:
    memory = VirtualMemory()
    for sequence in range(1, 6):
        image = bytes([sequence]) * 500
        assert written(image, memory).active() == (sequence, image)
    assert bytes([4]) * 500 in bytes(memory.cells)


def test_a_changed_byte_takes_its_time_and_an_equal_one_none() -> None:
    memory = written(OLD, written(OLD, VirtualMemory()))
    memory.begin_write(OLD, 0.0)
    memory.settle(WRITE_TIME_S * 10)
    assert not memory.writing
    memory.begin_write(NEW, 1.0)
    memory.settle(1.0 + WRITE_TIME_S * 10)
    assert memory.writing


@pytest.mark.parametrize("bytes_written", range(42))
def test_a_power_cut_leaves_the_old_ramp_or_the_new_one(bytes_written: int) -> None:
    memory = written(OLD, VirtualMemory())
    memory.begin_write(NEW, 0.0)
    memory.settle(WRITE_TIME_S * bytes_written)
    memory.cut_power()
    assert memory.active() in ((1, OLD), (2, NEW))
    assert written(NEW, memory).active()[1] == NEW


@pytest.mark.parametrize("place", [0, 1, 2, 4, 8, 10, 11, 12, 20])
def test_a_flipped_bit_makes_a_slot_invalid(place: int) -> None:
    memory = written(NEW, written(OLD, VirtualMemory()))
    memory.cells[512 + place] ^= 1
    assert memory.active() == (1, OLD)
