"""The attachment of a device to a port: when it is connected, lost, found again and let go of."""

import threading
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from time import sleep

from stepramp.controllers.capabilities import ProvenByStart, capabilities_of
from stepramp.controllers.families import Family
from stepramp.devices.contact import STARTED_ANEW, Contact
from stepramp.devices.homing import Homings
from stepramp.devices.leases import Leases
from stepramp.devices.live_view import LiveView
from stepramp.devices.permit import Permit
from stepramp.devices.proving import Proving
from stepramp.devices.runs import Runs
from stepramp.devices.shared_attempt import SharedAttempt
from stepramp.devices.stopping import LAST_STOP_S, Stopping
from stepramp.devices.to_and_fro import ToAndFro
from stepramp.devices.view import DeviceState, DeviceView
from stepramp.devices.watch import IDLE_POLL_S, Watch
from stepramp.devices.writing import Writing
from stepramp.errors import DeviceLost, Refused, StepRampError
from stepramp.link.connection import Connection
from stepramp.link.ports import Port, find_again, known_port, location_of, port_name
from stepramp.link.remote_ports import RemotePorts
from stepramp.link.worker import DISCONNECTED, Worker

CLOSED_S = 0.25
"""So long a port stays closed whose controller is started anew by that: its DTR falls, and systems let go of it [s]."""

OTHER = (
    "Another board is plugged in at {port} than the one that was there before, {called}: connect it again, as a device "
    "of its own."
)


