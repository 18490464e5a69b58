"""controller.c and slots.c through frames, with EEPROM made of variables."""

import struct
from collections.abc import Iterator
from pathlib import Path

import pytest

from firmware import protocol as p
from firmware.host import Host
from firmware.protocol import Ramp, decode_frame, encode_frame

RAMP = Ramp([(20_000, 1, 0), (14_142, 2, -2595), (10_000, 300, -20)], 2000, [(20_000, 2, -5858), (11_547, 40, -200)])
OTHER = Ramp([(5000, 60, -30)], 3000, [(5000, 60, -30)])
OLDER = Ramp([(9000, 7, -11), (7000, 9, -300)], 1234, [(8000, 5, -7)])
SESSION = 0xBEEF


class Controller:
    """Frames to a controller on this machine."""

    def __init__(self, host: Host) -> None:
        self.host = host
        self.tag = 0

    def send(self, kind: int, body: bytes = b"", *, session: int = SESSION, tag: int | None = None) -> bytes:
        """Send a request; return the reply's status and body."""
        if tag is None:
            self.tag = tag = (self.tag + 1) & 0xFF
        frame = encode_frame(struct.pack("<BHB", kind, session, tag) + body)
        reply = decode_frame(bytes.fromhex(self.host.ask("serial", frame.hex())))
        assert reply[:4] == struct.pack("<BHB", kind | 0x80, session, tag)
        return reply[4:]

    def ok(self, kind: int, body: bytes = b"") -> bytes:
        reply = self.send(kind, body)
        assert reply[0] == p.OK, reply.hex()
        return reply[1:]

    def refused(self, kind: int, body: bytes = b"", **options: int) -> tuple[int, int]:
        """Return status and detail."""
        return struct.unpack("<BH", self.send(kind, body, **options))

    def stage(self, image: bytes) -> None:
        self.ok(p.BEGIN, struct.pack("<HH", len(image), p.crc16(image)))
        for offset in range(0, len(image), 48):
            reply = self.ok(p.DATA, struct.pack("<H", offset) + image[offset : offset + 48])
            assert reply == struct.pack("<H", offset + len(image[offset : offset + 48]))

    def push(self, ramp: Ramp) -> None:
        self.stage(ramp.image())
        assert self.ok(p.END) == bytes([len(ramp.up), len(ramp.down)])
        self.ok(p.COMMIT)
        self.host.ask("poll", 10_000)

    def status(self) -> p.Status:
        return p.Status(*struct.unpack("<BiiIIIHB", self.ok(p.STATUS)))

    def stored(self) -> bytes:
        data = b""
        while part := self.ok(p.READ, struct.pack("<BHB", 0, len(data), 48))[2:]:
            data += part
        return data


@pytest.fixture
def controller(host_program: Path) -> Iterator[Controller]:
    with Host(host_program) as host:
        host.ask("begin")
        controller = Controller(host)
        controller.ok(p.HELLO, b"\1")
        yield controller


def test_hello_tells_the_limits(controller: Controller) -> None:
    body = struct.pack("<BBBBIIIHHBIH", 1, 0, 1, 0, 2_000_000, 40, 16_777_215, 500, 120, 1, 0, 0)
    assert controller.ok(p.HELLO, b"\1") == body


def test_hello_refuses_other_versions_and_no_session(controller: Controller) -> None:
    assert controller.refused(p.HELLO, b"\2") == (p.VERSION, 1)
    assert controller.refused(p.HELLO, b"\1", session=0) == (p.OUT_OF_RANGE, 0)
    assert controller.status().state == p.IDLE


def test_requests_of_another_session_are_stale(controller: Controller) -> None:
    assert controller.refused(p.STATUS, session=SESSION + 1) == (p.STALE, 0)
    assert controller.refused(p.MOVE_BY, struct.pack("<i", 5), session=0) == (p.STALE, 0)


