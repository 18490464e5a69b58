"""A device: one controller at one port, its state, and what can be asked of it from any thread."""

import logging
import threading
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from concurrent.futures import Future
from contextlib import contextmanager, suppress
from dataclasses import replace
from time import monotonic
from typing import TypeVar

from stepramp.controllers.capabilities import (
    DrawsLines,
    HasSettings,
    RestoresRamps,
    StoresRamps,
    TracesMoves,
    TriesRamps,
    ZeroesGauges,
    capabilities_of,
    capable,
    refusal,
)
from stepramp.controllers.contract import (
    Asked,
    Controller,
    ControllerStatus,
    PushMode,
    PushPreview,
    PushReport,
    Trace,
)
from stepramp.controllers.families import Family
from stepramp.controllers.progress import Progress, PushStage
from stepramp.design import Design
from stepramp.devices.leases import Lease, Leases
from stepramp.devices.limit_checks import (
    refuse_absent,
    refuse_limited,
    refuse_outward,
    refuse_running,
    refuse_targets,
    refuse_there_and_back,
    too_near,
)
from stepramp.devices.owed_stops import OwedStops
from stepramp.devices.permit import Permit
from stepramp.devices.shared_attempt import SharedAttempt
from stepramp.devices.shuttle import Shuttle
from stepramp.devices.soft_limits import Span
from stepramp.devices.stops import Order, Stops
from stepramp.devices.view import UNDER_WAY, DeviceState, DeviceView
from stepramp.errors import DeviceLost, Refused, Rejected, StepRampError
from stepramp.link.connection import Connection
from stepramp.link.ports import Port, find_again, known_port, place_of, port_name
from stepramp.link.worker import Worker
from stepramp.validation import Document

LISTEN_S = 1 / 50
"""How often a device that moves is listened to: as often as it reports."""
HEARTBEAT_S = 1 / 3
"""So often a controller is asked while it moves [s]: what runs at a speed stops when nobody asks any more."""
SILENCE_S = 1 / 10
"""A device that moves and doesn't report for so long is asked."""
IDLE_POLL_S = 1 / 2
"""Often enough to notice soon that a device was unplugged."""
LAST_STOP_S = 1.5
"""How long the end of the program waits for a stop to be granted [s]."""

_logger = logging.getLogger(__name__)

C = TypeVar("C")
T = TypeVar("T")
SendPush = Callable[[], PushReport]


