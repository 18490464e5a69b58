"""The contact with a controller: whom to ask, and in which thread, for as long as somebody is connected to it."""

import threading
from collections.abc import Callable
from typing import TypeVar

from stepramp.controllers.capabilities import capable
from stepramp.controllers.contract import Controller
from stepramp.controllers.families import Family
from stepramp.devices.live_view import LiveView
from stepramp.devices.view import DeviceState
from stepramp.errors import DeviceLost, Refused, StepRampError
from stepramp.link.worker import Worker

STARTED_ANEW = "{name} is being restarted to prove what it has stored, which takes some seconds: ask again then."

C = TypeVar("C")
T = TypeVar("T")


class Contact:
    """A controller, and the worker that owns its port: all calls of the controller are made there. For any thread."""

    def __init__(self, view: LiveView, family: Family) -> None:
        self._view = view
        self._family = family
        self._lock = threading.Lock()
        self._controller: Controller | None = None
        self._worker: Worker | None = None

    @property
    def worker(self) -> Worker | None:
        """The worker of the present connection, or of the last one; None before the first."""
        with self._lock:
            return self._worker

    @property
    def is_there(self) -> bool:
        """Whether there is a controller that can be told to stop."""
        with self._lock:
            return self._controller is not None

    @property
    def controller(self) -> Controller:
        """The controller, which is there: in the thread of its port."""
        with self._lock:
            assert self._controller is not None
            return self._controller

    def begin(self, worker: Worker) -> None:
        """Make a worker that of the connection that begins."""
        with self._lock:
            self._worker = worker

    def greet(self, controller: Controller) -> None:
        """Let stops come to a controller from here on, and all else once the device is connected."""
        with self._lock:
            self._controller = controller

    def end(self) -> None:
        """Let nobody ask the controller any more."""
        with self._lock:
            self._controller = None

    def lose(self, why: StepRampError) -> None:
        """Have the device be lost once the present call is done: in the thread of its port."""
        with self._lock:
            worker = self._worker
        assert worker is not None
        worker.lose(why)

    def ready(self) -> tuple[Controller, Worker]:
        """Return controller and worker; raises DeviceLost or Refused when there are none to be asked."""
        with self._lock:
            controller, worker = self._controller, self._worker
        # After them: a connection is shown as being made before there is its controller.
        view = self._view.now
        if view.state is DeviceState.LOST:
            raise DeviceLost(view.message or f"Port {view.port} is not connected.")
        if view.proving:
            raise Refused(STARTED_ANEW.format(name=view.name))
        if controller is None or worker is None or view.state is DeviceState.CONNECTING:
            raise Refused(f"{view.name} is still being connected.")
        return controller, worker

    def ready_to_stop(self) -> tuple[Controller, Worker]:
        """Return as ready does, also while what the controller has is still being read."""
        with self._lock:
            controller, worker = self._controller, self._worker
        return self.ready() if controller is None or worker is None else (controller, worker)

    def ask(self, job: Callable[[Controller], T]) -> T:
        """Have the worker do a job with its controller: over this connection, or not at all."""
        controller, worker = self.ready()
        return worker.call(lambda: job(controller))

    def ask_one_who(self, kind: type[C], job: Callable[[C], T]) -> T:
        """Have the worker do what not every controller can; Refused before anything is done when this one can't."""
        controller, worker = self.ready()
        able = self.capable(controller, kind)
        return worker.call(lambda: job(able))

    def capable(self, controller: Controller, kind: type[C]) -> C:
        """Return the controller as one that has a capability, given as its protocol; Refused when it hasn't."""
        return capable(controller, kind, self._view.now.name, self._family.title)
