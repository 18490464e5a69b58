"""The registry of connected devices, for any thread."""

import logging
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import AbstractContextManager, contextmanager, nullcontext, suppress
from functools import partial
from pathlib import Path

from stepramp.controllers.families import FAMILIES, USUAL_FAMILY, Family, offer_virtual_controller
from stepramp.data_folder import data_folder
from stepramp.devices.backups import Archive
from stepramp.devices.device import Device
from stepramp.devices.finding import Found, find_family
from stepramp.devices.owed_stops import OwedStops
from stepramp.devices.pages import Pages
from stepramp.devices.reconnect import Returning
from stepramp.devices.stops import Order, Stops
from stepramp.devices.view import DeviceState, DeviceView
from stepramp.errors import NotFound, Refused, Rejected, Rejection, StepRampError, shown
from stepramp.link.ports import Port, known_port, list_serial_ports, location_of
from stepramp.link.remote_ports import RemotePorts
from stepramp.link.serial_port import NO_REMOTE_PORTS

_logger = logging.getLogger(__name__)

Listener = Callable[[], None]


class Devices:
    """The devices that are connected, or were until they were lost, by ids that count from "1".

    Each has a worker of its own, so that one that is lost does not keep the others waiting.
    """

    def __init__(
        self,
        families: Mapping[str, Family] = FAMILIES,
        remote_ports: RemotePorts = NO_REMOTE_PORTS,
        data: Path | None = None,
    ) -> None:
        """Begin with no device; the virtual controller is there to be connected.

        families: of controllers that may be connected, by their names. remote_ports: those of other machines that may.
        data: the folder of what outlasts the program; None: the user's own.
        """
        offer_virtual_controller()
        self.families = families
        self._remote_ports = remote_ports
        self.data = data or data_folder()
        """The folder of what outlasts the program."""
        self.archive = Archive(self.data)
        """What was saved of any device, connected or not."""
        self.order = Order()
        """Of all that is asked of devices, and of their stops."""
        self._stops = Stops(self.order)
        self._owed = OwedStops(self.order)
        self._lock = threading.Lock()
        self._devices: dict[str, Device] = {}
        # Devices that were forgotten and are to be remembered, by what tells apart what was plugged in and the kind of
        # its controller: soft limits, and axes that may be elsewhere than they count.
        self._let_go: dict[object, tuple[Port, DeviceView]] = {}
        self._listeners: list[Listener] = []
        self._pages = Pages(self._leave_control)
        self._last_id = 0
        self._has_ended = False
        self._returning = Returning(self._lost)

    def look_for_lost_ones(self) -> None:
        """Connect devices again that were lost, once they are back, from now on until the end."""
        self._returning.begin()

    def views(self) -> list[DeviceView]:
        """Return all devices as they are now, in the order in which they were connected."""
        return [device.view for device in self._all()]

    def get(self, device_id: str) -> Device:
        """Return a device; NotFound when there is none of that id."""
        with self._lock:
            device = self._devices.get(device_id)
        if device is None:
            raise NotFound(f"There is no device {shown(device_id)}.")
        return device

    def acting(self, device_id: str, page: str | None) -> Device:
        """Return a device for a page that acts on it, and is from then on in control; None: a program, never hindered.

        Refused while another page is in control. A page that doesn't listen is never in control: nobody would know when
        it is gone.
        """
        device = self.get(device_id)
        if page is not None and self._pages.is_there(page):
            self._put_in_control(device, page)
        elif page is not None:
            device.refuse_others(page)
        return device

    def take_over(self, device_id: str, page: str) -> Device:
        """Put a page in control of a device, whichever was before; Refused when the page doesn't listen."""
        device = self.get(device_id)
        if not self._pages.is_there(page):
            raise Refused("Only a page that listens to the devices' events can be in control of one.")
        self._put_in_control(device, page, over=True)
        return device

    def _put_in_control(self, device: Device, page: str, *, over: bool = False) -> None:
        device.take_control(page, self._pages.place_of(page), over=over)
        # It may have gone just before: what it had was then taken from it too early.
        if not self._pages.is_there(page):
            device.leave_control(page)

    def present(self, page: str | None, place: str | None = None) -> AbstractContextManager[None]:
        """Note that a page is there and listens; once it is gone, it is in control of nothing. place: where it is."""
        return nullcontext() if page is None else self._pages.present(page, place)

    def ports(self) -> list[Port]:
        """Return the ports that can be connected to: of this machine, of others, the virtual one last."""
        return list_serial_ports(self._remote_ports)

    def families_at(self, port: str) -> list[str]:
        """Return the names of the families that a controller at a port may be of."""
        return [name for name, family in self.families.items() if family.may_be_at(port)]

    def find_family(self, port: str) -> Found:
        """Return which family the controller at a port says that it is of, as it starts; nothing is sent to it.

        Raises as find_family, and Refused where a device is connected there, or was until it was lost.
        """
        if (device := self._present_at(port, location_of(port), known_port(port))) is not None:
            raise Refused(f"{self._as_one_of(device)}: disconnect it first.")
        return find_family(port, (self.families[each] for each in self.families_at(port)), self._remote_ports)

    def connect(self, port: str, family: str = USUAL_FAMILY) -> Device:
        """Return the device at a port, connected: the one that is there already, by whatever name, or a new one.

        family: of its controller. Whoever asks has to know it: what one family takes for a greeting may be a motion for
        another one, so none is tried.

        A lost device is connected again under its id, also at another port than it was at, where it is known by its
        serial number; where another board is at its port, that is a new device, and the lost one stays lost. Raises as
        Device.connect; a new device that can't be connected is forgotten, a lost one stays lost. Rejected for a family
        that there isn't, or not at such a port; Refused while the device there counts as one of another family.
        """
        if family not in (allowed := self.families_at(port)):
            raise Rejected([Rejection("family", family, ", ".join(allowed))])
        device, is_new = self._at(port, self.families[family])
        if device.view.family != family:
            raise Refused(f"{self._as_one_of(device)}, not of {self.families[family].title}: disconnect it first.")
        try:
            device.connect(port)
        except Exception:
            if is_new:
                self._forget(device)
            raise
        with self._lock:
            # Another call may have failed at the same port, and forgotten the device, just before this one succeeded.
            self._devices.setdefault(device.view.id, device)
        self._tell_displaced(device)
        return device

    def _as_one_of(self, device: Device) -> str:
        """Return as what a device is connected, or was until it was lost, as the beginning of a sentence."""
        view, title = device.view, self.families[device.view.family].title
        if view.state is not DeviceState.LOST:
            return f"The device at {view.port} is connected as one of the family {title}"
        return f"Device {view.id}, {device.called}, was connected until it was lost, as one of the family {title}"

    def disconnect(self, device_id: str) -> None:
        """Let go of a device and forget it; Refused while its motor moves."""
        device = self.get(device_id)
        device.disconnect()
        self._forget(device)

    def stop_all(self) -> None:
        """Stop every device, all at the same time; those that can't be asked tell so by their state."""
        with self.being_stopped():
            for stopped in self.begin_to_stop():
                with suppress(StepRampError):
                    stopped.result()

    @contextmanager
    def being_stopped(self) -> Iterator[None]:
        """Let no device move while a stop of all is being answered, nor afterwards what was asked until then.

        It holds for devices, too, that are connected meanwhile.
        """
        try:
            with self._stops.unanswered():
                self._show_stops()
                yield
        finally:
            self._show_stops()

    def begin_to_stop(self) -> list[Future[None]]:
        """Have every device stop; return the results to come, also of those that can't be asked: see Device.stop."""
        pending: list[Future[None]] = []
        for device in self._all():
            try:
                pending.append(device.stop())
            except StepRampError as error:
                pending.append(Future())
                pending[-1].set_exception(error)
        return pending

    def end_motion(self) -> None:
        """Stop every device for good: nothing moves any more. For the end of the program."""
        self._has_ended = True
        self._returning.end()
        _at_once(Device.end_motion, self._all())

    def close(self) -> None:
        """Stop what moves and let go of all devices."""
        self.end_motion()
        _at_once(Device.shut_down, self._all())
        with self._lock:
            self._devices.clear()
        self._tell()

    @contextmanager
    def listening(self, listener: Listener) -> Iterator[None]:
        """Have a listener called on each change, from whatever thread makes it; it must return at once."""
        with self._lock:
            self._listeners.append(listener)
        try:
            yield
        finally:
            with self._lock:
                self._listeners.remove(listener)

    def _show_stops(self) -> None:
        for device in self._all():
            device.show_stops()

    def _all(self) -> list[Device]:
        with self._lock:
            return list(self._devices.values())

    def _lost(self) -> list[Device]:
        return [device for device in self._all() if device.view.state is DeviceState.LOST]

    def _leave_control(self, page: str) -> None:
        for device in self._all():
            device.leave_control(page)

    def _at(self, port: str, family: Family) -> tuple[Device, bool]:
        # Without the lock: this may take a while, as does listing the machine's ports, and a stop must not wait for it.
        location, known = location_of(port), known_port(port)
        with self._lock:
            if (device := self._one_at(port, location, known)) is not None:
                return device, False
            if self._has_ended:
                raise Refused("StepRamp is ending: nothing is connected any more.")
            self._last_id += 1
            device_id = str(self._last_id)
            device = Device(
                device_id,
                known,
                family,
                self._remote_ports,
                self.order,
                self._stops,
                self._owed,
                self._tell,
                self.data,
                partial(self._learn_board, device_id, family.kind),
                self._take_up(family.kind, known),
            )
            self._devices[device_id] = device
        self._tell()
        return device, True

    def _learn_board(self, device_id: str, kind: str, known: Port) -> DeviceView | None:
        """Return what was known of a board when it was let go of that is told apart only now that its port is held.

        Refused where it is another device: that one has its limits.
        """
        with self._lock:
            for device in self._devices.values():
                if device.view.id != device_id and device.is_board(known):
                    raise Refused(
                        f"What is plugged in at {known.port} is device {device.view.id}, {device.called}: connect it "
                        "again."
                    )
            return self._take_up(kind, known)

    def _take_up(self, kind: str, known: Port) -> DeviceView | None:
        """Return, once, what was known of a board when it was let go of; the lock is held."""
        for identity, (before, view) in self._let_go.items():
            if identity == (kind, before.board) and known.is_board_of(before):
                del self._let_go[identity]
                return view
        return None

    def _present_at(self, port: str, location: str, known: Port) -> Device | None:
        with self._lock:
            return self._one_at(port, location, known)

    def _one_at(self, port: str, location: str, known: Port) -> Device | None:
        """Return the device at a port, by that name rather than by another: the one that holds it, or was lost there.

        known: what is plugged in there. A lost one that is another board is not there; one that is this board is,
        wherever it was: it has its limits.
        """
        at = [each for each in self._devices.values() if each.view.port == port or each.location == location]
        at = sorted((each for each in at if not each.is_other(known)), key=lambda each: each.view.port != port)
        held = (each for each in at if each.view.state is not DeviceState.LOST)
        same = (each for each in self._devices.values() if each.is_board(known))
        return next(held, None) or next(same, None) or next(iter(at), None)

    def _tell_displaced(self, device: Device) -> None:
        """Tell of lost devices that another one is at their port."""
        if not (lost := self._lost()):
            return
        port, location = device.view.port, device.location
        known = known_port(port)
        for each in lost:
            if (each.view.port == port or each.location == location) and each.is_other(known):
                each.note_other(known, device.view.id)

    def _forget(self, device: Device) -> None:
        with self._lock:
            if not device.connected:
                self._devices.pop(device.view.id, None)
                if device.view.soft_limits or device.view.unknown_positions:
                    self._let_go[device.identity] = device.known, device.view
        for each in self._lost():
            each.forget_other(device.view.id)
        self._tell()

    def _tell(self) -> None:
        with self._lock:
            listeners = list(self._listeners)
        for listener in listeners:
            try:
                listener()
            except Exception:
                # Whoever asked for what has changed must not be kept waiting by it, nor the others.
                _logger.exception("A change of a device could not be told.")


def _at_once(act: Callable[[Device], None], devices: Sequence[Device]) -> None:
    """Have something done by all devices at the same time, and wait for all."""
    with ThreadPoolExecutor(max_workers=max(1, len(devices))) as pool:
        list(pool.map(act, devices))
