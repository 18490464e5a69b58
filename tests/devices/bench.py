"""One device at a controller whose clock stands still, and the places where its port's thread gives way."""

from __future__ import annotations

import threading
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any

from controllers.conftest import Clock
from designs import design
from devices.boards import Witness
from devices.motion import PATIENCE_S
from stepramp.controllers.contract import AxisCommand
from stepramp.controllers.stepramp.messages.motion import (
    HaltRequest,
    HomeRequest,
    LineRequest,
    MoveByRequest,
    MoveToRequest,
    RunRequest,
    StopRequest,
    ZeroRequest,
)
from stepramp.controllers.surroundings import SurroundingsChange, Switches
from stepramp.devices.attachment import Attachment
from stepramp.devices.device import Device
from stepramp.devices.homing import Homing
from stepramp.devices.leases import Lease
from stepramp.devices.registry import Devices
from stepramp.devices.view import DeviceState
from stepramp.devices.watch import Watch
from stepramp.errors import Refused
from stepramp.link.worker import Worker

MOTIONS = {each.KIND for each in (MoveByRequest, MoveToRequest, RunRequest, LineRequest, ZeroRequest, HomeRequest)}
ROLES = [{"input": "A0", "role": "emergency_stop"}, {"input": "A1", "role": "limit", "axis": 0, "end": "low"}]
STOPS = {StopRequest.KIND, HaltRequest.KIND}
POLL = Attachment.poll


@dataclass
class Places:
    """Where the port's thread gives way, waits, or sends; at the one that is chosen, something is done."""

    chosen: int | None = None
    act: Callable[[], None] = field(default=lambda: None)
    counted: int = 0
    inside: bool = False

    def choose(self, place: int, act: Callable[[], None]) -> None:
        self.chosen, self.act, self.counted = place, act, 0

    def passed(self) -> None:
        if self.chosen is None or self.inside or not threading.current_thread().name.startswith("port"):
            return
        if self.counted == self.chosen:
            self.chosen, self.inside = None, True
            self.act()
            self.inside = False
            return
        self.counted += 1

    def around(self, call: Callable[..., Any]) -> Callable[..., Any]:
        def watched(*args: Any, **kwargs: Any) -> Any:
            self.passed()
            try:
                return call(*args, **kwargs)
            finally:
                self.passed()

        return watched


@dataclass
class Bench:
    """One device with two axes, and what a test needs to watch it."""

    devices: Devices
    device: Device
    witness: Witness
    clock: Clock
    places: Places
    answered_s: float = 0.0

    @property
    def worker(self) -> Worker:
        return worker_of(self.device)

    @property
    def watch(self) -> Watch:
        return self.device._attachment._watch

    def settle(self) -> None:
        """Let whatever moves come to rest, with its name where it was homed, and see it."""
        self.clock.now_s += 10_000.0
        self.look()
        self.worker.call(self.device._attachment._homings.go_on)
        assert self.device.view.state is DeviceState.READY

    def look(self) -> None:
        self.worker.call(self.watch.refresh)

    def poll(self) -> None:
        self.watch.is_view_old = True
        self.worker.call(lambda: POLL(self.device._attachment))

    def put_switch(self, steps_ahead: int | None) -> None:
        """Put the switch at the low end of axis 0 so many steps from where that is; None: there is none."""
        virtual = self.witness.controller
        place = virtual.surroundings.axes[0].place_steps
        low = None if steps_ahead is None else place - steps_ahead
        virtual.change_surroundings(SurroundingsChange(switches={0: Switches(low, None)}))

    def reset(self) -> None:
        self.places.chosen = None
        self.witness.loses = None
        self.put_switch(None)
        self.device.stop().result(PATIENCE_S)
        self.settle()
        with suppress(Refused):
            self.device.trace_moves(0, 1)
        self.device.set_position([AxisCommand(0, 0, "position_steps"), AxisCommand(1, 0, "position_steps")])
        self.witness.seen.clear()


def worker_of(device: Device) -> Worker:
    worker = device._attachment._contact.worker
    assert worker is not None
    return worker


def push(device: Device, clock: Clock) -> None:
    """Push a ramp for two axes; writing it takes time by the controller's clock."""
    pushing = threading.Thread(target=lambda: device.push([design(), design()]))
    pushing.start()
    while pushing.is_alive():
        clock.now_s += 0.1
        pushing.join(0.001)


def by(steps: int, axis: int = 0) -> AxisCommand:
    return AxisCommand(axis, steps, "by_steps")


def run(bench: Bench, asked: int, *, lasts_s: float = 1e6) -> None:
    bench.device.run([AxisCommand(0, 400.0, "speed_steps_per_s")], Lease({0: 400.0}, lasts_s), asked)


def home(bench: Bench, asked: int | None = None, *, lasts_s: float = 1e6, position_steps: int = 0) -> None:
    """Home axis 0 with a switch 200 steps from where it is."""
    bench.put_switch(200)
    fast, slow = AxisCommand(0, -800.0, "axes.0.fast_steps_per_s"), AxisCommand(0, 400.0, "slow_steps_per_s")
    lease = Lease({0: -800.0}, lasts_s, is_to_home=True)
    bench.device.home(Homing([fast], slow, 20, {0: position_steps}), lease, asked)
