"""Runs: axes that run on a lease, and slow down once it doesn't hold any more."""

from contextlib import suppress

from stepramp.controllers.contract import ControllerStatus
from stepramp.devices.contact import Contact
from stepramp.devices.leases import Lease, Leases
from stepramp.devices.limit_checks import too_near
from stepramp.devices.live_view import LiveView
from stepramp.devices.stopping import NotStopped, Stopping
from stepramp.errors import StepRampError


class Runs:
    """Sees to it that what may run no longer slows down, also in the midst of something else."""

    def __init__(self, view: LiveView, contact: Contact, leases: Leases, stopping: Stopping) -> None:
        self._view = view
        self._contact = contact
        self._leases = leases
        self._stopping = stopping
        self._are_ending = False

    def end(self, lease: Lease) -> None:
        """Slow axes down that run on a lease, before anything else that was asked for. From any thread."""
        lease.end()
        with suppress(StepRampError):
            _, worker = self._contact.ready()
            worker.call_urgently(self.let_end, overtakes=False)

    # From here on: in the thread of the port.

    def give_way(self, pause_s: float = 0.0) -> None:
        """Let calls through that are more urgent, and what mustn't wait until a request has been answered."""
        worker = self._contact.worker
        assert worker is not None
        if not self._are_ending and self._to_end():
            with suppress(StepRampError):
                worker.call_urgently(self.let_end, overtakes=False)
        worker.give_way(pause_s)

    def end_those_of_nobody(self, status: ControllerStatus) -> None:
        """Slow down what is found running when a controller is connected: who asked for it is gone.

        It runs on because we ask the controller what it does, and nobody would end it. One that refuses to, as while
        somebody else moves it, is connected all the same: it can be halted then, and its view tells why.
        """
        axes = [axis.axis for axis in status.axes if axis.runs or axis.homing]
        if axes:
            self._view.log("axes %s run for nobody: slowed down", axes)
            with suppress(NotStopped):
                self._stopping.take_back(axes)

    def let_end(self) -> None:
        """Slow down what may run no longer."""
        axes = self._to_end()
        if not axes:
            return
        self._are_ending = True
        try:
            self._stopping.slow_down(axes)
        finally:
            self._are_ending = False

    def _to_end(self) -> list[int]:
        """Return the axes whose lease has run out, that come too near a soft limit, or whose page is gone."""
        if not self._contact.is_there:
            return []
        view = self._view.now
        near = too_near(view, self._leases, self._contact.controller.steps_to_rest)
        left = [view.shuttle.axis] if view.shuttle and view.shuttle.page not in (None, view.in_control) else []
        return sorted({*self._leases.run_out(view.in_control), *near, *left})