def test_before_a_hello_all_is_stale(host_program: Path) -> None:
    with Host(host_program) as host:
        host.ask("begin")
        assert Controller(host).refused(p.STATUS, session=0) == (p.STALE, 0)


def test_unknown_kinds_and_bad_lengths(controller: Controller) -> None:
    for kind in (0, 3, 0x15, 0x22, 0x32, 0x7F):
        assert controller.refused(kind) == (p.UNKNOWN_KIND, kind)
    lengths = {p.HELLO: 0, p.STATUS: 1, p.BEGIN: 3, p.DATA: 2, p.END: 1, p.COMMIT: 1, p.READ: 3, p.MOVE_BY: 5}
    for kind, length in (lengths | {p.MOVE_TO: 3, p.STOP: 1, p.HALT: 2}).items():
        assert controller.refused(kind, bytes(length)) == (p.BAD_LENGTH, length)
    assert controller.refused(p.DATA, bytes(51)) == (p.BAD_LENGTH, 51)


def test_a_repeat_gets_the_same_reply_and_does_nothing(controller: Controller) -> None:
    controller.push(RAMP)
    first = controller.send(p.MOVE_BY, struct.pack("<i", 7), tag=77)
    assert first == b"\0" + struct.pack("<i", 7)
    assert controller.send(p.MOVE_BY, struct.pack("<i", 7), tag=77) == first
    assert controller.refused(p.MOVE_BY, struct.pack("<i", 7), tag=78) == (p.MOVING, 0)


def test_a_second_hello_with_the_same_tag_is_no_repeat(controller: Controller) -> None:
    assert controller.send(p.HELLO, b"\1", tag=0)[0] == p.OK
    assert controller.refused(p.HELLO, b"\2", tag=0) == (p.VERSION, 1)


def test_staging_is_refused_out_of_order(controller: Controller) -> None:
    image = RAMP.image()
    assert controller.refused(p.DATA, b"\0\0x") == (p.OUT_OF_ORDER, 0)
    assert controller.refused(p.END) == (p.OUT_OF_ORDER, 0)
    assert controller.refused(p.COMMIT) == (p.OUT_OF_ORDER, 0)
    assert controller.refused(p.BEGIN, struct.pack("<HH", 501, 0)) == (p.OUT_OF_RANGE, 500)
    controller.ok(p.BEGIN, struct.pack("<HH", len(image), p.crc16(image)))
    controller.ok(p.DATA, b"\0\0" + image[:10])
    assert controller.refused(p.DATA, b"\0\0" + image[:10]) == (p.OUT_OF_ORDER, 10)
    assert controller.refused(p.DATA, b"\x0a\0" + image[10:] + b"x") == (p.OUT_OF_RANGE, len(image))
    assert controller.refused(p.END) == (p.OUT_OF_ORDER, 10)
    controller.ok(p.DATA, b"\x0a\0" + image[10:])
    assert controller.refused(p.COMMIT) == (p.OUT_OF_ORDER, len(image))
    assert controller.ok(p.END) == bytes([3, 2])


def test_a_bad_crc_and_a_bad_ramp_are_refused(controller: Controller) -> None:
    image = RAMP.image()
    controller.ok(p.BEGIN, struct.pack("<HH", len(image), 0))
    controller.ok(p.DATA, b"\0\0" + image)
    assert controller.refused(p.END) == (p.BAD_CRC, p.crc16(image))
    controller.stage(Ramp([(100, 1, 0), (39, 1, 0)], 100, []).image())
    assert controller.refused(p.END) == (p.BAD_RAMP, 1)
    controller.stage(b"\2" + image[1:])
    assert controller.refused(p.END) == (p.BAD_RAMP, 0xFFFF)
    assert controller.refused(p.COMMIT)[0] == p.OUT_OF_ORDER


