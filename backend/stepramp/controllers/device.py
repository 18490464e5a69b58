"""A device: one controller at one port, its state, and what can be asked of it from any thread."""

import threading
from collections.abc import Callable, Collection, Sequence
from concurrent.futures import Future
from contextlib import suppress
from dataclasses import replace
from time import monotonic
from typing import TypeVar

from stepramp.controllers.controller import (
    Asked,
    Controller,
    ControllerStatus,
    PushMode,
    PushPreview,
    PushReport,
)
from stepramp.controllers.device_view import UNDER_WAY, DeviceState, DeviceView
from stepramp.controllers.jog_lease import JogLease
from stepramp.controllers.progress import Progress, PushStage
from stepramp.controllers.settings import Settings
from stepramp.controllers.shuttle import Shuttle
from stepramp.controllers.stepramp_controller import StepRampController
from stepramp.controllers.trace import Trace
from stepramp.design import Design
from stepramp.errors import DeviceLost, Refused, Rejected, StepRampError
from stepramp.link.ports import find_again, known_port, port_name
from stepramp.link.serial_port import SerialPort
from stepramp.link.worker import Worker

LISTEN_S = 1 / 50
"""How often a device that moves is listened to: as often as it reports."""
HEARTBEAT_S = 1 / 3
"""So often a controller is asked while it moves [s]: what runs at a speed stops when nobody asks any more."""
SILENCE_S = 1 / 10
"""A device that moves and doesn't report for so long is asked."""
IDLE_POLL_S = 1 / 2
"""Often enough to notice soon that a device was unplugged."""

T = TypeVar("T")


