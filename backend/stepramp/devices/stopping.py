"""Stopping a device: before anything else that was asked for, and for good."""

from collections.abc import Callable, Collection, Iterator
from concurrent.futures import Future
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from math import inf
from time import monotonic

from stepramp.controllers.contract import Controller
from stepramp.devices.contact import Contact
from stepramp.devices.leases import Leases
from stepramp.devices.live_view import LiveView
from stepramp.devices.owed_stops import OwedStops
from stepramp.devices.permit import Permit
from stepramp.devices.stops import Stops
from stepramp.devices.view import UNDER_WAY, DeviceState
from stepramp.devices.watch import Watch
from stepramp.errors import Refused, StepRampError
from stepramp.link.ports import Port

LAST_STOP_S = 1.5
"""How long the end of the program waits for a stop to be granted [s]."""

Send = Callable[[Collection[int] | None], None]
"""Tells a controller to stop axes, or all."""


class NotStopped(Refused):
    """A controller that is connected was told to stop, and has refused that."""


@dataclass
class _Turn:
    """The turn of a stop. waits_since_s: when it waited for that already, by the monotonic clock [s]."""

    waits_since_s: float = inf


class Stopping:
    """The stops of one device, until they are granted.

    stops: its stops. permit: which motion may set out. owed: stops that no controller has granted yet. known: the port,
    and what was plugged in there when it was last seen.
    """

    def __init__(
        self,
        view: LiveView,
        contact: Contact,
        watch: Watch,
        leases: Leases,
        stops: Stops,
        permit: Permit,
        owed: OwedStops,
        known: Port,
    ) -> None:
        self._view = view
        self._contact = contact
        self._watch = watch
        self._leases = leases
        self._stops = stops
        self._permit = permit
        self._owed = owed
        self._known = known
        self._last: dict[Send, tuple[float, str | None]] = {}
        """When the last stop, and halt, of all axes began that was answered, and why it was refused if it was."""
        self._heard_of_others = 0
        """How many stops of somebody else are heeded, of those that the present controller has told."""
        self._refused: int | None = None
        """The last stop that is owed and that the present controller has refused."""

    @contextmanager
    def being_stopped(self) -> Iterator[None]:
        """Let nothing move while a stop is being answered, nor afterwards what was asked until then."""
        try:
            with self._stops.unanswered():
                self.show()
                yield
        finally:
            self.show()

    def stop(self, axes: Collection[int] | None = None) -> "Future[None]":
        """Slow axes, or all, down before anything else that was asked for; see Device.stop."""
        owed, turn = self._owe("stop", axes), _Turn()
        controller, worker = self._contact.ready_to_stop()
        granted = worker.call_urgently(lambda: self._stop(axes, controller.stop, owed, turn))
        turn.waits_since_s = monotonic()
        return granted

    def halt(self, axes: Collection[int] | None = None) -> "Future[None]":
        """Make no further step, before anything else that was asked for; see Device.halt."""
        owed, turn = self._owe("halt", axes), _Turn()
        controller, worker = self._contact.ready_to_stop()
        granted = worker.call_urgently(lambda: self._halt(axes, controller.halt, owed, turn))
        turn.waits_since_s = monotonic()
        return granted

    def end(self) -> None:
        """Stop the motor for good: nothing moves it any more. For the end of the program."""
        self._stops.end()
        # Whatever hinders it, there is no second chance.
        with suppress(StepRampError, TimeoutError):
            self.stop().result(LAST_STOP_S)

    def show(self) -> None:
        """Tell the number of the last stop."""
        self._view.change(lambda view: replace(view, stops=self._stops.last))

    def _owe(self, what: str, axes: Collection[int] | None) -> int:
        self._view.log("%s of %s asked for", what, "all axes" if axes is None else f"axes {sorted(axes)}")
        owed = self._owed.owe(self._known, is_halt=what == "halt")
        self._stops.note()
        self.show()
        return owed

    # From here on: in the thread of the port.

    def greet(self, controller: Controller, known: Port) -> None:
        """Let stops come to the controller from here on, and first of all tell it that which is owed.

        One that refuses is connected all the same, or nobody could halt it; its view tells why.
        known: its port, and what is plugged in there now.
        """
        self._known = known
        self._last.clear()
        self._refused = None
        self._heard_of_others = controller.stops_of_others()
        self._contact.greet(controller)
        owed = self._owed.newest(self._known)
        if owed is not None:
            with suppress(NotStopped):
                self._stop(None, controller.halt if self._owed.is_halt(self._known) else controller.stop, owed)

    def slow_down(self, axes: Collection[int]) -> None:
        """Stop axes that nobody has asked to be stopped."""
        self._stop(axes, self._contact.controller.stop)

    def take_back(self, axes: Collection[int]) -> None:
        """Stop axes that move though nobody wants them to: until it is granted, that stop is owed."""
        self._stop(axes, self._contact.controller.stop, self._owed.owe(self._known))

    def owe_what_may_have_set_out(self) -> None:
        """Stop what nobody answers for as soon as it does: whoever asked for a motion was told that it failed."""
        self._owed.owe(self._known)

    def heed_others(self) -> bool:
        """Take a stop that somebody else has told the controller as one of all axes; return whether there was one."""
        heard = self._contact.controller.stops_of_others()
        if heard == self._heard_of_others:
            return False
        self._heard_of_others = heard
        self._view.log("stopped by somebody else on the line")
        self._stops.note()
        self.show()
        self._leases.drop()
        self._watch.is_view_old = True
        self._view.change(lambda view: view.stopping(None).without_errand(None))
        return True

    def settle_at_rest(self) -> None:
        """Owe nothing any more that was refused, once everything was seen at rest since."""
        if not self._watch.is_view_old and self._view.now.state is DeviceState.READY:
            self.settle_refused()

    def settle_refused(self, before: float = inf) -> None:
        """Owe nothing any more that was refused before that number: it would end what was begun since."""
        if self._refused is not None and self._refused < before:
            self._owed.settle(self._known, self._refused, of_all_axes=True)
            self._refused = None
            self._view.change(lambda view: replace(view, stop_refused=None))

    def _halt(self, axes: Collection[int] | None, send: Send, owed: int, turn: _Turn) -> None:
        """Halt axes, and look where that was."""
        self._stop(axes, send, owed, turn)
        if self._watch.is_view_old:
            self._watch.refresh()

    def _stop(
        self, axes: Collection[int] | None, send: Send, owed: int | None = None, turn: _Turn | None = None
    ) -> None:
        """Stop axes, also in the midst of what sets some in motion. Where they come to rest is looked at afterwards.

        owed: the number of the stop that is owed until it is granted. turn: that for which it had to wait.
        """
        if axes is not None and not set(axes) <= {axis.axis for axis in self._view.now.axes}:
            axes = None  # Whoever names an axis that isn't there means something else than we know: all stop.
        with self._permit.set_aside():
            try:
                self._send(axes, send, turn)
            except Refused as error:
                self._note_refused(owed, str(error))
                raise NotStopped(str(error)) from error
            if owed is not None:
                self._owed.settle(self._known, owed, of_all_axes=axes is None)
                self._view.log("stop granted")
                if axes is None:
                    self.settle_refused(owed)
            self._leases.drop(axes)
            self._watch.is_view_old = self._view.now.state in UNDER_WAY
            self._view.change(lambda view: view.stopping(axes).without_errand(axes))
            if self._permit.is_unseen:
                self._watch.refresh()

    def _note_refused(self, owed: int | None, why: str) -> None:
        if owed is not None:
            self._refused = max(owed, self._refused or owed)
            self._view.log("stop refused: %s", why)
            self._view.change(lambda view: replace(view, stop_refused=why))
            self._watch.is_view_old = True

    def _send(self, axes: Collection[int] | None, send: Send, turn: _Turn | None) -> None:
        """Tell the controller, unless it was told to stop all while this waited for its turn: that answers it, too.

        When it was granted, nothing has set out since. Some controllers take seconds for a stop, also to refuse it, as
        a Marlin that heats; however many ask for one, nobody waits for more than two. Raises what it raised.
        """
        last_s, why_not = self._last.get(send, (-inf, None))
        if turn is not None and turn.waits_since_s < last_s:
            if why_not is None:
                return
            if axes is None:
                raise Refused(why_not)
        begun_s = monotonic()
        try:
            send(axes)
        except Refused as error:
            if axes is None:
                self._last[send] = begun_s, str(error)
            raise
        if axes is None:
            self._last[send] = begun_s, None