def test_reading_back_what_was_staged(controller: Controller) -> None:
    image = RAMP.image()
    controller.stage(image)
    assert controller.ok(p.READ, struct.pack("<BHB", 1, 0, 48)) == struct.pack("<H", len(image)) + image
    assert controller.ok(p.READ, struct.pack("<BHB", 1, 30, 48)) == struct.pack("<H", len(image)) + image[30:]
    assert controller.ok(p.READ, struct.pack("<BHB", 1, len(image), 1)) == struct.pack("<H", len(image))
    assert controller.ok(p.READ, struct.pack("<BHB", 0, 0, 48)) == b"\0\0"
    assert controller.refused(p.READ, struct.pack("<BHB", 2, 0, 48)) == (p.OUT_OF_RANGE, 2)
    assert controller.refused(p.READ, struct.pack("<BHB", 0, 0, 0)) == (p.OUT_OF_RANGE, 0)
    assert controller.refused(p.READ, struct.pack("<BHB", 0, 0, 49)) == (p.OUT_OF_RANGE, 49)


def test_while_writing_what_would_disturb_is_refused(controller: Controller) -> None:
    controller.stage(RAMP.image())
    controller.ok(p.END)
    controller.ok(p.COMMIT)
    assert controller.status().state == p.WRITING
    for kind, length in {p.BEGIN: 4, p.DATA: 3, p.END: 0, p.COMMIT: 0, p.MOVE_BY: 4, p.MOVE_TO: 4}.items():
        assert controller.refused(kind, bytes(length)) == (p.BUSY, 0)
    controller.ok(p.STOP)
    controller.ok(p.HALT)
    controller.host.ask("poll", 10_000)
    assert controller.status().state == p.IDLE
    assert controller.stored() == RAMP.image()


def test_moves_are_refused_without_a_ramp_and_outside_32_bits(controller: Controller) -> None:
    assert controller.refused(p.MOVE_BY, struct.pack("<i", 1)) == (p.NO_RAMP, 0)
    assert controller.refused(p.MOVE_TO, struct.pack("<i", 1)) == (p.NO_RAMP, 0)
    controller.push(RAMP)
    assert controller.status().state == p.IDLE
    assert controller.refused(p.MOVE_BY, struct.pack("<i", 0)) == (p.OUT_OF_RANGE, 0)
    assert controller.ok(p.MOVE_TO, struct.pack("<i", 0)) == struct.pack("<i", 0)
    assert controller.status().state == p.IDLE


@pytest.mark.parametrize("target", [-(2**31), 2**31 - 1])
def test_the_farthest_targets(controller: Controller, target: int) -> None:
    controller.push(RAMP)
    assert controller.ok(p.MOVE_TO, struct.pack("<i", target)) == struct.pack("<i", target)
    status = controller.status()
    assert (status.state, status.position, status.target) == (p.IN_MOTION, 0, target)
    controller.ok(p.HALT)
    assert controller.ok(p.MOVE_BY, struct.pack("<i", target)) == struct.pack("<i", target)


def test_a_target_beyond_32_bits_is_refused(controller: Controller) -> None:
    controller.push(Ramp([], 100, []))
    controller.ok(p.MOVE_BY, struct.pack("<i", 1))
    controller.ok(p.HALT)
    assert controller.status().position == 0
    assert controller.refused(p.MOVE_BY, struct.pack("<i", 0)) == (p.OUT_OF_RANGE, 0)


def test_while_moving_what_would_disturb_is_refused(controller: Controller) -> None:
    controller.push(RAMP)
    controller.ok(p.MOVE_BY, struct.pack("<i", 100))
    for kind, length in {p.BEGIN: 4, p.DATA: 3, p.END: 0, p.COMMIT: 0, p.MOVE_BY: 4, p.MOVE_TO: 4}.items():
        assert controller.refused(kind, bytes(length)) == (p.MOVING, 0)
    assert controller.stored() == RAMP.image()


