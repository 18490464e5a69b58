"""The registry of connected devices, for any thread."""

import threading
from collections import Counter
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager, suppress

from stepramp.controllers.device import Device
from stepramp.controllers.device_view import DeviceState, DeviceView
from stepramp.controllers.returning import Returning
from stepramp.controllers.virtual import VirtualController
from stepramp.errors import NotFound, Refused, StepRampError
from stepramp.link import protocol_sim
from stepramp.link.protocol_sim import VIRTUAL_PORT

Listener = Callable[[], None]


class Devices:
    """The devices that are connected, or were until they were lost, by ids that count from "1".

    Each has a worker of its own, so that one that is lost does not keep the others waiting.
    """

    def __init__(self) -> None:
        """Begin with no device; the virtual controller is there to be connected."""
        if not protocol_sim.registered(VIRTUAL_PORT):
            protocol_sim.register(VIRTUAL_PORT, VirtualController())
        self._lock = threading.Lock()
        self._devices: dict[str, Device] = {}
        self._listeners: list[Listener] = []
        self._pages: Counter[str] = Counter()
        self._last_id = 0
        self._returning = Returning(self._lost)

    def views(self) -> list[DeviceView]:
        """Return all devices as they are now, in the order in which they were connected."""
        return [device.view for device in self._all()]

    def get(self, device_id: str) -> Device:
        """Return a device; NotFound when there is none of that id."""
        with self._lock:
            device = self._devices.get(device_id)
        if device is None:
            raise NotFound(f"There is no device {device_id!r}.")
        return device

    def acting(self, device_id: str, page: str | None) -> Device:
        """Return a device for a page that acts on it, and is from then on in control; None: a program, never hindered.

        Refused while another page is in control. A page that doesn't listen is never in control: nobody would know when
        it is gone.
        """
        device = self.get(device_id)
        if page is not None and self._is_there(page):
            device.take_control(page)
        elif page is not None:
            device.refuse_others(page)
        return device

    def take_over(self, device_id: str, page: str) -> Device:
        """Put a page in control of a device, whichever was before; Refused when the page doesn't listen."""
        device = self.get(device_id)
        if not self._is_there(page):
            raise Refused("Only a page that listens to the devices' events can be in control of one.")
        device.take_control(page, over=True)
        return device

    @contextmanager
    def present(self, page: str | None) -> Iterator[None]:
        """Note that a page is there and listens; once it is gone, it is in control of nothing."""
        if page is None:
            yield
            return
        with self._lock:
            self._pages[page] += 1
        try:
            yield
        finally:
            with self._lock:
                self._pages[page] -= 1
                self._pages += Counter()  # Only those above zero stay.
            if not self._is_there(page):
                for device in self._all():
                    device.leave_control(page)

    def connect(self, port: str) -> Device:
        """Return the device at a port, connected: the one that is there already, or a new one.

        A lost device is connected again under its id. Raises as Device.connect; a new device that can't be connected
        is forgotten, a lost one stays lost.
        """
        device, is_new = self._at(port)
        try:
            device.connect()
        except StepRampError:
            if is_new:
                self._forget(device)
            raise
        with self._lock:
            # Another call may have failed at the same port, and forgotten the device, just before this one succeeded.
            self._devices.setdefault(device.view.id, device)
        return device

    def disconnect(self, device_id: str) -> None:
        """Let go of a device and forget it; Refused while its motor moves."""
        device = self.get(device_id)
        device.disconnect()
        self._forget(device)

    def stop_all(self) -> None:
        """Stop every device, all at the same time; those that can't be asked tell so by their state."""
        pending = []
        for device in self._all():
            with suppress(StepRampError):
                pending.append(device.stop())
        for stopped in pending:
            with suppress(StepRampError):
                stopped.result()

    def close(self) -> None:
        """Stop what moves and let go of all devices."""
        self._returning.end()
        with self._lock:
            devices = list(self._devices.values())
            self._devices.clear()
        with ThreadPoolExecutor(max_workers=max(1, len(devices))) as pool:
            list(pool.map(Device.shut_down, devices))
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

    def _all(self) -> list[Device]:
        with self._lock:
            return list(self._devices.values())

    def _lost(self) -> list[Device]:
        return [device for device in self._all() if device.view.state is DeviceState.LOST]

    def _is_there(self, page: str) -> bool:
        with self._lock:
            return self._pages[page] > 0

    def _at(self, port: str) -> tuple[Device, bool]:
        with self._lock:
            for device in self._devices.values():
                if device.view.port == port:
                    return device, False
            self._last_id += 1
            device_id = str(self._last_id)
            device = self._devices[device_id] = Device(device_id, port, self._tell)
        self._tell()
        return device, True

    def _forget(self, device: Device) -> None:
        with self._lock:
            if not device.connected:
                self._devices.pop(device.view.id, None)
        self._tell()

    def _tell(self) -> None:
        with self._lock:
            listeners = list(self._listeners)
        for listener in listeners:
            listener()