class Attachment:
    """Connects a device to its port, and sees to what goes on while it is connected. For any thread.

    known: the port. family: how it is opened, and of what kind the controller there is. remote_ports: those of other
    machines that may be opened. learn_board: told what is plugged in, in the thread of the port, where that wasn't
    known before; what it refuses isn't connected.
    """

    def __init__(
        self,
        known: Port,
        family: Family,
        remote_ports: RemotePorts,
        view: LiveView,
        contact: Contact,
        watch: Watch,
        leases: Leases,
        permit: Permit,
        stopping: Stopping,
        runs: Runs,
        to_and_fro: ToAndFro,
        homings: Homings,
        writing: Writing,
        proving: Proving,
        learn_board: Callable[[Port], None],
    ) -> None:
        self._known = known
        self._family = family
        self._remote_ports = remote_ports
        self._view = view
        self._contact = contact
        self._watch = watch
        self._leases = leases
        self._permit = permit
        self._stopping = stopping
        self._runs = runs
        self._to_and_fro = to_and_fro
        self._homings = homings
        self._writing = writing
        self._proving = proving
        self._learn_board = learn_board
        self._connecting = threading.Lock()
        self._attempt = SharedAttempt()
        self._connection: Connection | None = None
        self._location: str | None = None
        self._let_go = False
        self._has_ended = False
        self._starts_anew = False

    @property
    def known(self) -> Port:
        """The port, and what is plugged in there as far as that is told apart."""
        return self._known

    @property
    def called(self) -> str:
        """The same in words; see Port."""
        return self._known.called

    def is_other(self, known: Port) -> bool:
        """Whether another board than that of this device is plugged in at a port."""
        return known.is_other_than(self._known)

    @property
    def location(self) -> str | None:
        """Where the port leads that it holds, whatever name it was given; None: it holds none."""
        return self._location

    @property
    def is_connected(self) -> bool:
        """Whether the handshake is done and the device not lost."""
        return self._view.now.state not in (DeviceState.CONNECTING, DeviceState.LOST)

    def connect(self, port: str | None = None) -> None:
        """Open the port and shake hands, unless that is done already; see Device.connect."""
        where = location_of(self._view.now.port if port is None else port)
        self._attempt(where, lambda: self._connect_unless_done(port))

    def reconnect(self) -> bool:
        """Connect again if what was lost is back; see Device.reconnect."""
        port = find_again(self._known)
        if port is None:
            return False
        with self._connecting:
            if not self.is_connected and not self._let_go:
                self._connect(port)
            return True

    def disconnect(self) -> None:
        """Let go of the port; Refused while the motor moves. A device that is lost is let go of, too."""
        with self._connecting:
            if self.is_connected:
                with suppress(DeviceLost):
                    self._contact.ask(lambda _: self._end_at_rest())
            self._let_go = True
            self._close()

    def start_anew(self) -> None:
        """Close the port and open it again, by which many controllers start anew; as connect.

        Refused where the controller isn't a ProvenByStart, moves, or may move by that.
        """
        with self._connecting:
            before = self._view.now
            try:
                self._contact.ask_one_who(ProvenByStart, self._end_to_start_anew)
                self._close()
            finally:
                self._starts_anew = False
            sleep(CLOSED_S)
            self._connect(before.port, before)

    def refuse_from_now_on(self) -> None:
        """Connect no more: for the end of the program."""
        self._has_ended = True

    def shut_down(self) -> None:
        """Let go of the port, whatever is going on: for the end of the program."""
        self._let_go = True
        if (worker := self._contact.worker) is not None:
            worker.close(LAST_STOP_S)

    def _connect_unless_done(self, port: str | None) -> None:
        with self._connecting:
            self._let_go = False
            present = self._view.now.port
            is_elsewhere = port is not None and location_of(port) not in (self._location, location_of(present))
            if is_elsewhere and self.is_connected:
                # It was pulled out there, which nobody has noticed yet.
                with suppress(StepRampError):
                    self._contact.ask(lambda _: self._watch.refresh())
            if not self.is_connected:
                self._connect(port if port is not None and is_elsewhere else present)

    def _connect(self, port: str, known: DeviceView | None = None) -> None:
        """Connect, or leave the device lost as it was known before; None: as it is now, and it may be another one."""
        before = known or self._view.now
        self._view.change(lambda view: view if view.proving else view.anew(port, port_name(port)))
        worker = Worker(port, self.poll, self._ended)
        self._contact.begin(worker)
        try:
            if self._has_ended:
                raise Refused("StepRamp is ending: nothing is connected any more.")
            worker.call(self._open)
        except Exception as error:
            worker.close()
            reason = str(error)
            self._view.change(lambda view: before.still_lost(reason, view))
            raise

    def _close(self, why: str = DISCONNECTED) -> None:
        if (worker := self._contact.worker) is not None:
            worker.close(why=why)

    # From here on: in the thread of the port.

    def poll(self) -> float:
        """See to what is due when nothing is asked; return after how long to look again [s]."""
        if not self._contact.is_there or self._view.now.state is DeviceState.CONNECTING:
            return IDLE_POLL_S
        self._runs.let_end()
        self._watch.look()
        self._stopping.heed_others()
        self._stopping.settle_at_rest()
        self._to_and_fro.go_on()
        self._homings.go_on()
        return self._watch.pause_s

    def _open(self) -> None:
        port = self._view.now.port
        self._connection = self._family.open(port, self._permit.check, self._remote_ports)
        self._location = location_of(port)
        # Only now that the port is held nothing else can come to be plugged in there.
        known = known_port(port)
        if self.is_other(known):
            raise Refused(OTHER.format(port=port, called=self.called))
        if self._known.usb is not None:
            # The list of ports may miss one for a moment, and its number is nobody's while another board with the same
            # one is there: what was known of the board still holds.
            known = replace(known, usb=self._known.usb)
        elif known.usb is not None:
            self._learn_board(known)
            self._known = known
        controller = self._family.make(self._connection, self._runs.give_way, self._writing.note_progress)
        controller.connect(lambda: self._stopping.greet(controller, known))
        status = controller.status()
        self._known = known
        self._view.change(
            lambda view: replace(
                view,
                firmware_version=controller.firmware_version,
                clocks_hz=controller.clocks_hz,
                most_axes=controller.most_axes,
                capabilities=capabilities_of(controller),
            )
        )
        self._proving.look(controller)
        self._watch.show(status)
        self._runs.end_those_of_nobody(status)
        version = controller.firmware_version
        self._view.log("connected%s", "" if version is None else f", firmware {version}")

    def _end_at_rest(self) -> None:
        """End the thread in the same call that looks whether the motor moves, so that no move slips in between."""
        self._watch.refuse_under_way()
        self._close()

    def _end_to_start_anew(self, controller: ProvenByStart) -> None:
        """As _end_at_rest, but for a while."""
        self._watch.refuse_under_way()
        controller.refuse_start()
        self._starts_anew = True
        self._close(STARTED_ANEW.format(name=self._view.now.name))

    def _ended(self, loss: DeviceLost | None) -> None:
        if self._contact.is_there and loss is None:
            with suppress(StepRampError):
                self._contact.controller.disconnect()
        if self._connection is not None:
            self._connection.close()
            self._connection = None
        self._location = None
        self._leases.drop()
        self._contact.end()
        if loss is not None:
            self._view.change(lambda view: view.lost(str(loss)))
        else:
            self._view.change(DeviceView.starting_anew if self._starts_anew else DeviceView.let_go)
        why = "closed to start it anew" if self._starts_anew else "let go of"
        self._view.log("%s", why if loss is None else f"lost: {loss}")
