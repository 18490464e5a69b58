"""A device: one controller at one port, its state, and what can be asked of it from any thread."""

from collections.abc import Callable, Collection, Mapping, Sequence
from concurrent.futures import Future
from contextlib import AbstractContextManager
from pathlib import Path

from stepramp.controllers.capabilities import HasSettings, TellsSettings, refusal
from stepramp.controllers.contract import AxisCommand, NextTrace, PushMode, PushPreview, PushReport, Trace
from stepramp.controllers.families import FAMILIES, Family
from stepramp.controllers.read_axis import ReadAxis
from stepramp.controllers.surroundings import Surroundings, SurroundingsChange
from stepramp.design import Design
from stepramp.devices.attachment import Attachment
from stepramp.devices.backups import Backups, Saved, Source
from stepramp.devices.contact import Contact
from stepramp.devices.control import Control
from stepramp.devices.homing import Homing, Homings
from stepramp.devices.leases import Lease, Leases
from stepramp.devices.live_view import LiveView
from stepramp.devices.motions import Motions
from stepramp.devices.owed_stops import OwedStops
from stepramp.devices.permit import Permit
from stepramp.devices.proving import Proving
from stepramp.devices.runs import Runs
from stepramp.devices.setting_out import SettingOut
from stepramp.devices.shuttle import Shuttle
from stepramp.devices.soft_limits import Span
from stepramp.devices.stopping import Stopping
from stepramp.devices.stops import Order, Stops
from stepramp.devices.surroundings import VirtualSurroundings
from stepramp.devices.to_and_fro import ToAndFro
from stepramp.devices.traces import Traces
from stepramp.devices.unproven import Unproven
from stepramp.devices.view import DeviceState, DeviceView
from stepramp.devices.watch import Watch
from stepramp.devices.writing import PlanPush, SendPush, Writing
from stepramp.errors import Rejected, Rejection
from stepramp.link.ports import Port, location_of
from stepramp.link.remote_ports import RemotePorts
from stepramp.validation import Document