class Device:
    """One controller at one port. Its worker owns the port; all calls here may come from any thread.

    changed: called from the worker's thread after each change of the view.
    """

    def __init__(self, device_id: str, port: str, changed: Callable[[], None]) -> None:
        self._changed = changed
        self._lock = threading.Lock()
        self._connecting = threading.Lock()
        self._view = DeviceView(device_id, port, port_name(port))
        self._port: SerialPort | None = None
        self._controller: Controller | None = None
        self._worker: Worker | None = None
        self._pushing = False
        self._known_port = known_port(port)
        self._let_go = False
        self._jog: JogLease | None = None
        self._asked_s = 0.0

    @property
    def view(self) -> DeviceView:
        """The device as it is now."""
        with self._lock:
            return self._view

    @property
    def connected(self) -> bool:
        """Whether the handshake is done and the device not lost."""
        return self.view.state not in (DeviceState.CONNECTING, DeviceState.LOST)

    def connect(self) -> None:
        """Open the port and shake hands, unless that is done already; nothing moves.

        Raises Rejected for an address that is no port, Refused for a controller of another kind, DeviceLost when none
        answers.
        """
        with self._connecting:
            self._let_go = False
            if not self.connected:
                self._connect(self.view.port)

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
                    self._ask(self._end_at_rest)
            self._let_go = True
            self._close()

    def shut_down(self) -> None:
        """Stop the motor if it moves, and let go of the port: for the end of the program."""
        with self._connecting:
            if self.view.state in UNDER_WAY:
                # Whatever hinders it, there is no second chance: the program ends.
                with suppress(StepRampError):
                    self.stop().result()
            self._let_go = True
            self._close()

    def take_control(self, page: str, *, over: bool = False) -> None:
        """Put a page in control; Refused while another one is, unless it is taken over. That ends the other's jog."""
        if not over:
            self.refuse_others(page)
        before = self.view.in_control
        self._change(lambda view: replace(view, in_control=page))
        if before != page:
            self._end_any_jog()

    def refuse_others(self, page: str) -> None:
        """Refused while a page other than this one is in control."""
        view = self.view
        if view.in_control not in (None, page):
            raise Refused(f"Another page is in control of {view.name}: take over first.")

    def leave_control(self, page: str) -> None:
        """Note that a page is gone: nobody is in control if it was."""
        self._change(lambda view: replace(view, in_control=None) if view.in_control == page else view)

    def preview_push(self, designs: Sequence[Design], first_axis: int | None = None) -> PushPreview:
        """Return what a push would change, without the port; see Controller."""
        return self._controller_now().preview_push(designs, first_axis)

    def push(self, designs: Sequence[Design], first_axis: int | None = None, mode: PushMode = "keep") -> PushReport:
        """Have the controller use the designs' ramps, and store them or not; see Controller.prepare_push."""
        controller, _ = self._ready()
        if self.view.state in UNDER_WAY:
            raise Refused("The motor moves: stop it first.")
        self._change(lambda view: replace(view, progress=Progress(PushStage.PLANNING, 0, 0)))
        try:
            send = controller.prepare_push(designs, first_axis, mode)
            return self._ask(lambda: self._push(send))
        finally:
            self._change(lambda view: replace(view, progress=None))

    def keep(self) -> None:
        """Store the ramps and settings in use; see Controller."""
        self._write(self._controller_now().keep)

    def roll_back(self) -> None:
        """Use the stored ramps and settings again; see Controller."""
        self._write(self._controller_now().roll_back)

    def restore(self) -> None:
        """Make the ramps and settings that were stored before the stored ones; see Controller."""
        self._write(self._controller_now().restore)

    def settings(self) -> Settings:
        """Ask for the settings in use."""
        return self._ask(self._controller_now().settings)

    def use_settings(self, settings: Settings) -> None:
        """Use other settings until a roll back or a reset; see Controller."""
        controller = self._controller_now()
        self._write(lambda: controller.use_settings(settings))

    def move_by(self, steps: Sequence[Asked]) -> None:
        """Begin to move axes by so many steps; see Controller."""
        controller = self._controller_now()
        self._ask(lambda: self._newly(lambda: controller.move_by(steps)))

    def move_to(self, positions: Sequence[Asked]) -> None:
        """Begin to move axes to positions [steps]; see Controller."""
        controller = self._controller_now()
        self._ask(lambda: self._newly(lambda: controller.move_to(positions)))

    def run(self, speeds: Sequence[Asked]) -> None:
        """Run axes at speeds [steps/s]; see Controller."""
        controller = self._controller_now()
        self._ask(lambda: self._newly(lambda: controller.run(speeds)))

    def jog(self, lease: JogLease, speed: Asked) -> None:
        """Run an axis at a speed [steps/s] as long as a lease is renewed, then slow it down; see Controller.run.

        Refused when the lease ran out before it came to that.
        """
        controller = self._controller_now()

        def begin() -> None:
            if not lease.holds:
                raise Refused("The jog was let go before it began; nothing moved.")
            controller.run([speed])
            self._jog = lease

        self._ask(lambda: self._newly(begin))

    def end_jog(self, lease: JogLease) -> None:
        """Slow an axis down that jogs on a lease, before anything else that was asked for."""
        lease.end()
        with suppress(StepRampError):
            _, worker = self._ready()
            worker.call_urgently(self._let_jogs_end)

    def go_there_and_back(self, shuttle: Shuttle, asked: Asked) -> None:
        """Begin to go to and fro, from rest, until it is done or something else is asked for.

        asked: how far, with what rejections call it. Raises as move_by.
        """
        controller = self._controller_now()

        def begin() -> None:
            self._refuse_under_way()
            controller.move_by([asked])
            self._refresh()
            on_its_way = shuttle.set_out(self._axis_target(shuttle.axis))
            self._change(lambda view: replace(view, shuttle=on_its_way))

        self._ask(lambda: self._newly(begin))

    def line(self, steps: Sequence[Asked], ramp_axis: int | None = None) -> None:
        """Begin to move axes along a straight line; see Controller."""
        controller = self._controller_now()
        self._ask(lambda: self._newly(lambda: controller.line(steps, ramp_axis)))

    def set_position(self, positions: Sequence[Asked]) -> None:
        """Call the places where axes are these positions [steps]; see Controller."""
        controller = self._controller_now()
        self._ask(lambda: self._newly(lambda: controller.set_position(positions)))
        self._change(lambda view: view.with_known_positions({each.axis for each in positions}))

    def zero(self, axes: Collection[int], steps: int) -> None:
        """Call the places where axes are so many steps and move them to 0; see Controller."""
        controller = self._controller_now()
        self._ask(lambda: self._newly(lambda: controller.zero(axes, steps)))
        self._change(lambda view: view.with_known_positions(axes))

    def trace_moves(self, axis: int | None, every_steps: int) -> int:
        """Trace every so many-th step of each move of an axis from now on; see Controller."""
        controller = self._controller_now()
        return self._ask(lambda: controller.trace_moves(axis, every_steps))

    def trace(self) -> Trace:
        """Return the trace of the last move that was traced, as far as it is known; Refused before there was one."""
        trace = self._ask(self._trace)
        if trace is None:
            raise Refused("No move has been traced yet: ask for a trace, then move.")
        return trace

    def stop(self, axes: Collection[int] | None = None) -> "Future[None]":
        """Slow axes, or all, down with the ramp, before anything else that was asked for; return the result to come."""
        controller, worker = self._ready()
        return worker.call_urgently(lambda: self._newly(lambda: controller.stop(axes)))

    def halt(self, axes: Collection[int] | None = None) -> "Future[None]":
        """Make no further step, before anything else that was asked for; return the result to come."""
        controller, worker = self._ready()
        return worker.call_urgently(lambda: self._newly(lambda: controller.halt(axes)))

    def _ready(self) -> tuple[Controller, Worker]:
        """Return controller and worker; raises when there are none to be asked."""
        with self._lock:
            view, controller, worker = self._view, self._controller, self._worker
        if view.state is DeviceState.LOST:
            raise DeviceLost(view.message or f"Port {view.port} is not connected.")
        if controller is None or worker is None:
            raise Refused(f"{view.name} is still being connected.")
        return controller, worker

    def _controller_now(self) -> Controller:
        return self._ready()[0]

    def _write(self, job: Callable[[], None]) -> None:
        self._ask(lambda: self._while_writing(job))

    def _ask(self, job: Callable[[], T]) -> T:
        _, worker = self._ready()
        return worker.call(job)

    def _connect(self, port: str) -> None:
        name = port_name(port)
        self._change(lambda view: view.anew(port, name))
        self._worker = Worker(port, self._poll, self._ended)
        try:
            self._worker.call(self._open)
        except StepRampError as error:
            self._worker.close()
            reason = str(error)
            self._change(lambda view: view.at_a_loss(reason))
            raise
        self._known_port = known_port(port)

    def _end_any_jog(self) -> None:
        if (lease := self._jog) is not None:
            self.end_jog(lease)

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
        self._port = SerialPort(self.view.port)
        controller = StepRampController(self._port, self._worker.give_way, self._note_progress)
        controller.connect()
        status = controller.status()
        with self._lock:
            self._controller = controller
            self._view = replace(
                self._view, firmware_version=controller.firmware_version, clocks_hz=controller.clocks_hz
            )
        self._show(status)

    def _poll(self) -> float:
        if self._controller is None:
            return IDLE_POLL_S
        self._let_jogs_end()
        under_way, heard_s = self.view.state in UNDER_WAY, self.view.heard_s
        if under_way and monotonic() - self._asked_s > HEARTBEAT_S:
            self._refresh()
        elif under_way and (heard := self._controller.listen()) is not None:
            self._show(heard)
        elif monotonic() - heard_s > (SILENCE_S if under_way else IDLE_POLL_S):
            self._refresh()
        self._go_on_to_and_fro()
        return LISTEN_S if self.view.state in UNDER_WAY or self.view.shuttle else IDLE_POLL_S

    def _ended(self, loss: DeviceLost | None) -> None:
        if self._controller is not None and loss is None:
            with suppress(StepRampError):
                self._controller.disconnect()
        if self._port is not None:
            self._port.close()
        with self._lock:
            self._port = self._controller = self._jog = None
        self._change(lambda view: view.at_a_loss("Disconnected." if loss is None else str(loss)))

    def _refresh(self) -> None:
        assert self._controller is not None
        self._asked_s = monotonic()
        self._show(self._controller.status())

    def _show(self, status: ControllerStatus) -> None:
        assert self._controller is not None
        timer_hz, now_s = self._controller.timer_hz, monotonic()

        def shown(view: DeviceView) -> DeviceView:
            view = replace(view.with_status(status), timer_hz=timer_hz, heard_s=now_s)
            # A stop may ask in the midst of a push, when the controller itself isn't writing yet.
            return replace(view, state=DeviceState.WRITING) if self._pushing else view

        self._change(shown)

    def _trace(self) -> Trace | None:
        assert self._controller is not None
        heard = self._controller.listen()
        if heard is not None:
            self._show(heard)
        return self._controller.trace

    def _newly(self, job: Callable[[], None]) -> None:
        """Do what is asked of axes now: whatever went on by itself ends."""
        self._end_by_itself()
        job()
        self._refresh()

    def _end_by_itself(self) -> None:
        lease, self._jog = self._jog, None
        if lease is not None:
            lease.end()
        self._change(lambda view: replace(view, shuttle=None))

    def _let_jogs_end(self) -> None:
        """Slow down what jogs on a lease that has run out."""
        lease = self._jog
        if lease is None or lease.holds:
            return
        assert self._controller is not None
        self._jog = None
        self._controller.stop([lease.axis])
        self._refresh()

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
            self._set_out(shuttle)
        else:
            self._change(lambda view: replace(view, shuttle=shuttle))

    def _set_out(self, shuttle: Shuttle) -> None:
        assert self._controller is not None
        try:
            self._controller.move_by([Asked(shuttle.axis, shuttle.next_by_steps, "by_steps")])
        except (Refused, Rejected):
            # Somebody else at the controller, such as its own sketch, has begun something: then this is over.
            self._change(lambda view: replace(view, shuttle=None))
            return
        self._refresh()
        on_its_way = shuttle.set_out(self._axis_target(shuttle.axis))
        self._change(lambda view: replace(view, shuttle=on_its_way))

    def _axis_target(self, axis: int) -> int:
        return self.view.axes[axis].target_steps

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
        return reports[0]

    def _while_writing(self, job: Callable[[], None]) -> None:
        self._refuse_under_way()
        self._end_by_itself()
        self._pushing = True
        self._change(lambda view: replace(view, state=DeviceState.WRITING))
        try:
            job()
        finally:
            self._pushing = False
            self._refresh()
