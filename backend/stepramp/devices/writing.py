"""Writing: the ramps and settings that a controller is given."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from typing import TypeVar

from stepramp.controllers.capabilities import (
    BacksUp,
    HasSettings,
    LooksFirst,
    RestoresRamps,
    StoresRamps,
    TellsSettings,
    TriesRamps,
)
from stepramp.controllers.contract import Controller, PushMode, PushPreview, PushReport
from stepramp.controllers.own_ramp import Deviation, PlayOwn
from stepramp.controllers.progress import Progress, PushStage
from stepramp.controllers.remark import Unwritten
from stepramp.design import Design
from stepramp.devices.backups import Backups, Saved, checked
from stepramp.devices.contact import Contact
from stepramp.devices.leases import Leases
from stepramp.devices.live_view import LiveView
from stepramp.devices.proving import Proving
from stepramp.devices.view import UNDER_WAY, DeviceState, DeviceView
from stepramp.devices.watch import Watch, moving
from stepramp.errors import DeviceLost, Refused, StepRampError
from stepramp.validation import Document

C = TypeVar("C")
Told = TypeVar("Told", PushReport, PushPreview)
SendPush = Callable[[], PushReport]
PlanPush = Callable[[], SendPush]
STILL_LACKS = (
    "What it had before it was lost is still missing: this backup is newer, and may be of what was half written. "
    "Restore {name}, or an older one."
)
NOT_ITS_OWN = (
    "What it had before it was lost is still missing: this backup is of another device. Restore {name} of this one, or "
    "an older one."
)
NOT_WHOLE = "It isn't as it was before it was lost: not all that can be written is as in the backup. Restore it again."


class Writing:
    """Gives a controller ramps and settings, at rest. From any thread; see Device for what each call does."""

    def __init__(
        self,
        view: LiveView,
        contact: Contact,
        watch: Watch,
        leases: Leases,
        backups: Backups,
        proving: Proving,
        play_own: PlayOwn | None,
    ) -> None:
        """play_own: what controllers of its family play that work the intervals out themselves, if that is known."""
        self._view = view
        self._contact = contact
        self._watch = watch
        self._leases = leases
        self._backups = backups
        self._proving = proving
        self._play_own = play_own
        self._saved: Controller | None = None
        """The controller of the last connection over which a backup was saved."""

    def preview_push(self, designs: Sequence[Design], first_axis: int | None) -> PushPreview:
        """Return what a push would change; what others may have changed is looked at, as long as nothing is done."""
        controller, worker = self._contact.ready()
        if isinstance(controller, LooksFirst) and self._view.now.state is DeviceState.READY:
            # A stop that comes first takes no preview away: it tells what was known before.
            with suppress(Refused):
                worker.call(controller.look_first)
        preview = controller.preview_push(designs, first_axis)
        return _with(self._deviation(designs, first_axis), preview)

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
            raise moving(self._view.now)
        stops = self._view.now.stops
        self._show(Progress(PushStage.PLANNING, 0, 0))
        try:
            send = planned(lambda: self._prepared(controller, designs, first_axis, mode))
            if self._view.now.stops != stops:
                raise Refused("A stop came before anything was sent: the controller has the ramps that it had.")
            if self._contact.ready() != connection:
                raise Refused("The device was connected anew in the meantime, and nothing was sent: push again.")
            return worker.call(lambda: self._push(send))
        finally:
            self._show(None)

    def _prepared(
        self, controller: Controller, designs: Sequence[Design], first_axis: int | None, mode: PushMode
    ) -> SendPush:
        """Work out what a push sends, and how far what is played is off."""
        send = controller.prepare_push(designs, first_axis, mode)
        deviation = self._deviation(designs, first_axis)
        return lambda: _with(deviation, send())

    def _deviation(self, designs: Sequence[Design], first_axis: int | None) -> Deviation | None:
        """Return how far a controller's own ramps are off; None where it plays what it is sent, or nobody knows."""
        if self._play_own is None:
            return None
        scales = {axis.axis: axis.steps_per_mm for axis in self._view.now.axes}
        first = first_axis or 0
        return Deviation.of(designs, [scales.get(first + place) for place in range(len(designs))], self._play_own)

    def keep(self) -> tuple[str, ...]:
        """Store the ramps and settings in use, and return what else there is to say, as sentences."""
        remarks: list[str] = []

        def store(able: StoresRamps) -> None:
            self._while_writing(lambda: remarks.extend(able.keep() or ()))
            self._view.change(lambda view: view.with_kept(remarks))

        self._contact.ask_one_who(StoresRamps, store)
        return tuple(remarks)

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

    def backups(self) -> Saved:
        """Return its backups, also while it is lost; Refused when it can't be backed up."""
        saved = self._backups.all()
        if not saved.backups and self._view.now.state is not DeviceState.LOST:
            self._contact.capable(self._contact.ready()[0], BacksUp)
        return saved

    def saved_text(self, name: str) -> str:
        """Return a backup; NotFound when there is none of that name."""
        return self._backups.read(name)

    def present_text(self) -> str:
        """Ask for everything that a backup says."""
        text: str = self._contact.ask_one_who(TellsSettings, lambda controller: controller.backup())
        return text

    def back_up(self) -> None:
        """Save what the device has now."""
        self._contact.ask_one_who(BacksUp, self._save_at_rest)

    def restore_backup(self, name: str) -> tuple[str, ...]:
        """Write what a backup says, and return what couldn't be, as sentences."""
        return self.restore_text(self._backups.read(name), name)

    def restore_text(self, text: str, name: str, source: str | None = None) -> tuple[str, ...]:
        """Write what a text says that is the backup of this name; as restore_backup. Refused for a damaged one.

        source: the folder that it is in; None: its own.
        """
        text, said = checked(text, name)
        remarks = list(said)

        def use(able: BacksUp) -> None:
            remarks.extend(able.use_backup(text))
            remarks.extend(self._settle_half_written(remarks, name, source))

        def restore(able: BacksUp) -> None:
            self._while_writing(lambda: use(able), unsaved=remarks.append)
            remarks.extend(self._unwritten())

        self._contact.ask_one_who(BacksUp, restore)
        self._view.log("backup %s written", name)
        return tuple(remarks)

    def _write(self, kind: type[C], job: Callable[[C], None]) -> None:
        self._contact.ask_one_who(kind, lambda able: self._while_writing(lambda: job(able)))

    # From here on: in the thread of the port.

    def _settle_half_written(self, remarks: Sequence[str], name: str, source: str | None) -> Iterator[str]:
        """Note that what was half written is whole again by a restore, or yield why it isn't; source: as above."""
        now = self._view.now
        if now.half_written is None:
            return
        if any(isinstance(each, Unwritten) for each in remarks):
            yield NOT_WHOLE
        elif now.lacks_backup is not None and source is not None and not self._backups.are_in(source):
            yield NOT_ITS_OWN.format(name=now.lacks_backup)
        elif now.lacks_backup is not None and name > now.lacks_backup:
            yield STILL_LACKS.format(name=now.lacks_backup)
        else:
            self._view.change(lambda view: replace(view, half_written=None, lacks_backup=None))

    def note_progress(self, progress: Progress) -> None:
        """Show how far a push has come."""
        if self._watch.is_writing:
            self._show(progress)

    def _push(self, send: SendPush) -> PushReport:
        reports: list[PushReport] = []
        self._while_writing(lambda: reports.append(send()))
        report = replace(reports[0], warnings=(*reports[0].warnings, *self._unwritten()))
        self._view.change(lambda view: replace(view, pushed=report))
        self._view.log("ramps pushed, %d bytes, %s", report.bytes, "kept" if report.kept else "on trial")
        # Of the device that is told as long as it holds; the report of a push stays as it is.
        pending = self._view.now.unproven_words
        return replace(report, warnings=(*report.warnings, pending)) if pending else report

    def _unwritten(self) -> Iterator[str]:
        """Yield that what is to be proven isn't written down, where it isn't."""
        if self._view.now.unproven and (trouble := self._proving.trouble) is not None:
            yield trouble

    def _while_writing(self, job: Callable[[], None], unsaved: Callable[[str], None] | None = None) -> None:
        """Write at rest, once what the controller has is saved.

        unsaved: told why that can't be read, which is then no hindrance: it is what a restore is to mend.
        """
        self._watch.refuse_under_way()
        self._leases.drop()
        self._watch.is_writing = True
        self._view.change(lambda view: replace(view, state=DeviceState.WRITING, shuttle=None))
        is_lost = False
        try:
            self._save_first(unsaved)
            self._give(job)
        except DeviceLost:
            is_lost = True
            raise
        finally:
            self._watch.is_writing = False
            self._show(None)
            # Lost in the midst of it, it stays writing in view: so it is told what was going on.
            if not is_lost:
                self._look_again()

    def _look_again(self) -> None:
        """Show how the controller fares once it was written to; that it is lost by then takes no report away."""
        try:
            self._watch.refresh()
        except StepRampError as error:
            self._view.change(lambda view: replace(view, state=DeviceState.READY))
            self._contact.lose(error)

    def _give(self, job: Callable[[], None]) -> None:
        try:
            job()
        except DeviceLost:
            self._view.change(DeviceView.left_half_written)
            raise
        finally:
            self._proving.note(self._contact.controller)

    def _save_first(self, unsaved: Callable[[str], None] | None) -> None:
        """Save what the controller has, before it is written to for the first time over this connection."""
        controller = self._contact.controller
        if not isinstance(controller, BacksUp) or controller is self._saved:
            return
        try:
            text = controller.backup()
        except Refused as error:
            if unsaved is None:
                raise
            unsaved(f"What the controller had before isn't saved, since it can't be read: {error}")
        else:
            self._save(controller, text)

    def _save_at_rest(self, controller: BacksUp) -> None:
        self._watch.refuse_under_way()
        self._save(self._contact.controller, controller.backup())

    def _save(self, controller: Controller, text: str) -> None:
        name = self._backups.save(text)
        self._saved = controller
        self._view.change(lambda view: replace(view, backup=name))
        self._view.log("backup %s saved", name)

    def _show(self, progress: Progress | None) -> None:
        self._view.change(lambda view: replace(view, progress=progress))


def _with(deviation: Deviation | None, told: Told) -> Told:
    """Return what is told of a push, with how far the controller's own ramps are off."""
    if deviation is None:
        return told
    why_not: tuple[str, ...] = () if deviation.why_not is None else (deviation.why_not,)
    return replace(told, largest_deviation_us=deviation.largest_us, warnings=(*told.warnings, *why_not))
