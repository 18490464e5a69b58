"""A device: one controller at one port, its state, and what can be asked of it from any thread."""

import threading
from collections.abc import Callable
from concurrent.futures import Future
from contextlib import suppress
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import TypeVar

from stepramp.controllers.controller import Activity, Controller, ControllerStatus, PushReport, StoredRamp
from stepramp.controllers.stepramp_controller import StepRampController
from stepramp.design import Design
from stepramp.errors import DeviceLost, Refused, StepRampError
from stepramp.link.ports import port_name
from stepramp.link.serial_port import SerialPort
from stepramp.link.worker import Worker

MOVING_POLL_S = 1 / 20
IDLE_POLL_S = 1 / 2
"""Often enough to notice soon that a device was unplugged."""

T = TypeVar("T")


class DeviceState(StrEnum):
    """Where a device is between connecting and being lost."""

    CONNECTING = "connecting"
    READY = "ready"
    MOVING = "moving"
    STOPPING = "stopping"
    WRITING = "writing"
    LOST = "lost"


STATES = {
    Activity.READY: DeviceState.READY,
    Activity.MOVING: DeviceState.MOVING,
    Activity.STOPPING: DeviceState.STOPPING,
    Activity.WRITING: DeviceState.WRITING,
}
UNDER_WAY = (DeviceState.MOVING, DeviceState.STOPPING)


@dataclass(frozen=True)
class DeviceView:
    """A device as it was at one moment; positions [steps], speed without sign [steps/s]."""

    id: str
    port: str
    name: str
    state: DeviceState = DeviceState.CONNECTING
    message: str | None = None
    """Why the device is lost."""
    position_steps: int = 0
    target_steps: int = 0
    speed_steps_per_s: float = 0.0
    timer_hz: int | None = None
    """Known once connected, as are the firmware's version and the ramp."""
    firmware_version: str | None = None
    ramp: StoredRamp | None = None
    pushed: PushReport | None = None
    """The last push over this connection."""


