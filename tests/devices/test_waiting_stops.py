"""Stops that many ask for at once, of a controller that takes its time for each: nobody waits for more than two."""

from __future__ import annotations

import threading
from collections.abc import Callable, Collection, Iterator

import pytest

from controllers.plain_controller import NoWire, PlainController
from devices.motion import PATIENCE_S
from stepramp.controllers.families import Family
from stepramp.controllers.progress import Tell
from stepramp.devices.device import Device
from stepramp.devices.registry import Devices
from stepramp.errors import Refused
from stepramp.link.connection import Connection


class SlowToStop(PlainController):
    """It is done with a stop once it is let go on, as a Marlin is after a second or two. refusals: of its next ones."""

    def __init__(self, connection: Connection, give_way: Callable[[float], None], tell: Tell) -> None:
        super().__init__(connection, give_way, tell)
        self.begun, self.goes_on = threading.Event(), threading.Event()
        self.refusals = 0

    def stop(self, axes: Collection[int] | None = None) -> None:
        super().stop(axes)
        self.begun.set()
        assert self.goes_on.wait(PATIENCE_S)
        if self.refusals:
            self.refusals -= 1
            raise Refused("It moves on.")


@pytest.fixture
def device() -> Iterator[Device]:
    devices = Devices({"plain": Family("plain", "Plain", NoWire, SlowToStop)})
    yield devices.connect("at a plain wire", "plain")
    devices.close()


@pytest.fixture
def controller(device: Device) -> SlowToStop:
    made = device._attachment._contact.controller
    assert isinstance(made, SlowToStop)
    return made


def test_stops_that_wait_are_granted_together(device: Device, controller: SlowToStop) -> None:
    first = device.stop()
    assert controller.begun.wait(PATIENCE_S)
    rest = [device.stop() for _ in range(10)]
    controller.goes_on.set()
    for stop in (first, *rest):
        stop.result(PATIENCE_S)
    # One more, since they were asked for when the first had begun already.
    assert controller.asked == ["stop None"] * 2


def test_stops_that_wait_are_refused_together_and_keep_no_halt_waiting(device: Device, controller: SlowToStop) -> None:
    """As by a Marlin that heats: it takes seconds for each refusal."""
    controller.refusals = 2
    first = device.stop()
    assert controller.begun.wait(PATIENCE_S)
    rest, halt = [device.stop() for _ in range(8)], device.halt()
    controller.goes_on.set()
    for stop in (first, *rest):
        with pytest.raises(Refused, match="It moves on"):
            stop.result(PATIENCE_S)
    halt.result(PATIENCE_S)
    assert controller.asked == ["stop None", "stop None", "halt None"]
    # Who asks once more is not answered by that.
    device.stop().result(PATIENCE_S)
    assert controller.asked == ["stop None", "stop None", "halt None", "stop None"]


def test_a_stop_that_was_refused_grants_none_of_one_axis(device: Device, controller: SlowToStop) -> None:
    controller.refusals = 2
    first = device.stop()
    assert controller.begun.wait(PATIENCE_S)
    rest, of_one = [device.stop() for _ in range(2)], device.stop([0])
    controller.goes_on.set()
    for stop in (first, *rest):
        with pytest.raises(Refused):
            stop.result(PATIENCE_S)
    of_one.result(PATIENCE_S)
    assert controller.asked == ["stop None", "stop None", "stop [0]"]


def test_a_stop_of_one_axis_grants_none_of_all(device: Device, controller: SlowToStop) -> None:
    first = device.stop()
    assert controller.begun.wait(PATIENCE_S)
    rest = [device.stop([0]), device.stop()]
    controller.goes_on.set()
    for stop in (first, *rest):
        stop.result(PATIENCE_S)
    assert controller.asked == ["stop None", "stop [0]", "stop None"]
