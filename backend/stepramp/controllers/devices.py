"""The registry of connected devices, for any thread."""

import threading
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager, suppress

from stepramp.controllers.device import Device
from stepramp.controllers.device_view import DeviceView
from stepramp.controllers.virtual import VirtualController
from stepramp.errors import NotFound, StepRampError
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
        self._last_id = 0

    def views(self) -> list[DeviceView]:
        """Return all devices as they are now, in the order in which they were connected."""
        with self._lock:
            devices = list(self._devices.values())
        return [device.view for device in devices]

    def get(self, device_id: str) -> Device:
        """Return a device; NotFound when there is none of that id."""
        with self._lock:
            device = self._devices.get(device_id)
        if device is None:
            raise NotFound(f"There is no device {device_id!r}.")
        return device

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
        with self._lock:
            devices = list(self._devices.values())
        pending = []
        for device in devices:
            with suppress(StepRampError):
                pending.append(device.stop())
        for stopped in pending:
            with suppress(StepRampError):
                stopped.result()

    def close(self) -> None:
        """Stop what moves and let go of all devices."""
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