class Device:
    """One controller at one port. Its worker owns the port; all calls here may come from any thread.

    known: its port. family: of the controller there. order: of all that is asked and stopped. stops_of_all: stops that
    are for each device. owed: stops that no controller has granted yet. changed: called from any thread after each
    change of the view. before: what was known of what is plugged in there when it was last let go of.

    What sets motors moving takes `asked`: when it was asked for, in that order; None: now. It is refused when a stop
    came after that.
    """

    def __init__(
        self,
        device_id: str,
        known: Port,
        family: Family,
        order: Order,
        stops_of_all: Stops,
        owed: OwedStops,
        changed: Callable[[], None],
        before: DeviceView | None = None,
    ) -> None:
        self._changed = changed
        self._order = order
        self._stops = Stops(order, stops_of_all)
        self._owed = owed
        # It may be found at another port later, and yet owes what it owed.
        self._owes_at = known.port
        self._lock = threading.Lock()
        self._connecting = threading.Lock()
        self._attempt = SharedAttempt(self._connect_unless_done)
        self._view = DeviceView(device_id, known.port, known.name, family.name, stops=self._stops.last)
        if before is not None:
            self._view = replace(self._view, soft_limits=before.soft_limits, unknown_positions=before.unknown_positions)
        self._port: Connection | None = None
        self._controller: Controller | None = None
        self._worker: Worker | None = None
        self._known_port = known
        self._family = family
        self._place: str | None = None
        self._let_go = False
        self._ended = False
        self._leases = Leases()
        # From here on: of the worker's thread.
        self._pushing = False
        self._permit = Permit(self._stops)
        self._asked_s = 0.0
        self._is_view_old = False
        self._is_ending_runs = False

    @property
    def view(self) -> DeviceView:
        """The device as it is now."""
        with self._lock:
            return self._view

    @property
    def identity(self) -> object:
        """What tells what is plugged in apart; see Port."""
        return self._known_port.identity

    @property
    def place(self) -> str | None:
        """Where the port leads that it holds, whatever name it was given; None: it holds none."""
        return self._place

    @property
    def connected(self) -> bool:
        """Whether the handshake is done and the device not lost."""
        return self.view.state not in (DeviceState.CONNECTING, DeviceState.LOST)

    def connect(self) -> None:
        """Open the port and shake hands, unless that is done already; nothing moves.

        Whoever asks for it meanwhile gets what comes of it. Raises Rejected for an address that is no port, Refused for
        a controller of another kind, DeviceLost when none answers.
        """
        self._attempt()

    def reconnect(self) -> bool:
        """Connect again if what was lost is back, at its port or, known by its serial number, at another.

        Returns whether it is back. Raises as connect. Nothing moves.
        """
        port = find_again(self._known_port)
        if port is None:
            return False
        with self._connecting:
            if not self.connected and not self._let_go:
                self._connect(port)
            return True

    def disconnect(self) -> None:
        """Let go of the port; Refused while the motor moves. A device that is lost is let go of, too."""
        with self._connecting:
            if self.connected:
                with suppress(DeviceLost):
                    self._ask(lambda _: self._end_at_rest())
            self._let_go = True
            self._close()

    def shut_down(self) -> None:
        """Let go of the port, whatever is going on: for the end of the program."""
        self._let_go = True
        if (worker := self._worker) is not None:
            worker.close(LAST_STOP_S)

    def end_motion(self) -> None:
        """Stop the motor for good: nothing moves it any more. For the end of the program."""
        self._ended = True
        self._stops.end()
        # Whatever hinders it, there is no second chance.
        with suppress(StepRampError, TimeoutError):
            self.stop().result(LAST_STOP_S)

    def take_control(self, page: str, *, over: bool = False) -> None:
        """Put a page in control; Refused while another one is, unless it is taken over: that ends what others run."""

        def taken(view: DeviceView) -> DeviceView:
            if not over:
                _refuse_others(view, page)
            return replace(view, in_control=page)

        self._change(taken)

    def refuse_others(self, page: str) -> None:
        """Refused while a page other than this one is in control."""
        _refuse_others(self.view, page)

    def leave_control(self, page: str) -> None:
        """Note that a page is gone: nobody is in control if it was, and what it runs ends."""
        self._change(lambda view: replace(view, in_control=None) if view.in_control == page else view)

    def preview_push(self, designs: Sequence[Design], first_axis: int | None = None) -> PushPreview:
        """Return what a push would change, without the port; see Controller."""
        return self._ready()[0].preview_push(designs, first_axis)

    def push(
        self,
        designs: Sequence[Design],
        first_axis: int | None = None,
        mode: PushMode = "keep",
        planned: Callable[[Callable[[], SendPush]], SendPush] = lambda plan: plan(),
    ) -> PushReport:
        """Have the controller use the designs' ramps, and store them or not; see Controller.prepare_push.

        planned: does the planning, which computes a lot, where and when it may be done.
        """
        connection = controller, worker = self._ready()
        self._capable(controller, StoresRamps if mode == "keep" else TriesRamps)
        if self.view.state in UNDER_WAY:
            raise Refused("The motor moves: stop it first.")
        self._change(lambda view: replace(view, progress=Progress(PushStage.PLANNING, 0, 0)))
        try:
            send = planned(lambda: controller.prepare_push(designs, first_axis, mode))
            if self._ready() != connection:
                raise Refused("The device was lost and connected again in the meantime: push again.")
            return worker.call(lambda: self._push(send))
        finally:
            self._change(lambda view: replace(view, progress=None))

    def keep(self) -> None:
        """Store the ramps and settings in use; see StoresRamps."""
        self._write(StoresRamps, lambda controller: controller.keep())

    def roll_back(self) -> None:
        """Use the stored ramps and settings again; see TriesRamps."""
        self._write(TriesRamps, lambda controller: controller.roll_back())

    def restore(self) -> None:
        """Make the ramps and settings that were stored before the stored ones; see RestoresRamps."""
        self._write(RestoresRamps, lambda controller: controller.restore())

    @property
    def settings_model(self) -> type[Document]:
        """What the settings of its family are a document of; Refused when it has none."""
        if self._family.settings is None:
            raise refusal(HasSettings, self.view.name, self._family.title)
        return self._family.settings

    def settings(self) -> Document:
        """Ask for the settings in use; see HasSettings."""
        settings: Document = self._ask_one_who(HasSettings, lambda controller: controller.settings())
        return settings

    def use_settings(self, settings: Document) -> None:
        """Use other settings until a roll back or a reset; see HasSettings."""
        self._write(HasSettings, lambda controller: controller.use_settings(settings))

    def limit(self, spans: Mapping[int, Span]) -> None:
        """Keep these axes within soft limits from now on, the others within theirs; Refused while the motor moves."""

        def limit(_: Controller) -> None:
            self._refuse_under_way()
            refuse_absent(self.view, spans)
            self._change(lambda view: view.limited(spans))

        self._ask(limit)

    def move_by(self, steps: Sequence[Asked], asked: int | None = None) -> None:
        """Begin to move axes by so many steps; see Controller. Rejected also when they lead beyond soft limits."""

        def begin(controller: Controller) -> None:
            refuse_running(self.view, self._leases.speeds, steps)
            refuse_targets(self.view, steps, relative=True)
            controller.move_by(steps)

        self._set_out(f"move by {_told(steps)}", _axes_of(steps), begin, asked)

    def move_to(self, positions: Sequence[Asked], asked: int | None = None) -> None:
        """Begin to move axes to positions [steps]; see Controller. Rejected also when they lie beyond soft limits."""

        def begin(controller: Controller) -> None:
            refuse_targets(self.view, positions, relative=False)
            controller.move_to(positions)

        self._set_out(f"move to {_told(positions)}", _axes_of(positions), begin, asked)

    def line(self, steps: Sequence[Asked], ramp_axis: int | None = None, asked: int | None = None) -> None:
        """Begin to move axes along a straight line; see Controller. Rejected also when it leads beyond soft limits."""

        def begin(controller: Controller) -> None:
            able = self._capable(controller, DrawsLines)
            refuse_targets(self.view, steps, relative=True)
            able.line(steps, ramp_axis)

        self._set_out(f"line by {_told(steps)}", _axes_of(steps), begin, asked)

    def run(self, speeds: Sequence[Asked], lease: Lease, asked: int | None = None) -> None:
        """Run axes at speeds [steps/s] as long as a lease holds, then slow them down; see Controller.run.

        Rejected also for a speed that leads out of soft limits, Refused when the lease ran out before it came to that.
        """

        def begin(controller: Controller) -> None:
            self._refuse_without(lease.page)
            if not lease.holds:
                raise Refused("It was let go before it began; nothing moved.")
            refuse_outward(self.view, speeds, controller.steps_to_rest)
            controller.run(speeds)

        self._set_out(f"run at {_told(speeds)}", _axes_of(speeds), begin, asked, lease)

    def end_run(self, lease: Lease) -> None:
        """Slow axes down that run on a lease, before anything else that was asked for."""
        lease.end()
        with suppress(StepRampError):
            _, worker = self._ready()
            worker.call_urgently(self._let_runs_end, overtakes=False)

    def go_there_and_back(self, shuttle: Shuttle, way: Asked, asked: int | None = None) -> None:
        """Begin to go to and fro, from rest, until it is done or something else is asked for.

        way: how far, with what rejections call it. Raises as move_by.
        """
        shuttle = replace(shuttle, asked=self._now() if asked is None else asked)

        def begin(controller: Controller) -> None:
            self._refuse_without(shuttle.page)
            self._refuse_under_way()
            refuse_there_and_back(self.view, way)
            controller.move_by([way])

        what = f"go there and back by {_told([way])}"
        self._set_out(what, [shuttle.axis], begin, shuttle.asked, then=lambda: self._show_leg(shuttle))

    def set_position(self, positions: Sequence[Asked]) -> None:
        """Call the places where axes are these positions [steps]; see Controller."""
        axes = _axes_of(positions)

        def set_position(controller: Controller) -> None:
            self._newly(axes, lambda: controller.set_position(positions), then=lambda: self._know_positions(axes))

        self._ask(set_position)

    def zero(self, axes: Collection[int], steps: int, asked: int | None = None) -> None:
        """Call the places where axes are so many steps and move them to 0; see Controller."""

        def begin(controller: Controller) -> None:
            able = self._capable(controller, ZeroesGauges)
            refuse_limited(self.view, axes)
            able.zero(axes, steps)

        what = f"zero from {steps} steps on: axes {sorted(axes)}"
        self._set_out(what, axes, begin, asked, then=lambda: self._know_positions(axes))

    def trace_moves(self, axis: int | None, every_steps: int) -> int:
        """Trace every so many-th step of each move of an axis from now on; see Controller."""
        return self._ask_one_who(TracesMoves, lambda controller: controller.trace_moves(axis, every_steps))

    def trace(self) -> Trace:
        """Return the trace of the last move that was traced, as far as it is known; Refused before there was one."""
        work_out = self._ask_one_who(TracesMoves, self._trace)
        if work_out is None:
            raise Refused("No move has been traced yet: ask for a trace, then move.")
        return work_out()

    @contextmanager
    def being_stopped(self) -> Iterator[None]:
        """Let nothing move while a stop is being answered, nor afterwards what was asked until then."""
        try:
            with self._stops.unanswered():
                self.show_stops()
                yield
        finally:
            self.show_stops()

    def stop(self, axes: Collection[int] | None = None) -> "Future[None]":
        """Slow axes, or all, down with the ramp, before anything else that was asked for; return the result to come.

        What was asked before moves nothing any more. Until it is granted it is owed: a device that is not connected, or
        turns out to be lost, is stopped as soon as it is there again. Of that, Refused and DeviceLost tell.
        """
        owed = self._owe_stop("stop", axes)
        controller, worker = self._ready_to_stop()
        return worker.call_urgently(lambda: self._stop(axes, controller.stop, owed))

    def halt(self, axes: Collection[int] | None = None) -> "Future[None]":
        """Make no further step, before anything else that was asked for; else as stop."""
        owed = self._owe_stop("halt", axes)
        controller, worker = self._ready_to_stop()
        return worker.call_urgently(lambda: self._halt(axes, controller, owed))

    def show_stops(self) -> None:
        """Tell the number of the last stop."""
        self._change(lambda view: replace(view, stops=self._stops.last))

    def _log(self, words: str, *values: object) -> None:
        _logger.info(f"Device %s at %s: {words}", self.view.id, self.view.port, *values)

    def _now(self) -> int:
        return self._order.next()

    def _owe_stop(self, what: str, axes: Collection[int] | None) -> int:
        self._log("%s of %s asked for", what, "all axes" if axes is None else f"axes {sorted(axes)}")
        owed = self._owed.owe(self._owes_at)
        self._stops.note()
        self.show_stops()
        return owed

    def _set_out(
        self,
        what: str,
        axes: Collection[int],
        begin: Callable[[Controller], None],
        asked: int | None,
        lease: Lease | None = None,
        then: Callable[[], None] = lambda: None,
    ) -> None:
        """Have the worker set axes in motion, if no stop has come since it was asked for."""
        at = self._now() if asked is None else asked

        def set_out(controller: Controller) -> None:
            self._newly(axes, lambda: self._permitted(axes, at, lambda: begin(controller)), lease, then)

        try:
            self._ask(set_out)
        except StepRampError as error:
            self._log("%s: refused: %s", what, error)
            raise
        self._log("%s: begun", what)

    def _ready(self) -> tuple[Controller, Worker]:
        """Return controller and worker; raises when there are none to be asked."""
        with self._lock:
            view, controller, worker = self._view, self._controller, self._worker
        if view.state is DeviceState.LOST:
            raise DeviceLost(view.message or f"Port {view.port} is not connected.")
        if controller is None or worker is None or view.state is DeviceState.CONNECTING:
            raise Refused(f"{view.name} is still being connected.")
        return controller, worker

    def _ready_to_stop(self) -> tuple[Controller, Worker]:
        """Return as _ready does, also while what the controller has is still being read."""
        with self._lock:
            controller, worker = self._controller, self._worker
        return self._ready() if controller is None or worker is None else (controller, worker)

    def _write(self, kind: type[C], job: Callable[[C], None]) -> None:
        self._ask_one_who(kind, lambda able: self._while_writing(lambda: job(able)))

    def _ask_one_who(self, kind: type[C], job: Callable[[C], T]) -> T:
        """Have the worker do what not every controller can; Refused before anything is done when this one can't."""
        controller, worker = self._ready()
        able = self._capable(controller, kind)
        return worker.call(lambda: job(able))

    def _capable(self, controller: Controller, kind: type[C]) -> C:
        return capable(controller, kind, self.view.name, self._family.title)

    def _ask(self, job: Callable[[Controller], T]) -> T:
        """Have the worker do a job with its controller: over this connection, or not at all."""
        controller, worker = self._ready()
        return worker.call(lambda: job(controller))

    def _connect(self, port: str) -> None:
        name = port_name(port)
        self._change(lambda view: view.anew(port, name))
        self._worker = Worker(port, self._poll, self._ended_by)
        try:
            if self._ended:
                raise Refused("StepRamp is ending: nothing is connected any more.")
            self._worker.call(self._open)
        except Exception as error:
            self._worker.close()
            reason = str(error)
            self._change(lambda view: view.at_a_loss(reason))
            raise
        self._known_port = known_port(port)

    def _connect_unless_done(self) -> None:
        with self._connecting:
            self._let_go = False
            if not self.connected:
                self._connect(self.view.port)

    def _close(self) -> None:
        if self._worker is not None:
            self._worker.close()

    def _change(self, change: Callable[[DeviceView], DeviceView]) -> None:
        """Put a changed view in place of the present one: at once, since several threads change it."""
        with self._lock:
            before = self._view
            self._view = change(before)
            changed = self._view != before
        if changed:
            self._changed()

    # From here on: in the worker's thread.

    def _open(self) -> None:
        assert self._worker is not None
        self._port = self._family.open(self.view.port, self._permit.check)
        self._place = place_of(self.view.port)
        controller = self._family.make(self._port, self._give_way, self._note_progress)
        controller.connect(lambda: self._begin_with_stop(controller))
        status = controller.status()
        with self._lock:
            self._view = replace(
                self._view,
                firmware_version=controller.firmware_version,
                clocks_hz=controller.clocks_hz,
                capabilities=capabilities_of(controller),
            )
        self._show(status)
        self._log("connected, firmware %s", controller.firmware_version)

    def _begin_with_stop(self, controller: Controller) -> None:
        """Let stops come to the controller from here on, and first of all tell it that which is owed."""
        with self._lock:
            self._controller = controller
        owed = self._owed.newest(self._owes_at)
        if owed is not None:
            self._stop(None, controller.stop, owed)

    def _poll(self) -> float:
        if self._controller is None or self.view.state is DeviceState.CONNECTING:
            return IDLE_POLL_S
        self._let_runs_end()
        under_way, heard_s = self.view.state in UNDER_WAY, self.view.heard_s
        if self._is_view_old or (under_way and monotonic() - self._asked_s > HEARTBEAT_S):
            self._refresh()
        elif under_way and (heard := self._controller.listen()) is not None:
            self._show(heard)
        elif monotonic() - heard_s > (SILENCE_S if under_way else IDLE_POLL_S):
            self._refresh()
        self._go_on_to_and_fro()
        return LISTEN_S if self.view.state in UNDER_WAY or self.view.shuttle else IDLE_POLL_S

    def _ended_by(self, loss: DeviceLost | None) -> None:
        if self._controller is not None and loss is None:
            with suppress(StepRampError):
                self._controller.disconnect()
        if self._port is not None:
            self._port.close()
        self._place = None
        self._leases.drop()
        with self._lock:
            self._port = self._controller = None
        self._change(lambda view: view.let_go() if loss is None else view.at_a_loss(str(loss)))
        self._log("%s", "let go of" if loss is None else f"lost: {loss}")

    def _refresh(self) -> None:
        assert self._controller is not None
        self._asked_s = monotonic()
        status = self._controller.status()
        self._is_view_old = False
        self._show(status)

    def _show(self, status: ControllerStatus) -> None:
        assert self._controller is not None
        timer_hz, now_s = self._controller.timer_hz, monotonic()

        def shown(view: DeviceView) -> DeviceView:
            view = replace(view.with_status(status), timer_hz=timer_hz, heard_s=now_s)
            # A stop may ask in the midst of a push, when the controller itself isn't writing yet.
            return replace(view, state=DeviceState.WRITING) if self._pushing else view

        self._change(shown)

    def _trace(self, controller: TracesMoves) -> Callable[[], Trace] | None:
        assert self._controller is not None
        heard = self._controller.listen()
        if heard is not None:
            self._show(heard)
        return controller.trace

    def _permitted(self, axes: Collection[int], asked: int, begin: Callable[[], None]) -> None:
        """Set axes in motion for what was asked then."""
        try:
            with self._permit.given(asked):
                begin()
        except Exception as error:
            if self._permit.may_have_set_out(error):
                # A stop of other axes doesn't end it: what is refused must not move.
                assert self._controller is not None
                self._stop(axes, self._controller.stop, self._owed.owe(self._owes_at))
            raise

    def _newly(
        self,
        axes: Collection[int],
        job: Callable[[], None],
        lease: Lease | None = None,
        then: Callable[[], None] = lambda: None,
    ) -> None:
        """Do what is asked of axes now. Once it is granted, what went on with them by itself ends."""
        if self.view.soft_limits and self.view.state in UNDER_WAY:
            # What is asked counts from where the axes would come to rest, not from where they were last heard.
            self._refresh()
        with self._permit.setting_out():
            job()
            self._leases.drop(axes)
            if lease is not None:
                self._leases.take(lease)
            self._change(lambda view: replace(view, shuttle=None))
            self._refresh()
        then()

    def _halt(self, axes: Collection[int] | None, controller: Controller, owed: int) -> None:
        """Halt axes, and look where that was."""
        self._stop(axes, controller.halt, owed)
        if self._is_view_old:
            self._refresh()

    def _stop(
        self, axes: Collection[int] | None, send: Callable[[Collection[int] | None], None], owed: int | None = None
    ) -> None:
        """Stop axes, also in the midst of what sets some in motion. Where they come to rest is looked at afterwards.

        owed: the number of the stop that is owed until it is granted.
        """
        if axes is not None and not set(axes) <= {axis.axis for axis in self.view.axes}:
            axes = None  # Whoever names an axis that isn't there means something else than we know: all stop.
        with self._permit.set_aside():
            send(axes)
            if owed is not None:
                self._owed.settle(self._owes_at, owed, of_all_axes=axes is None)
                self._log("stop granted")
            self._leases.drop(axes)
            self._is_view_old = self.view.state in UNDER_WAY
            self._change(lambda view: replace(view.stopping(axes), shuttle=None))
            if self._permit.is_unseen:
                self._refresh()

    def _give_way(self, pause_s: float = 0.0) -> None:
        """Let calls through that are more urgent, and what mustn't wait until a request has been answered."""
        assert self._worker is not None
        if not self._is_ending_runs and self._runs_to_end():
            with suppress(StepRampError):
                self._worker.call_urgently(self._let_runs_end, overtakes=False)
        self._worker.give_way(pause_s)

    def _let_runs_end(self) -> None:
        """Slow down what may run no longer."""
        axes = self._runs_to_end()
        if not axes:
            return
        assert self._controller is not None
        self._is_ending_runs = True
        try:
            self._stop(axes, self._controller.stop)
        finally:
            self._is_ending_runs = False

    def _runs_to_end(self) -> list[int]:
        """Return the axes whose lease has run out, that come too near a soft limit, or whose page is gone."""
        if self._controller is None:
            return []
        view = self.view
        near = too_near(view, self._leases.speeds, self._controller.steps_to_rest)
        left = [view.shuttle.axis] if view.shuttle and view.shuttle.page not in (None, view.in_control) else []
        return sorted({*self._leases.run_out(view.in_control), *near, *left})

    def _go_on_to_and_fro(self) -> None:
        """Set out on the next way there or back once the pause is over; it ends when it rests elsewhere."""
        shuttle = self.view.shuttle
        if shuttle is None or self.view.state is not DeviceState.READY:
            return
        assert self._controller is not None
        shuttle = shuttle.arrived()
        if shuttle.ended or self._axis_target(shuttle.axis) != shuttle.expected_steps:
            self._change(lambda view: replace(view, shuttle=None))
        elif shuttle.is_due():
            self._begin_leg(shuttle)
        else:
            self._change(lambda view: replace(view, shuttle=shuttle))

    def _begin_leg(self, shuttle: Shuttle) -> None:
        controller = self._controller
        assert controller is not None
        way = Asked(shuttle.axis, shuttle.next_by_steps, "by_steps")
        try:
            self._refuse_without(shuttle.page)
            refuse_targets(self.view, [way], relative=True)
            with self._permit.setting_out():
                self._permitted([shuttle.axis], shuttle.asked, lambda: controller.move_by([way]))
                self._refresh()
        except (Refused, Rejected):
            # A stop came, or somebody else at the controller, such as its own sketch, has begun something: it is over.
            self._change(lambda view: replace(view, shuttle=None))
            return
        self._show_leg(shuttle)

    def _show_leg(self, shuttle: Shuttle) -> None:
        """Note where the way leads that has just been begun, unless it has been stopped meanwhile."""
        if not self._stops.have_overtaken(shuttle.asked):
            on_its_way = shuttle.set_out(self._axis_target(shuttle.axis))
            self._change(lambda view: replace(view, shuttle=on_its_way))

    def _axis_target(self, axis: int) -> int:
        return self.view.axes[axis].target_steps

    def _refuse_without(self, page: str | None) -> None:
        """Refused for what ends with a page, when that is not in control."""
        if page is not None:
            self.refuse_others(page)
            if self.view.in_control != page:
                raise Refused("Nothing moved: its page is gone.")

    def _know_positions(self, axes: Collection[int]) -> None:
        self._change(lambda view: view.with_known_positions(axes))

    def _note_progress(self, progress: Progress) -> None:
        if self._pushing:
            self._change(lambda view: replace(view, progress=progress))

    def _end_at_rest(self) -> None:
        """End the thread in the same call that looks whether the motor moves, so that no move slips in between."""
        self._refuse_under_way()
        self._close()

    def _refuse_under_way(self) -> None:
        self._refresh()
        if self.view.state in UNDER_WAY:
            raise Refused("The motor moves: stop it first.")

    def _push(self, send: Callable[[], PushReport]) -> PushReport:
        reports: list[PushReport] = []
        self._while_writing(lambda: reports.append(send()))
        self._change(lambda view: replace(view, pushed=reports[0]))
        self._log("ramps pushed, %d bytes, %s", reports[0].bytes, "kept" if reports[0].kept else "on trial")
        return reports[0]

    def _while_writing(self, job: Callable[[], None]) -> None:
        self._refuse_under_way()
        self._leases.drop()
        self._pushing = True
        self._change(lambda view: replace(view, state=DeviceState.WRITING, shuttle=None))
        try:
            job()
        finally:
            self._pushing = False
            self._refresh()


def _refuse_others(view: DeviceView, page: str) -> None:
    if view.in_control not in (None, page):
        raise Refused(f"Another page is in control of {view.name}: take over first.")


def _told(asked: Sequence[Asked]) -> str:
    return ", ".join(f"{each.value:g} (axis {each.axis})" for each in asked)


def _axes_of(asked: Sequence[Asked]) -> list[int]:
    return [each.axis for each in asked]
