import struct

from firmware import protocol as p
from firmware.controller.client import WHOLE_COMMIT, Controller
from firmware.controller.lengths import CHANGES, FOR_AXES
from firmware.controller.ramps import OTHER, RAMP, TWO_AXES
from firmware.protocol import Settings, for_axes


def test_while_writing_what_would_disturb_is_refused(controller: Controller) -> None:
    controller.push(OTHER)
    controller.check(RAMP.image())
    controller.ok(p.COMMIT)
    assert controller.status().state == p.WRITING
    for kind, length in (CHANGES | FOR_AXES).items():
        assert controller.refused(kind, (b"\1" + bytes(length))[:length]) == (p.BUSY, 0)
    controller.ok(p.STOP)
    controller.ok(p.HALT)
    assert (controller.read(p.STORED), controller.read(p.RAM), controller.read(p.PREVIOUS)) == (
        OTHER.image(),
        RAMP.image(),
        b"",
    )
    controller.run(WHOLE_COMMIT)
    assert controller.status().state == p.IDLE
    assert (controller.read(p.STORED), controller.read(p.PREVIOUS)) == (RAMP.image(), OTHER.image())


def test_while_moving_what_would_disturb_is_refused(controller: Controller) -> None:
    controller.push(RAMP)
    controller.ok(p.MOVE_BY, for_axes({0: 100}))
    for kind, length in (CHANGES | FOR_AXES).items():
        if kind not in (p.MOVE_BY, p.MOVE_TO, p.RUN):
            assert controller.refused(kind, (b"\1" + bytes(length))[:length]) == (p.MOVING, 0)
    assert controller.read() == RAMP.image()
    assert controller.settings() == Settings().packed()
    assert controller.ok(p.MOVE_BY, for_axes({0: 11})) == struct.pack("<i", 111)
    assert controller.ok(p.MOVE_TO, for_axes({0: 120})) == struct.pack("<i", 120)
    assert controller.run_until_idle().position == 120
    assert controller.steps()[0] == 120


def test_on_a_line_nothing_may_move(controller: Controller) -> None:
    controller.push(TWO_AXES)
    assert controller.ok(p.LINE, bytes([3, 0]) + p.values_of({0: 50, 1: -20})) == struct.pack("<ii", 50, -20)
    for kind in (p.MOVE_BY, p.MOVE_TO, p.RUN, p.LINE):
        assert controller.refused(kind, (b"\1" + bytes(FOR_AXES[kind]))[: FOR_AXES[kind]]) == (p.MOVING, 0)
    assert controller.run_until_idle().position == 50
    assert controller.steps()[:2] == [50, -20]
