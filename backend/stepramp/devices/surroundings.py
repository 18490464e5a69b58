"""What is around a virtual controller: what it is wired to can be pressed and moved, as nothing real can be."""

from collections.abc import Callable
from typing import TypeVar

from stepramp.controllers.contract import Controller
from stepramp.controllers.surroundings import HasSurroundings, Surroundings, SurroundingsChange
from stepramp.devices.contact import Contact
from stepramp.devices.live_view import LiveView
from stepramp.devices.watch import Watch
from stepramp.errors import Refused
from stepramp.link import protocol_sim

T = TypeVar("T")


class VirtualSurroundings:
    """Those of one device, if it is a virtual one. From any thread."""

    def __init__(self, view: LiveView, contact: Contact, watch: Watch) -> None:
        self._view = view
        self._contact = contact
        self._watch = watch

    def now(self) -> Surroundings:
        """Return what is pressed, and where axes and switches are; Refused of a device that isn't virtual."""
        return self._with(lambda virtual: virtual.surroundings)

    def change(self, change: SurroundingsChange) -> Surroundings:
        """Press, release or move something; see now."""

        def changed(virtual: HasSurroundings) -> Surroundings:
            virtual.change_surroundings(change)
            self._watch.refresh()
            return virtual.surroundings

        return self._with(changed)

    def _with(self, job: Callable[[HasSurroundings], T]) -> T:
        view = self._view.now
        virtual = protocol_sim.device_at(view.port)
        if not isinstance(virtual, HasSurroundings):
            raise Refused(f"{view.name} is not virtual: what is at its inputs can't be pressed from here.")

        def done(_: Controller) -> T:
            # In the thread of the port, which alone talks to what is at its other end.
            return job(virtual)

        return self._contact.ask(done)
