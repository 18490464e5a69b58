"""What listens where Moonraker should: each told in its own words."""

from __future__ import annotations

import contextlib
import json
import logging
import socket
import threading
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import pytest
from websockets.frames import Frame, Opcode
from websockets.server import ServerProtocol

from controllers.klipper.server import MoonrakerServer
from link.far_host import FarHost, Serve, says_nothing
from stepramp.devices.registry import Devices
from stepramp.errors import DeviceLost, Refused, Rejected
from stepramp.link.moonraker_port import MoonrakerPort
from stepramp.link.remote_ports import KEYS_VARIABLE, RemotePorts
from waiting import PATIENCE_S

KEY = "7f3a1c5e9b2d4860"
ANSWERS = {
    "server.info": {"klippy_state": "error"},
    "printer.info": {"state": "error", "state_message": "No", "config_file": "/config/printer.cfg"},
    "server.files.roots": [{"name": "config", "path": "/config"}],
}


def shakes_hands(after: Callable[[ServerProtocol, socket.socket], None]) -> Serve:
    """Serve a WebSocket up to its handshake; what comes then is for `after` to say."""

    def serve(connection: socket.socket, ended: threading.Event) -> None:
        protocol = ServerProtocol()
        while not (requests := protocol.events_received()):
            protocol.receive_data(connection.recv(4096))
        protocol.send_response(protocol.accept(requests[0]))
        connection.sendall(b"".join(protocol.data_to_send()))
        # What comes with the handshake, and what comes after it, is the same to whoever reads.
        ended.wait(0.05)
        after(protocol, connection)
        connection.sendall(b"".join(protocol.data_to_send()))
        while not ended.wait(0.01) and connection.recv(4096):
            pass

    return serve


def says(data: bytes) -> Serve:
    def serve(connection: socket.socket, ended: threading.Event) -> None:
        connection.recv(4096)
        connection.sendall(data)
        ended.wait(PATIENCE_S)

    return serve


def noise(connection: socket.socket, ended: threading.Event) -> None:
    while not ended.is_set():
        connection.sendall(bytes(range(256)) * 16)


def drips(connection: socket.socket, ended: threading.Event) -> None:
    for each in b"HTTP/1.1 101 Switching Protocols\r\n" * 100:
        connection.sendall(bytes([each]))
        if ended.wait(0.2):
            return


def at_once(_: socket.socket, __: threading.Event) -> None:
    return


ODD: dict[str, tuple[Serve, type[Exception], str]] = {
    "silent": (says_nothing, DeviceLost, "Nothing answers at"),
    "noise": (noise, Refused, "Something talks at"),
    "drips": (drips, Refused, "Something talks at"),
    "ends": (at_once, DeviceLost, "Nothing answers at|ends the connection at once"),
    "ssh": (says(b"SSH-2.0-OpenSSH_9.2\r\n"), Refused, "it is no Moonraker"),
    "a web server": (says(b"HTTP/1.1 404 Not Found\r\nContent-Length: 0\r\n\r\n"), Refused, "it is no Moonraker"),
    "a page": (says(b"HTTP/1.1 200 OK\r\nContent-Length: 2\r\n\r\nhi"), Refused, "it is no Moonraker"),
    "a silent WebSocket": (shakes_hands(lambda _, __: None), DeviceLost, "Nothing answers at .* as Moonraker does"),
    "half a frame": (shakes_hands(lambda _, it: it.sendall(b"\x81\x7d{")), DeviceLost, "Nothing answers at"),
    "half a message": (
        shakes_hands(lambda protocol, _: protocol.send_text(b'{"id": 1', fin=False)),
        DeviceLost,
        "Nothing answers at",
    ),
    "another program's messages": (
        shakes_hands(lambda protocol, _: protocol.send_text(b'{"hello": "world"}')),
        Refused,
        "it is no Moonraker",
    ),
    "no frame": (shakes_hands(lambda _, it: it.sendall(b"\xff\xff\xff\xff")), DeviceLost, "Nothing answers at"),
    "a farewell": (shakes_hands(lambda protocol, _: protocol.send_close(1001)), DeviceLost, "Nothing answers at"),
}


