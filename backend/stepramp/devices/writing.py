"""Writing: the ramps and settings that a controller is given."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TypeVar

from stepramp.controllers.capabilities import HasSettings, RestoresRamps, StoresRamps, TriesRamps
from stepramp.controllers.contract import PushMode, PushPreview, PushReport
from stepramp.controllers.progress import Progress, PushStage
from stepramp.design import Design
from stepramp.devices.contact import Contact
from stepramp.devices.leases import Leases
from stepramp.devices.live_view import LiveView
from stepramp.devices.view import UNDER_WAY, DeviceState
from stepramp.devices.watch import Watch
from stepramp.errors import Refused
from stepramp.validation import Document

C = TypeVar("C")
SendPush = Callable[[], PushReport]
PlanPush = Callable[[], SendPush]


class Writing:
    """Gives a controller ramps and settings, at rest. From any thread; see Device for what each call does."""

    def __init__(self, view: LiveView, contact: Contact, watch: Watch, leases: Leases) -> None:
        self._view = view
        self._contact = contact
        self._watch = watch
        self._leases = leases

    def preview_push(self, designs: Sequence[Design], first_axis: int | None) -> PushPreview:
        """Return what a push would change, without the port."""
        return self._contact.ready()[0].preview_push(designs, first_axis)

    def push(
        self,
        designs: Sequence[Design],
        first_axis: int | None,
        mode: PushMode,
        planned: Callable[[PlanPush], SendPush],
    ) -> PushReport:
        """Have the controller use the designs' ramps, and store them or not; a stop ends it until it is sent."""
        connection = controller, worker = self._contact.ready()
        self._contact.capable(controller, StoresRamps if mode == "keep" else TriesRamps)
        if self._view.now.state in UNDER_WAY:
            raise Refused("The motor moves: stop it first.")
        stops = self._view.now.stops
        self._show(Progress(PushStage.PLANNING, 0, 0))
        try:
            send = planned(lambda: controller.prepare_push(designs, first_axis, mode))
            if self._view.now.stops != stops:
                raise Refused("A stop came before anything was sent: the controller has the ramps that it had.")
            if self._contact.ready() != connection:
                raise Refused("The device was lost and connected again in the meantime: push again.")
            return worker.call(lambda: self._push(send))
        finally:
            self._show(None)

    def keep(self) -> None:
        """Store the ramps and settings in use."""
        self._write(StoresRamps, lambda controller: controller.keep())

    def roll_back(self) -> None:
        """Use the stored ramps and settings again."""
        self._write(TriesRamps, lambda controller: controller.roll_back())

    def restore(self) -> None:
        """Make the ramps and settings that were stored before the stored ones."""
        self._write(RestoresRamps, lambda controller: controller.restore())

    def settings(self) -> Document:
        """Ask for the settings in use."""
        settings: Document = self._contact.ask_one_who(HasSettings, lambda controller: controller.settings())
        return settings

    def use_settings(self, settings: Document) -> None:
        """Use other settings until a roll back or a reset."""
        self._write(HasSettings, lambda controller: controller.use_settings(settings))

    def _write(self, kind: type[C], job: Callable[[C], None]) -> None:
        self._contact.ask_one_who(kind, lambda able: self._while_writing(lambda: job(able)))

    # From here on: in the thread of the port.

    def note_progress(self, progress: Progress) -> None:
        """Show how far a push has come."""
        if self._watch.is_writing:
            self._show(progress)

    def _push(self, send: SendPush) -> PushReport:
        reports: list[PushReport] = []
        self._while_writing(lambda: reports.append(send()))
        self._view.change(lambda view: replace(view, pushed=reports[0]))
        self._view.log("ramps pushed, %d bytes, %s", reports[0].bytes, "kept" if reports[0].kept else "on trial")
        return reports[0]

    def _while_writing(self, job: Callable[[], None]) -> None:
        self._watch.refuse_under_way()
        self._leases.drop()
        self._watch.is_writing = True
        self._view.change(lambda view: replace(view, state=DeviceState.WRITING, shuttle=None))
        try:
            job()
        finally:
            self._watch.is_writing = False
            self._show(None)
            self._watch.refresh()

    def _show(self, progress: Progress | None) -> None:
        self._view.change(lambda view: replace(view, progress=progress))