def test_the_newer_ramp_is_found_at_start(host_program: Path) -> None:
    with Host(host_program) as host:
        host.ask("begin")
        controller = Controller(host)
        controller.ok(p.HELLO, b"\1")
        for sequence, ramp in enumerate([RAMP, OTHER, RAMP, OTHER, OTHER], 1):
            controller.push(ramp)
            host.ask("begin")
            status = controller.status()
            assert (status.sequence, status.crc) == (sequence, p.crc16(ramp.image()))
            assert controller.stored() == ramp.image()


def test_a_ramp_that_is_whole_but_wrong_is_not_loaded(host_program: Path) -> None:
    """Its CRC and header are good; the newer slot holds no ramp, so the older one is used."""
    with Host(host_program) as host:
        bad = b"\2" + OTHER.image()[1:]
        host.ask("eeprom", (slot(1, RAMP.image()) + slot(9, bad)).hex())
        host.ask("begin")
        controller = Controller(host)
        assert struct.unpack("<IH", controller.ok(p.HELLO, b"\1")[-6:]) == (1, p.crc16(RAMP.image()))
        assert controller.stored() == RAMP.image()


def slot(sequence: int, image: bytes) -> bytes:
    header = struct.pack("<BBHIH", 0x53, 1, len(image), sequence, p.crc16(image))
    return (header + struct.pack("<H", p.crc16(header)) + image).ljust(512, b"\xff")


def test_slots_lie_in_eeprom_as_documented(controller: Controller) -> None:
    controller.push(RAMP)
    controller.push(OTHER)
    assert controller.host.ask("eeprom") == (slot(1, RAMP.image()) + slot(2, OTHER.image())).hex()


def test_bytes_that_are_there_already_are_not_written(controller: Controller) -> None:
    controller.push(RAMP)
    controller.push(RAMP)
    before = int(controller.host.ask("writes"))
    controller.push(RAMP)
    changed = {i for i, (a, b) in enumerate(zip(slot(1, RAMP.image()), slot(3, RAMP.image()), strict=True)) if a != b}
    assert int(controller.host.ask("writes")) - before == len(changed | {0}) + 1


def test_a_power_cut_at_any_write_leaves_the_old_ramp_or_the_new_one(host_program: Path) -> None:
    """Both ways: into a slot that holds an older ramp, and into an empty one."""
    for kept in (slot(1, RAMP.image()), slot(4, OLDER.image()) + slot(5, RAMP.image())):
        with Host(host_program) as host:
            outcomes = [after_power_cut(host, kept, cut) for cut in range(1, 100)]
        sequence = 5 if len(kept) > 512 else 1
        old, new = (sequence, RAMP.image()), (sequence + 1, OTHER.image())
        first_new = outcomes.index(new)
        assert outcomes[:first_new] == [old] * first_new
        assert outcomes[first_new:] == [new] * (len(outcomes) - first_new)
        assert first_new >= 10


def after_power_cut(host: Host, kept: bytes, cut: int) -> tuple[int, bytes]:
    """Push a ramp, lose power in the middle of a write, start again; return the sequence number and the image."""
    host.ask("eeprom", kept.hex())
    host.ask("begin")
    controller = Controller(host)
    controller.ok(p.HELLO, b"\1")
    host.ask("cut", cut)
    controller.push(OTHER)
    host.ask("eeprom", host.ask("eeprom"))
    host.ask("begin")
    (sequence,) = struct.unpack("<I", controller.ok(p.HELLO, b"\1")[-6:-2])
    return sequence, controller.stored()


def test_a_write_that_fails_keeps_the_ramp(controller: Controller) -> None:
    controller.push(RAMP)
    writes = int(controller.host.ask("writes"))
    controller.host.ask("cut", writes + 20)
    controller.push(OTHER)
    status = controller.status()
    assert (status.state, status.write_failed, status.sequence) == (p.IDLE, 1, 1)
    assert controller.stored() == RAMP.image()
    controller.host.ask("cut", 0)
    controller.push(OTHER)
    assert (controller.status().write_failed, controller.stored()) == (0, OTHER.image())