def test_what_is_no_moonraker_is_told() -> None:
    def tried(name: str) -> None:
        serve, error, words = ODD[name]
        with FarHost(serve) as host:
            devices = Devices(remote_ports=RemotePorts.named([host.name]))
            began_s = time.monotonic()
            with pytest.raises(error, match=words) as caught:
                devices.connect(f"moonraker://{host.name}", "klipper")
            assert time.monotonic() - began_s < PATIENCE_S, name
            assert host.name in str(caught.value)
            assert devices.views() == []
            devices.close()

    with ThreadPoolExecutor(5) as pool:
        for each in [pool.submit(tried, name) for name in ODD]:
            each.result()


def test_a_message_comes_in_whole_however_it_is_cut() -> None:
    message = '{"jsonrpc": "2.0", "method": "notify_gcode_response", "params": ["\u00b5"]}'.encode()

    def in_drops(protocol: ServerProtocol, connection: socket.socket) -> None:
        protocol.send_text(message[:10], fin=False)
        protocol.send_ping(b"there?")
        # In the midst of a character.
        protocol.send_continuation(message[10:69], fin=False)
        protocol.send_continuation(message[69:], fin=True)
        protocol.send_text(b"next")
        for each in b"".join(protocol.data_to_send()):
            connection.sendall(bytes([each]))

    with FarHost(shakes_hands(in_drops)) as host:
        port = MoonrakerPort(f"moonraker://{host.name}", remote_ports=RemotePorts.named([host.name]))
        assert port.read(5.0) == message
        assert port.read(5.0) == b"next"
        assert port.pending() == b""
        port.close()


def test_a_connection_that_ends_is_lost_once_all_was_heard() -> None:
    def ends(protocol: ServerProtocol, _: socket.socket) -> None:
        protocol.send_text(b"last")
        protocol.send_close(1001)

    with FarHost(shakes_hands(ends)) as host:
        port = MoonrakerPort(f"moonraker://{host.name}", remote_ports=RemotePorts.named([host.name]))
        assert port.read(5.0) == b"last"
        for _ in range(2):
            with pytest.raises(DeviceLost, match="the connection has ended"):
                port.read(5.0)
        with pytest.raises(DeviceLost, match="the connection has ended"):
            port.write(b"{}")
        port.close()


@pytest.mark.parametrize(
    "address",
    [
        "moonraker://127.0.0.1:1",
        "moonraker://localhost:7125",
        "moonraker://127.0.0.1",
        "moonraker://key@127.0.0.1:7125",
        "moonraker://127.0.0.1:7125/",
        "Moonraker://127.0.0.1:7125",
        "http://127.0.0.1:7125",
        "socket://127.0.0.1:7125",
    ],
)
def test_only_hosts_that_were_named_are_reached(address: str) -> None:
    with pytest.raises(Rejected, match=r"moonraker://host:port, only hosts named at start by --allow-remote-port: 127"):
        MoonrakerPort(address, remote_ports=RemotePorts.named(["127.0.0.1:7125"]))


def test_families_and_ports_that_go_together() -> None:
    devices = Devices(remote_ports=RemotePorts.named(["printer:7125"]))
    assert devices.families_at("moonraker://printer:7125") == ["klipper"]
    assert "klipper" not in devices.families_at("socket://printer:7125")
    assert "moonraker://printer:7125" in [port.port for port in devices.ports()]
    with pytest.raises(Rejected, match="family"):
        devices.connect("moonraker://printer:7125", "grbl")
    devices.close()


