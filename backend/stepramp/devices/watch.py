"""The watch over a controller: when it is asked or listened to, and what is shown of that."""

from dataclasses import replace
from time import monotonic

from stepramp.controllers.axes import refusal_of_moving
from stepramp.controllers.contract import ControllerStatus
from stepramp.devices.contact import Contact
from stepramp.devices.live_view import LiveView
from stepramp.devices.view import UNDER_WAY, DeviceState, DeviceView
from stepramp.errors import Refused

LISTEN_S = 1 / 50
"""How often a device that moves is listened to: as often as it reports."""
HEARTBEAT_S = 1 / 3
"""So often a controller is asked while it moves [s]: what runs at a speed stops when nobody asks any more."""
SILENCE_S = 1 / 10
"""A device that moves and doesn't report for so long is asked."""
IDLE_POLL_S = 1 / 2
"""So often a controller at rest is asked: soon enough to notice that it was unplugged, and before one that waits for
commands no longer than 1 s gives up."""


def moving(view: DeviceView) -> Refused:
    """Return the refusal of what can't be done while a motor moves, with the first axis that does."""
    return refusal_of_moving(next((each.axis for each in view.axes if each.state in UNDER_WAY), None))


class Watch:
    """Looks at what a controller does, and shows it. In the thread of its port."""

    def __init__(self, view: LiveView, contact: Contact) -> None:
        self._view = view
        self._contact = contact
        self._polled_s = 0.0
        self.is_view_old = False
        """The controller does something else than is shown, and has still to be asked what."""
        self.is_writing = False
        """Ramps or settings are being written."""

    @property
    def pause_s(self) -> float:
        """After how long to look again [s]."""
        view = self._view.now
        if view.state in UNDER_WAY or view.shuttle:
            return LISTEN_S
        return max(LISTEN_S, self._polled_s + IDLE_POLL_S - monotonic())

    def look(self) -> None:
        """Listen to the controller, or ask it, if that is due."""
        view = self._view.now
        under_way = view.state in UNDER_WAY
        is_due = self.is_view_old or monotonic() - self._polled_s >= (HEARTBEAT_S if under_way else IDLE_POLL_S)
        if not is_due and under_way and not self.listen():
            is_due = monotonic() - view.heard_s > SILENCE_S
        if is_due:
            self.refresh()

    def listen(self) -> bool:
        """Show what the controller has said of itself, without asking; return whether it has."""
        heard = self._contact.controller.listen()
        if heard is not None:
            self.show(heard)
        return heard is not None

    def refresh(self) -> None:
        """Ask the controller what it does, and show it."""
        self._polled_s = monotonic()
        # Before it is asked: a stop in the midst of that makes the view old again.
        self.is_view_old = False
        self.show(self._contact.controller.status())

    def show(self, status: ControllerStatus) -> None:
        """Show what the controller says of itself."""
        timer_hz, now_s = self._contact.controller.timer_hz, monotonic()

        def shown(view: DeviceView) -> DeviceView:
            view = replace(view.with_status(status), timer_hz=timer_hz, heard_s=now_s)
            # A stop may ask in the midst of a push, when the controller itself isn't writing yet.
            return replace(view, state=DeviceState.WRITING) if self.is_writing else view

        self._view.change(shown)

    def refuse_under_way(self) -> None:
        """Refused while a motor moves, which is asked now."""
        self.refresh()
        if self._view.now.state in UNDER_WAY:
            raise moving(self._view.now)
