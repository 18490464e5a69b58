"""Proving that a controller has stored what it was given: by what it has after its next start."""

from collections.abc import Collection
from dataclasses import replace

from stepramp.controllers.capabilities import AT_NEXT_START, ProvenByStart
from stepramp.controllers.contract import Controller
from stepramp.devices.live_view import LiveView
from stepramp.devices.proof import Other, Proof
from stepramp.devices.unproven import Unproven
from stepramp.errors import Refused
from stepramp.link.remote_ports import RemotePort

NOTHING = "Nothing is left to be proven of {name}: all that was written from here was there after a start."
BYTES_ONLY = (
    "Over {port} only bytes travel, and nothing that restarts the controller; nor can it be known there whether it has "
    f"started. {AT_NEXT_START} over a serial port, here or by rfc2217://."
)
GOES_ON = (
    "The controller at {port} doesn't restart as its port is opened, so nothing is proven yet. "
    f"{AT_NEXT_START}, as by switching it off and on, where that is heard. Set its position again."
)


class Proving:
    """What one device was given whose storing isn't proven, until it is. For controllers that are ProvenByStart."""

    def __init__(self, view: LiveView, unproven: Unproven) -> None:
        self._view = view
        self._unproven = unproven
        self._has_seen_start = False

    def refuse_unneeded(self) -> None:
        """Refused where a start of the controller from here would prove nothing."""
        now = self._view.now
        if "prove" not in now.capabilities:
            return  # It isn't there, or can't be started anew: that is said as of all that can't be asked.
        if now.unproven_damage is not None:
            raise Refused(now.unproven_damage)
        if not now.unproven:
            raise Refused(NOTHING.format(name=now.name))
        if _carries_bytes_only(now.port):
            raise Refused(BYTES_ONLY.format(port=now.port))

    def refuse_unseen(self) -> None:
        """Refused where the last connection has not begun with a start of the controller."""
        if not self._has_seen_start:
            raise Refused(GOES_ON.format(port=self._view.now.port))

    @property
    def trouble(self) -> str | None:
        """Why what is to be proven is known only as long as the program runs, as a sentence; None: it is written."""
        return self._unproven.trouble

    # From here on: in the thread of the port.

    def know(self, unproven: Unproven) -> None:
        """Take what is unproven of the board that the device turns out to be."""
        self._unproven = unproven

    def note(self, controller: Controller) -> None:
        """Note what the controller was given just now, whatever has come of it."""
        if not isinstance(controller, ProvenByStart):
            return
        given = {**dict.fromkeys(self._not_wanted(controller)), **controller.take_given()}
        if given:
            self._unproven.note(given)
            self._view.change(
                lambda view: replace(view, proof=None if view.proof is None else view.proof.without(given))
            )
            self._show()

    def look(self, controller: Controller) -> None:
        """Compare what a controller has that was just connected with what it was given, if it was heard to start."""
        if not isinstance(controller, ProvenByStart):
            return
        self._has_seen_start = controller.has_started and not _carries_bytes_only(self._view.now.port)
        given = self._unproven.given
        if self._has_seen_start and given:
            found = controller.others({name: each.value for name, each in given.items()})
            others = tuple(Other(name, given[name].value, given[name].at, now) for name, now in found.items())
            proof = Proof(tuple(name for name in given if name not in found), others)
            self._unproven.drop(proof.proven)
            self._view.change(lambda view: replace(view, proof=proof))
            self._view.log("%s", proof.words)
        self._show()

    def _not_wanted(self, controller: ProvenByStart) -> Collection[str]:
        """Return what was given a value before, and was left just now with another: nobody wants that any more."""
        noted = {name: each.value for name, each in self._unproven.given.items()}
        return controller.others({name: noted[name] for name in controller.take_left() if name in noted})

    def _show(self) -> None:
        self._view.change(
            lambda view: replace(view, unproven=tuple(self._unproven.given), unproven_damage=self._unproven.damage)
        )


def _carries_bytes_only(port: str) -> bool:
    """Whether neither is a controller started anew by opening its port, nor does a greeting tell that it was.

    What listens there may greet whoever connects, as grblHAL does on a network.
    """
    remote = RemotePort.of(port)
    return remote is not None and remote.scheme == "socket"
