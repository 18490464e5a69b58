import struct

from firmware import protocol as p
from firmware.controller.client import Controller
from firmware.controller.ramps import OTHER, RAMP
from firmware.protocol import Ramp, for_axes


def test_delivery_is_refused_out_of_order(controller: Controller) -> None:
    image = RAMP.image()
    assert controller.refused(p.DATA, b"\0\0x") == (p.OUT_OF_ORDER, 0)
    for kind in (p.END, p.TRY, p.COMMIT):
        assert controller.refused(kind) == (p.OUT_OF_ORDER, 0)
    assert controller.refused(p.BEGIN, struct.pack("<HH", 441, 0)) == (p.OUT_OF_RANGE, 440)
    controller.ok(p.BEGIN, struct.pack("<HH", len(image), p.crc16(image)))
    controller.ok(p.DATA, b"\0\0" + image[:10])
    assert controller.refused(p.DATA, b"\0\0" + image[:10]) == (p.OUT_OF_ORDER, 10)
    assert controller.refused(p.DATA, b"\x0a\0" + image[10:] + b"x") == (p.OUT_OF_RANGE, len(image))
    for kind in (p.END, p.TRY, p.COMMIT):
        assert controller.refused(kind) == (p.OUT_OF_ORDER, 10)
    controller.ok(p.DATA, b"\x0a\0" + image[10:])
    for kind in (p.TRY, p.COMMIT):
        assert controller.refused(kind) == (p.OUT_OF_ORDER, len(image))
    assert controller.ok(p.END) == controller.ok(p.END) == bytes([1, 1])
    controller.ok(p.TRY)
    for kind in (p.END, p.TRY):
        assert controller.refused(kind) == (p.OUT_OF_ORDER, 0)
    assert controller.refused(p.DATA, struct.pack("<HB", len(image), 0)) == (p.OUT_OF_ORDER, 0)


def test_end_tells_axes_and_ramps(controller: Controller) -> None:
    controller.deliver(p.image_of([RAMP.packed(), OTHER.packed()], [1, 0, 1]))
    assert controller.ok(p.END) == bytes([3, 2])


def test_a_bad_crc_is_refused(controller: Controller) -> None:
    image = RAMP.image()
    controller.ok(p.BEGIN, struct.pack("<HH", len(image), 0))
    for part in p.image_parts(image):
        controller.ok(p.DATA, part)
    assert controller.refused(p.END) == (p.BAD_CRC, p.crc16(image))
    assert controller.refused(p.COMMIT)[0] == p.OUT_OF_ORDER


def test_bad_ramps_are_refused(controller: Controller) -> None:
    too_fast = Ramp([(100, 1, 0), (13, 1, 0)], 100, []).packed()
    for image, ramp, segment in [
        (p.image_of([RAMP.packed(), too_fast], [0, 1]), 1, 1),
        (p.image_of([too_fast]), 0, 1),
        (p.image_of([p.with_header(0, b"")]), 0, 255),
        (p.image_of([p.with_header(7, b"")]), 0, 255),
        (b"\1" + RAMP.image()[1:], 255, 255),
        (RAMP.image() + b"\0", 255, 255),
        (p.image_of([RAMP.packed(), RAMP.packed()], [0, 0]), 255, 255),
        (b"", 255, 255),
    ]:
        controller.deliver(image)
        assert controller.refused(p.END) == (p.BAD_RAMP, ramp << 8 | segment)
        for kind in (p.COMMIT, p.TRY):
            assert controller.refused(kind) == (p.OUT_OF_ORDER, len(image))


def test_reading_what_is_in_ram(controller: Controller) -> None:
    image = RAMP.image()
    length = struct.pack("<H", len(image))
    assert controller.ok(p.READ, struct.pack("<BHB", p.RAM, 0, 48)) == b"\0\0"
    controller.deliver(image)
    assert controller.ok(p.READ, struct.pack("<BHB", p.RAM, 0, 48)) == length + image[:48]
    assert controller.ok(p.READ, struct.pack("<BHB", p.RAM, 30, 48)) == length + image[30:78]
    assert controller.ok(p.READ, struct.pack("<BHB", p.RAM, len(image), 1)) == length
    assert controller.ok(p.READ, struct.pack("<BHB", p.RAM, 65_535, 48)) == length
    for source in (p.STORED, p.PREVIOUS):
        assert controller.ok(p.READ, struct.pack("<BHB", source, 0, 48)) == b"\0\0"
    assert controller.refused(p.READ, struct.pack("<BHB", 3, 0, 48)) == (p.OUT_OF_RANGE, 3)
    assert controller.refused(p.READ, struct.pack("<BHB", 0, 0, 0)) == (p.OUT_OF_RANGE, 0)
    assert controller.refused(p.READ, struct.pack("<BHB", 0, 0, 49)) == (p.OUT_OF_RANGE, 49)


def test_a_move_drops_what_was_delivered(controller: Controller) -> None:
    controller.push(RAMP)
    controller.check(OTHER.image())
    assert (controller.read(p.RAM), controller.status().crc) == (OTHER.image(), p.crc16(RAMP.image()))
    controller.ok(p.MOVE_BY, for_axes({0: 3}))
    controller.run_until_idle()
    assert controller.read(p.RAM) == RAMP.image()
    assert controller.refused(p.TRY) == (p.OUT_OF_ORDER, 0)
    assert (controller.status().position, controller.steps()[0]) == (3, 3)


def test_without_a_stored_ramp_a_delivery_is_not_dropped(controller: Controller) -> None:
    controller.check(RAMP.image())
    assert controller.refused(p.MOVE_BY, for_axes({0: 3})) == (p.NO_RAMP, 0)
    controller.ok(p.TRY)
    controller.ok(p.MOVE_BY, for_axes({0: 3}))