def test_the_key_is_sent_and_told_nowhere(caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level(logging.DEBUG, "stepramp")
    with MoonrakerServer(key=KEY) as server:
        for keys in ("", f"{server.host}=wrong", f"127.0.0.1:1={KEY}"):
            with pytest.raises(Refused, match=f"without its API key: start StepRamp with the variable {KEYS_VARIABLE}"):
                MoonrakerPort(server.address, remote_ports=RemotePorts.named([server.host], keys))
        remote = RemotePorts.named([server.host], f"{server.host}={KEY}")
        port = MoonrakerPort(server.address, remote_ports=remote)
        assert port.request("GET", "/server/files/config/printer.cfg", lambda _: None).status == 200
        port.write(b'{"jsonrpc": "2.0", "method": "server.info", "id": 1}')
        assert b"klippy_state" in port.read(2.0)
        port.close()
        devices = Devices(remote_ports=remote)
        device = devices.connect(server.address, "klipper")
        assert KEY not in repr(device.view)
        devices.close()
    assert "server.info" in caplog.text
    assert KEY not in caplog.text


@pytest.mark.parametrize("keys", ["host", "host:1", "host:1=", "host:0=a", "host:1=a\u00e9", f"=x {KEY}"])
def test_keys_that_are_none_are_not_told_back(keys: str) -> None:
    with pytest.raises(Rejected, match=f"{KEYS_VARIABLE}.*host:port=key") as caught:
        RemotePorts.named([], keys)
    assert KEY not in str(caught.value)


@pytest.mark.parametrize("answer", [b"", b"nonsense", b"HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\nzz\r\n"])
def test_files_that_are_answered_with_nonsense(answer: bytes) -> None:
    served = threading.Event()

    def serve(connection: socket.socket, ended: threading.Event) -> None:
        if not served.is_set():
            served.set()
            shakes_hands(lambda _, __: None)(connection, ended)
        else:
            connection.recv(4096)
            connection.sendall(answer)

    with FarHost(serve) as host:
        port = MoonrakerPort(f"moonraker://{host.name}", remote_ports=RemotePorts.named([host.name]))
        with pytest.raises(DeviceLost, match="makes no sense"):
            port.request("GET", "/server/files/config/printer.cfg", lambda _: None)
        port.close()


def test_files_that_are_never_answered_are_told() -> None:
    """Of a Klipper that isn't ready its files tell what axes it has."""

    def answers(protocol: ServerProtocol, connection: socket.socket) -> None:
        while data := connection.recv(4096):
            protocol.receive_data(data)
            for frame in protocol.events_received():
                if not isinstance(frame, Frame) or frame.opcode is not Opcode.TEXT:
                    return
                question = json.loads(frame.data)
                answer = {"jsonrpc": "2.0", "id": question["id"], "result": ANSWERS.get(question["method"], {})}
                protocol.send_text(json.dumps(answer).encode())
            connection.sendall(b"".join(protocol.data_to_send()))

    served = threading.Event()

    def serve(connection: socket.socket, ended: threading.Event) -> None:
        if served.is_set():
            ended.wait()
        served.set()
        shakes_hands(answers)(connection, ended)

    with FarHost(serve) as host:
        devices = Devices(remote_ports=RemotePorts.named([host.name]))
        began_s = time.monotonic()
        with pytest.raises(DeviceLost, match=f"The Moonraker at moonraker://{host.name} doesn't give its files"):
            devices.connect(f"moonraker://{host.name}", "klipper")
        assert time.monotonic() - began_s < PATIENCE_S
        devices.close()


def test_what_may_not_be_sent_is_not_sent() -> None:
    def refuse() -> None:
        raise Refused("A stop came first.")

    with MoonrakerServer() as server:
        port = MoonrakerPort(server.address, refuse, RemotePorts.named([server.host]))
        for act in (lambda: port.write(b"{}"), lambda: port.request("GET", "/server/info", lambda _: None)):
            with pytest.raises(Refused, match="A stop came first"):
                act()
        port.close()
        assert server.moonraker.asked == []


def test_a_flood_without_a_message_keeps_nothing_waiting() -> None:
    def pings(protocol: ServerProtocol, connection: socket.socket) -> None:
        with contextlib.suppress(OSError):
            while True:
                protocol.send_ping(b"there?")
                connection.sendall(b"".join(protocol.data_to_send()))

    with FarHost(shakes_hands(pings)) as host:
        port = MoonrakerPort(f"moonraker://{host.name}", remote_ports=RemotePorts.named([host.name]))
        assert port.read(0.3) == b""
        assert port.pending() == b""
        port.close()


def test_a_file_that_comes_in_without_a_pause_gives_way_to_what_is_more_urgent() -> None:
    served, urgent = threading.Event(), threading.Event()

    def serve(connection: socket.socket, ended: threading.Event) -> None:
        if not served.is_set():
            served.set()
            shakes_hands(lambda _, __: None)(connection, ended)
            return
        connection.recv(4096)
        connection.sendall(b"HTTP/1.1 200 OK\r\nContent-Length: 4\r\n\r\n")
        # Nothing else is said before what is more urgent was let through.
        for _ in range(1000):
            connection.sendall(b" ")
            if urgent.wait(0.001):
                break
        connection.sendall(b"text")

    with FarHost(serve) as host:
        port = MoonrakerPort(f"moonraker://{host.name}", remote_ports=RemotePorts.named([host.name]))
        reply = port.request("GET", "/server/files/config/printer.cfg", lambda _: urgent.set())
        assert (reply.status, urgent.is_set()) == (200, True)
        port.close()