class Device:
    """One controller at one port. Its worker owns the port; all calls here may come from any thread.

    known: its port. family: of the controller there. remote_ports: those of other machines that may be opened. order:
    of all that is asked and stopped. stops_of_all: stops that are for each device. owed: stops that no controller has
    granted yet. changed: called from any thread after each change of the view. data: the folder of what outlasts the
    program. learn_board: told what is plugged in, where that is known only once the port is held; Refused where that is
    another device. before: what was known of what is plugged in there when it was last let go of; learn_board returns
    the same.

    What sets motors moving takes `request_number`: when it was asked for, in that order; None: now. It is refused when
    a stop came after that. What the controller can't do, since it hasn't got the capability, is Refused in plain words.
    """

    def __init__(
        self,
        device_id: str,
        known: Port,
        family: Family,
        remote_ports: RemotePorts,
        order: Order,
        stops_of_all: Stops,
        owed: OwedStops,
        changed: Callable[[], None],
        data: Path,
        learn_board: Callable[[Port], DeviceView | None],
        before: DeviceView | None = None,
    ) -> None:
        self._family = family
        stops = Stops(order, stops_of_all)
        view = DeviceView(device_id, known.port, known.name, family.name, stops=stops.last)
        if before is not None:
            view = view.known_before(before)
        live, leases, permit = LiveView(view, changed), Leases(), Permit(stops)
        contact = Contact(live, family)
        watch = Watch(live, contact)
        stopping = Stopping(live, contact, watch, leases, stops, permit, owed, known)
        setting_out = SettingOut(live, contact, watch, leases, permit, stopping, order)
        control = Control(live)
        runs = Runs(live, contact, leases, stopping)
        to_and_fro = ToAndFro(live, contact, watch, control, setting_out, stops)
        self._surroundings = VirtualSurroundings(live, contact, watch)
        self._homings = Homings(live, contact, watch, leases, control, setting_out)
        self._learn_board_of, self._backups = learn_board, (backups := Backups(data, family.name, known))
        proving = Proving(live, Unproven(backups.folder, backups.former))
        writing = Writing(live, contact, watch, leases, backups, proving, family.play_own)
        self._live, self._control, self._stopping, self._runs, self._proving = live, control, stopping, runs, proving
        self._to_and_fro, self._writing, self._traces = to_and_fro, writing, Traces(contact, watch)
        self._motions = Motions(live, contact, watch, leases, control, setting_out)
        self._attachment = Attachment(
            known,
            family,
            remote_ports,
            live,
            contact,
            watch,
            leases,
            permit,
            stopping,
            runs,
            to_and_fro,
            self._homings,
            writing,
            proving,
            self._learn_board,
        )

    def _learn_board(self, known: Port) -> None:
        """Take what is plugged in for its board, with all that is known of that; in the thread of the port."""
        before = self._learn_board_of(known)
        self._backups.know(known)
        self._proving.know(Unproven(self._backups.folder, self._backups.former))
        if before is not None:
            self._live.change(lambda view: view.known_before(before))

    @property
    def view(self) -> DeviceView:
        """The device as it is now."""
        return self._live.now

    @property
    def called(self) -> str:
        """What tells it apart, as people read it: its USB serial number, else its port or host."""
        return self._attachment.called

    @property
    def identity(self) -> object:
        """What tells apart what is plugged in, and of what kind of controller it is taken to be; see Port."""
        return self._family.kind, self.known.board

    @property
    def known(self) -> Port:
        """What is known of its port and what is plugged in there."""
        return self._attachment.known

    def is_board(self, known: Port) -> bool:
        """Whether what is plugged in at a port is that of this device, as far as that is told apart."""
        return known.is_board_of(self.known)

    @property
    def location(self) -> str:
        """Where its port leads, whatever name it was given: that which it holds, or which it would be connected at."""
        return self._attachment.location or location_of(self.view.port)

    def is_other(self, known: Port) -> bool:
        """Whether it is lost, and another board is plugged in at a port where it would be connected again."""
        return self.view.state is DeviceState.LOST and self._attachment.is_other(known)

    def note_other(self, known: Port, device_id: str) -> None:
        """Tell, while it is lost, that another board is at its port, and as which device."""
        self._live.change(lambda view: view.displaced(known.called if known.unit else known.name, device_id))

    def forget_other(self, device_id: str) -> None:
        """Tell no more of a device that is forgotten as of the one at its port."""
        self._live.change(lambda view: view.displaced_no_more(device_id))

    @property
    def connected(self) -> bool:
        """Whether the handshake is done and the device not lost."""
        return self._attachment.is_connected

    def connect(self, port: str | None = None) -> None:
        """Open the port and shake hands, unless that is done already; nothing moves.

        port: where it is plugged in now, in case that is elsewhere than it was; None: there.
        Whoever asks for it meanwhile gets what comes of it. Raises Rejected for an address that is no port, Refused for
        a controller of another kind, DeviceLost when none answers.
        """
        self._attachment.connect(port)

    def reconnect(self) -> bool:
        """Connect again if what was lost is back, at its port or, known by its serial number, at another.

        Returns whether it is back. Raises as connect. Nothing moves.
        """
        return self._attachment.reconnect()

    def disconnect(self) -> None:
        """Let go of the port; Refused while the motor moves. A device that is lost is let go of, too."""
        self._attachment.disconnect()

    def shut_down(self) -> None:
        """Let go of the port, whatever is going on: for the end of the program."""
        self._attachment.shut_down()

    def end_motion(self) -> None:
        """Stop the motor for good: nothing moves it any more. For the end of the program."""
        self._attachment.refuse_from_now_on()
        self._stopping.end()

    def take_control(self, page: str, place: str | None = None, *, over: bool = False) -> None:
        """Put a page in control; Refused while another one is, unless it is taken over: that ends what others run.

        place: where the page is, if that is known.
        """
        self._control.take(page, place, over=over)

    def refuse_others(self, page: str) -> None:
        """Refused while a page other than this one is in control."""
        self._control.refuse_others(page)

    def leave_control(self, page: str) -> None:
        """Note that a page is gone: nobody is in control if it was, and what it runs ends."""
        self._control.leave(page)

    def preview_push(self, designs: Sequence[Design], first_axis: int | None = None) -> PushPreview:
        """Return what a push would change; see Controller."""
        return self._writing.preview_push(designs, first_axis)

    def push(
        self,
        designs: Sequence[Design],
        first_axis: int | None = None,
        mode: PushMode = "keep",
        planned: Callable[[PlanPush], SendPush] = lambda plan: plan(),
    ) -> PushReport:
        """Have the controller use the designs' ramps, and store them or not; see Controller.prepare_push.

        planned: does the planning, which computes a lot, where and when it may be done.
        """
        return self._writing.push(designs, first_axis, mode, planned)

    def keep(self) -> tuple[str, ...]:
        """Store the ramps and settings in use; see StoresRamps."""
        return self._writing.keep()

    def roll_back(self) -> None:
        """Use the stored ramps and settings again; see TriesRamps."""
        self._writing.roll_back()

    def restore(self) -> None:
        """Make the ramps and settings that were stored before the stored ones; see RestoresRamps."""
        self._writing.restore()

    def backups(self) -> Saved:
        """Return what was saved of it before it was written to; see BacksUp."""
        return self._writing.backups()

    def saved_text(self, name: str) -> str:
        """Return a backup; NotFound when there is none of that name."""
        return self._writing.saved_text(name)

    def back_up(self) -> None:
        """Save what the device has now; see BacksUp."""
        self._writing.back_up()

    def restore_backup(self, name: str) -> tuple[str, ...]:
        """Write what a backup says, and return what couldn't be, as sentences; see BacksUp."""
        return self._writing.restore_backup(name)

    def restore_from(self, source: Source, name: str, text: str) -> tuple[str, ...]:
        """Write a backup of any device of the same kind; Rejected for that of another one. As restore_backup."""
        theirs = FAMILIES.get(source.family)
        if self._family.kind not in (source.family, theirs and theirs.kind):
            of = f"a source of the family {self._family.kind}, as the device is"
            raise Rejected([Rejection("source", source.name, of)])
        return self._writing.restore_text(text, name, source.name)

    def prove(self) -> None:
        """Start the controller anew, and see whether it has stored what it was given: its view tells that.

        It forgets where it is by that. Refused while the motor moves, where something may move by a start, and where
        nothing is to be proven; also afterwards, when it wasn't heard to start. Else as connect.
        """
        self._proving.refuse_unneeded()
        self._attachment.start_anew()
        self._proving.refuse_unseen()

    def present_designs(self, base: Design) -> list[ReadAxis]:
        """Return what the controller has now as designs, one for each axis; Refused when its family can't be read.

        base: what holds where a controller says nothing.
        """
        if self._family.read_settings is None:
            raise refusal(TellsSettings, self.view.name, self._family.title)
        return self._family.read_settings(self._writing.present_text(), base)

    @property
    def settings_model(self) -> type[Document]:
        """What the settings of its family are a document of; Refused when it has none."""
        if self._family.settings is None:
            raise refusal(HasSettings, self.view.name, self._family.title)
        return self._family.settings

    def settings(self) -> Document:
        """Ask for the settings in use; see HasSettings."""
        return self._writing.settings()

    def use_settings(self, settings: Document) -> None:
        """Use other settings until a roll back or a reset; see HasSettings."""
        self._writing.use_settings(settings)

    def limit(self, spans: Mapping[int, Span]) -> None:
        """Keep these axes within soft limits from now on, the others within theirs; Refused while the motor moves."""
        self._motions.limit(spans)

    def move_by(self, steps: Sequence[AxisCommand], request_number: int | None = None) -> None:
        """Begin to move axes by so many steps; see Controller. Rejected also when they lead beyond soft limits."""
        self._motions.move_by(steps, request_number)

    def move_to(self, positions: Sequence[AxisCommand], request_number: int | None = None) -> None:
        """Begin to move axes to positions [steps]; see Controller. Rejected also when they lie beyond soft limits."""
        self._motions.move_to(positions, request_number)

    def line(
        self, steps: Sequence[AxisCommand], ramp_axis: int | None = None, request_number: int | None = None
    ) -> None:
        """Begin to move axes along a straight line; see DrawsLines. Rejected also when it leads beyond soft limits."""
        self._motions.line(steps, ramp_axis, request_number)

    def run(self, speeds: Sequence[AxisCommand], lease: Lease, request_number: int | None = None) -> None:
        """Run axes at speeds [steps/s] as long as a lease holds, then slow them down; see Controller.run.

        Rejected also for a speed that leads out of soft limits, Refused when the lease ran out before it came to that.
        """
        self._motions.run(speeds, lease, request_number)

    def renew_run(self, lease: Lease, request_number: int | None = None) -> None:
        """Let a run go on as a new lease of the same name says; Refused once that which it runs on has run out."""
        self._motions.renew_run(lease, request_number)

    def end_run(self, lease: Lease) -> None:
        """Slow axes down that run on a lease, before anything else that was asked for."""
        self._runs.end(lease)

    def go_there_and_back(self, shuttle: Shuttle, leg: AxisCommand, request_number: int | None = None) -> None:
        """Begin to go to and fro, from rest, until it is done or something else is asked for.

        leg: how far, with what rejections call it. Raises as move_by.
        """
        self._to_and_fro.begin(shuttle, leg, request_number)

    def set_position(self, positions: Sequence[AxisCommand]) -> None:
        """Call the places where axes are these positions [steps]; see Controller."""
        self._motions.set_position(positions)

    def zero(self, axes: Collection[int], steps: int, request_number: int | None = None) -> None:
        """Call the places where axes are so many steps and move them to 0; see ZeroesGauges."""
        self._motions.zero(axes, steps, request_number)

    def home(self, homing: Homing, lease: Lease, request_number: int | None = None) -> None:
        """Have axes find their limit switches as long as a lease holds; see HasInputs.

        Soft limits don't hold meanwhile. Refused when the lease ran out before it came to that.
        """
        self._homings.begin(homing, lease, request_number)

    def acknowledge(self, request_number: int | None = None) -> None:
        """Let motions be taken again after an emergency stop or a driver's fault; see HasInputs.

        Refused when a stop came after it was asked for, as a motion: nobody may have meant it any more.
        """
        self._homings.acknowledge(request_number)

    def surroundings(self) -> Surroundings:
        """Return what is around a virtual device; Refused of any other."""
        return self._surroundings.now()

    def change_surroundings(self, change: SurroundingsChange) -> Surroundings:
        """Press, release and put elsewhere what is around a virtual device; Refused of any other."""
        return self._surroundings.change(change)

    def trace_moves(self, axis: int | None, every_steps: int) -> NextTrace:
        """Trace every so many-th step of each move of an axis from now on; see TracesMoves."""
        return self._traces.of_moves(axis, every_steps)

    def trace(self) -> Trace:
        """Return the trace of the last move that was traced, as far as it is known; Refused before there was one."""
        return self._traces.last()

    def trace_as_csv(self) -> str:
        """Return that trace as a captured file; Refused unless it has each step."""
        return self._traces.last_as_csv()

    def being_stopped(self) -> AbstractContextManager[None]:
        """Let nothing move while a stop is being answered, nor afterwards what was asked until then."""
        return self._stopping.being_stopped()

    def stop(self, axes: Collection[int] | None = None) -> "Future[None]":
        """Slow axes, or all, down with the ramp, before anything else that was asked for; return the result to come.

        What was asked before moves nothing any more. Until it is granted it is owed: a device that is not connected, or
        turns out to be lost, is stopped as soon as it is there again. Of that, Refused and DeviceLost tell. NotStopped
        where its controller refuses: that is owed until it rests, or sets out anew, and its view tells why.
        """
        return self._stopping.stop(axes)

    def halt(self, axes: Collection[int] | None = None) -> "Future[None]":
        """Make no further step, before anything else that was asked for; else as stop."""
        return self._stopping.halt(axes)

    def show_stops(self) -> None:
        """Tell the number of the last stop."""
        self._stopping.show()
