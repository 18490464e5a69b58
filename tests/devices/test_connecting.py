"""Connecting to a port, which moves nothing."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from controllers.usb_board import Cable
from designs import design
from devices.boards import Silent
from devices.motion import PATIENCE_S
from stepramp.controllers.stepramp import conversation
from stepramp.devices import registry as devices_module
from stepramp.devices.device import Device
from stepramp.devices.registry import Devices
from stepramp.devices.shared_attempt import SharedAttempt
from stepramp.devices.view import DeviceState
from stepramp.errors import DeviceLost, NotFound, Refused, Rejected
from stepramp.link.ports import Port


def test_connecting_moves_nothing(devices: Devices, port: str) -> None:
    view = devices.connect(port).view
    assert (view.id, view.port, view.name, view.state) == ("1", port, "Virtual controller", DeviceState.READY)
    assert (view.timer_hz, view.firmware_version, view.ramp, view.pushed) == (2_000_000, "0.2.0", None, None)
    assert (view.position_steps, view.target_steps, view.speed_steps_per_s) == (0, 0, 0.0)


def test_connecting_again_returns_the_same_device(devices: Devices, port: str) -> None:
    assert devices.connect(port) is devices.connect(port)
    with ThreadPoolExecutor(8) as pool:
        assert len(set(pool.map(devices.connect, [port] * 8))) == 1
    assert len(devices.views()) == 1


def test_two_threads_connect_a_new_port_at_once(devices: Devices, port: str) -> None:
    with ThreadPoolExecutor(8) as pool:
        assert {device.view.id for device in pool.map(devices.connect, [port] * 8)} == {"1"}


def test_a_mute_port_is_tried_once_for_all_who_ask(
    devices: Devices, plug_in: Callable, monkeypatch: pytest.MonkeyPatch
) -> None:
    """One after the other they would wait for eight times as long."""
    monkeypatch.setattr(conversation, "MOST_HELLOS", 1)
    asked, all_ask = threading.Semaphore(0), threading.Event()
    opened = []

    class Mute(Silent):
        def opened(self) -> None:
            opened.append(1)
            assert all_ask.wait(PATIENCE_S)

    connect = Device.connect

    def counted(device: Device, port: str | None) -> None:
        asked.release()
        connect(device, port)

    monkeypatch.setattr(Device, "connect", counted)
    port = plug_in(Mute())
    with ThreadPoolExecutor(8) as pool:
        connecting = [pool.submit(devices.connect, port) for _ in range(8)]
        for _ in range(8):
            assert asked.acquire(timeout=PATIENCE_S)
        time.sleep(0.1)  # Those who were counted last have still to ask.
        all_ask.set()
        for each in connecting:
            with pytest.raises(DeviceLost, match="Nothing answers at"):
                each.result(PATIENCE_S)
    assert len(opened) == 1
    assert devices.views() == []


def test_whoever_connects_at_one_port_does_not_get_what_comes_of_another() -> None:
    attempt, at_first, goes_on = SharedAttempt(), threading.Event(), threading.Event()

    def fail() -> None:
        at_first.set()
        assert goes_on.wait(PATIENCE_S)
        raise DeviceLost("Nothing answers at the first.")

    with ThreadPoolExecutor(1) as pool:
        first = pool.submit(attempt, "first", fail)
        assert at_first.wait(PATIENCE_S)
        attempt("second", goes_on.set)
        with pytest.raises(DeviceLost):
            first.result(PATIENCE_S)


def test_what_cant_be_connected_is_forgotten(devices: Devices) -> None:
    with pytest.raises(DeviceLost):
        devices.connect("/dev/there-is-none")
    with pytest.raises(Rejected):
        devices.connect("spy://x")
    assert devices.views() == []
    with pytest.raises(NotFound, match="'1'"):
        devices.get("1")


def test_the_ramp_outlives_the_connection(devices: Devices, port: str) -> None:
    devices.connect(port).push([design()])
    devices.disconnect("1")
    device = devices.connect(port)
    assert device.view.id == "2"
    assert device.view.ramp is not None
    assert device.view.pushed is None


def test_what_is_not_connected_yet_cant_be_asked(
    devices: Devices, plug_in: Callable, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(conversation, "MOST_HELLOS", 2)
    with ThreadPoolExecutor(1) as pool:
        connecting = pool.submit(devices.connect, plug_in(Silent()))
        while not devices.views():
            time.sleep(0.001)
        device = devices.get("1")
        assert device.view.state is DeviceState.CONNECTING
        with pytest.raises(Refused, match="still being connected"):
            device.stop()
        with pytest.raises(DeviceLost, match="Nothing answers at"):
            connecting.result(PATIENCE_S)
    assert devices.views() == []


def test_a_port_has_one_device_whatever_it_is_called(devices: Devices, cable: Cable, tmp_path: Path) -> None:
    device = devices.connect(str(cable.port))
    by_id = tmp_path / "by-id"
    by_id.symlink_to(cable.port)
    for name in (by_id, cable.port.resolve(), tmp_path / ".." / tmp_path.name / cable.port.name):
        assert devices.connect(str(name)) is device
    assert [view.port for view in devices.views()] == [str(cable.port)]


def test_the_ports_are_listed_without_keeping_anyone_waiting(
    devices: Devices, port: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    listing, go_on = threading.Event(), threading.Event()

    def slow(name: str) -> Port:
        listing.set()
        assert go_on.wait(PATIENCE_S)
        return Port(name, name)

    monkeypatch.setattr(devices_module, "known_port", slow)
    with ThreadPoolExecutor(2) as pool:
        connecting = pool.submit(devices.connect, port)
        assert listing.wait(PATIENCE_S)
        assert pool.submit(devices.views).result(PATIENCE_S) == []
        go_on.set()
        connecting.result(PATIENCE_S)


def test_nothing_is_looked_for_before_the_server_begins() -> None:
    """Its thread belongs to the server's life, not to the making of the application."""
    before = threading.active_count()
    devices = Devices()
    assert threading.active_count() == before
    devices.close()