class Device:
    """One controller at one port. Its worker owns the port; all calls here may come from any thread.

    changed: called from the worker's thread after each change of the view.
    """

    def __init__(self, device_id: str, port: str, changed: Callable[[], None]) -> None:
        self._changed = changed
        self._lock = threading.Lock()
        self._connecting = threading.Lock()
        self._view = DeviceView(device_id, port, port_name(port))
        self._port: SerialPort | None = None
        self._controller: Controller | None = None
        self._worker: Worker | None = None
        self._pushing = False

    @property
    def view(self) -> DeviceView:
        """The device as it is now."""
        with self._lock:
            return self._view

    @property
    def connected(self) -> bool:
        """Whether the handshake is done and the device not lost."""
        return self.view.state not in (DeviceState.CONNECTING, DeviceState.LOST)

    def connect(self) -> None:
        """Open the port and shake hands, unless that is done already; nothing moves.

        Raises Rejected for an address that is no port, Refused for a controller of another kind, DeviceLost when none
        answers.
        """
        with self._connecting:
            if self.connected:
                return
            self._update(DeviceView(self.view.id, self.view.port, port_name(self.view.port)))
            self._worker = Worker(self.view.port, self._poll, self._ended)
            try:
                self._worker.call(self._open)
            except StepRampError as error:
                self._worker.close()
                self._update(replace(self.view, state=DeviceState.LOST, message=str(error)))
                raise

    def disconnect(self) -> None:
        """Let go of the port; Refused while the motor moves. A device that is lost is let go of, too."""
        with self._connecting:
            if self.connected:
                with suppress(DeviceLost):
                    self._ask(self._end_at_rest)
            self._close()

    def shut_down(self) -> None:
        """Stop the motor if it moves, and let go of the port: for the end of the program."""
        with self._connecting:
            if self.view.state in UNDER_WAY:
                # Whatever hinders it, there is no second chance: the program ends.
                with suppress(StepRampError):
                    self.stop().result()
            self._close()

    def push(self, design: Design) -> PushReport:
        """Store the design's ramp in the controller; see Controller.prepare_push."""
        controller, _ = self._ready()
        if self.view.state in UNDER_WAY:
            raise Refused("The motor moves: stop it first.")
        store = controller.prepare_push(design)
        return self._ask(lambda: self._push(store))

    def move_by(self, by_steps: int) -> None:
        """Begin to move by so many steps; see Controller."""
        controller, _ = self._ready()
        self._ask(lambda: self._then_refresh(lambda: controller.move_by(by_steps)))

    def move_to(self, to_steps: int) -> None:
        """Begin to move to a position [steps]; see Controller."""
        controller, _ = self._ready()
        self._ask(lambda: self._then_refresh(lambda: controller.move_to(to_steps)))

    def stop(self) -> "Future[None]":
        """Slow down with the ramp, before anything else that was asked for; return the result to come."""
        controller, worker = self._ready()
        return worker.call_urgently(lambda: self._then_refresh(controller.stop))

    def halt(self) -> "Future[None]":
        """Make no further step, before anything else that was asked for; return the result to come."""
        controller, worker = self._ready()
        return worker.call_urgently(lambda: self._then_refresh(controller.halt))

    def _ready(self) -> tuple[Controller, Worker]:
        """Return controller and worker; raises when there are none to be asked."""
        with self._lock:
            view, controller, worker = self._view, self._controller, self._worker
        if view.state is DeviceState.LOST:
            raise DeviceLost(view.message or f"Port {view.port} is not connected.")
        if controller is None or worker is None:
            raise Refused(f"{view.name} is still being connected.")
        return controller, worker

    def _ask(self, job: Callable[[], T]) -> T:
        _, worker = self._ready()
        return worker.call(job)

    def _close(self) -> None:
        if self._worker is not None:
            self._worker.close()

    def _update(self, view: DeviceView) -> None:
        with self._lock:
            changed = view != self._view
            self._view = view
        if changed:
            self._changed()

    # From here on: in the worker's thread.

    def _open(self) -> None:
        assert self._worker is not None
        self._port = SerialPort(self.view.port)
        controller = StepRampController(self._port, self._worker.give_way)
        controller.connect()
        status = controller.status()
        with self._lock:
            self._controller = controller
            known = replace(self._view, timer_hz=controller.timer_hz, firmware_version=controller.firmware_version)
        self._update(_with_status(known, status))

    def _poll(self) -> float:
        if self._controller is None:
            return IDLE_POLL_S
        self._refresh()
        return MOVING_POLL_S if self.view.state in UNDER_WAY else IDLE_POLL_S

    def _ended(self, loss: DeviceLost | None) -> None:
        if self._port is not None:
            self._port.close()
        with self._lock:
            self._port = self._controller = None
        message = "Disconnected." if loss is None else str(loss)
        self._update(replace(self.view, state=DeviceState.LOST, message=message, speed_steps_per_s=0.0))

    def _refresh(self) -> None:
        assert self._controller is not None
        view = _with_status(self.view, self._controller.status())
        # A stop may ask in the midst of a push, when the controller itself isn't writing yet.
        self._update(replace(view, state=DeviceState.WRITING) if self._pushing else view)

    def _then_refresh(self, job: Callable[[], None]) -> None:
        job()
        self._refresh()

    def _end_at_rest(self) -> None:
        """End the thread in the same call that looks whether the motor moves, so that no move slips in between."""
        self._refuse_under_way()
        self._close()

    def _refuse_under_way(self) -> None:
        self._refresh()
        if self.view.state in UNDER_WAY:
            raise Refused("The motor moves: stop it first.")

    def _push(self, store: Callable[[], PushReport]) -> PushReport:
        self._refuse_under_way()
        self._pushing = True
        self._update(replace(self.view, state=DeviceState.WRITING))
        try:
            report = store()
            self._update(replace(self.view, pushed=report))
            return report
        finally:
            self._pushing = False
            self._refresh()


def _with_status(view: DeviceView, status: ControllerStatus) -> DeviceView:
    return replace(
        view,
        state=STATES[status.activity],
        position_steps=status.position_steps,
        target_steps=status.target_steps,
        speed_steps_per_s=status.speed_steps_per_s,
        ramp=status.ramp,
    )
