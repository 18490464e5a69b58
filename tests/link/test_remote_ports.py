"""Which ports of other machines may be reached: what isn't named is refused before anything is looked up or sent."""

import itertools
import socket
import threading

import pytest
from hypothesis import given
from hypothesis import strategies as st

from stepramp.errors import DeviceLost, Rejected
from stepramp.link import serial_port
from stepramp.link.remote_ports import Host, RemotePort, RemotePorts
from stepramp.link.serial_port import SerialPort

NAMED = ["printer.local:2217", "10.0.0.7:3000", "[fd00::7]:2217"]


@pytest.fixture
def offline(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let nothing be looked up, nor any connection be tried."""

    def touched(*_: object, **__: object) -> None:
        raise AssertionError("the network was touched")

    monkeypatch.setattr(socket, "getaddrinfo", touched)
    monkeypatch.setattr(socket, "socket", touched)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("printer.local:2217", "printer.local:2217"),
        ("Printer.LOCAL:02217", "printer.local:2217"),
        ("under_score:1", "under_score:1"),
        ("10.0.0.7:65535", "10.0.0.7:65535"),
        ("[::1]:2217", "[::1]:2217"),
        ("[FD00:0:0::07]:2217", "[fd00::7]:2217"),
        ("[::ffff:127.0.0.1]:80", "[::ffff:7f00:1]:80"),
    ],
)
def test_a_host_has_one_form_however_it_is_written(text: str, told: str) -> None:
    host = Host.of(text)
    assert host is not None
    assert str(host) in (told, told.replace("7f00:1", "127.0.0.1"))
    assert Host.of(str(host)) == host


@pytest.mark.parametrize(
    "text",
    ["", ":2217", "printer", "printer:", "printer:0", "printer:65536", "printer:-1", "printer:+1", "printer:1 ",
     "printer:2_2", "printer:٢", "printer.:1", ".printer:1", "a..b:1", "-a:1", "a-:1", "a" * 64 + ":1", "::1:2217",
     "[::1:2217", "[::1]2217", "[10.0.0.7]:1", "[fe80::1%eth0]:1", "127.1:1", "0x7f000001:1", "0x7f.1:1",
     "2130706433:1", "0177.0.0.1:1", "1.2.3.4.5:1", "999.0.0.1:1", "prínter:1", "xn—a:1", "u@printer:1",
     "printer:1@evil:2", "printer:1/", "printer:1?a", "printer:1#a", "printer:1\n", "printer\0:1", "pr inter:1", "http://printer:1",
     "%31:1"],
)  # fmt: skip
def test_what_is_no_host_is_refused_at_start(text: str) -> None:
    assert Host.of(text) is None
    with pytest.raises(Rejected) as caught:
        RemotePorts.named(["printer:1", text])
    [rejection] = caught.value.rejections
    assert (rejection.field, rejection.value) == ("--allow-remote-port", text)
    assert "host:port" in rejection.allowed


@pytest.mark.parametrize(
    "port",
    [
        "rfc2217://printer.local:2217",
        "socket://PRINTER.local:2217",
        "socket://10.0.0.7:3000",
        "rfc2217://[fd00:0::7]:2217",
    ],
)
def test_what_was_named_is_allowed(port: str) -> None:
    assert str(RemotePorts.named(NAMED).allowed(port).host) in NAMED


@pytest.mark.parametrize(
    "port",
    ["rfc2217://printer.local:2218", "rfc2217://printer:2217", "rfc2217://printer.local", "socket://10.0.0.8:3000",
     "socket://10.0.0.7:22", "socket://[::ffff:10.0.0.7]:3000", "socket://0xa000007:3000", "socket://10.7:3000",
     "socket://167772167:3000", "socket://127.0.0.1:3000", "socket://localhost:3000", "rfc2217://[fd00::8]:2217",
     "rfc2217://[fd00::7%25eth0]:2217", "rfc2217://printer.local.:2217", "rfc2217://printer.local:2217/",
     "rfc2217://printer.local:2217?timeout=9e9", "rfc2217://printer.local:2217?logging=debug",
     "rfc2217://printer.local:2217#x", "rfc2217://evil@printer.local:2217", "rfc2217://printer.local:2217@evil:1",
     "rfc2217://printer.local:2217\\@evil:1", "rfc2217://evil:1\\@printer.local:2217", "rfc2217:///printer.local:2217",
     "rfc2217://printer.local:2217,evil:1", "RFC2217://printer.local:2217", "Socket://10.0.0.7:3000",
     "http://printer.local:2217", "spy://printer.local:2217", "alt://printer.local:2217", "loop://", "hwgrep://.*",
     "cp2110://0", "tcp://10.0.0.7:3000", "rfc2217://ｐrinter.local:2217", "rfc2217://printer。local:2217",
     "rfc2217://http://printer.local:2217", "socket://", "x://socket://10.0.0.7:3000", "://printer.local:2217"],
)  # fmt: skip
@pytest.mark.usefixtures("offline")
def test_what_was_not_named_is_refused_before_the_network_is_touched(port: str) -> None:
    for allowed in (RemotePorts.named(NAMED), RemotePorts()):
        with pytest.raises(Rejected) as caught:
            SerialPort(port, remote_ports=allowed)
        [rejection] = caught.value.rejections
        assert (rejection.field, rejection.value) == ("port", port)
        assert "only hosts named at start by --allow-remote-port: " in rejection.allowed


@pytest.mark.usefixtures("offline")
def test_what_is_allowed_is_told_and_nothing_is_without_the_option() -> None:
    with pytest.raises(Rejected, match="by --allow-remote-port: none was named"):
        SerialPort("socket://10.0.0.7:3000")
    with pytest.raises(Rejected, match=r"allow-remote-port: a:1, \[::1\]:2\."):
        SerialPort("socket://10.0.0.7:3000", remote_ports=RemotePorts.named(["A:1", "[::1]:2", "a:1"]))


hosts = st.from_regex(r"[a-z0-9.:\[\]@/?#%\\-]{0,12}", fullmatch=True)


@given(scheme=st.sampled_from(["rfc2217", "socket", "RFC2217", "tcp", ""]), name=hosts, number=st.integers(-9, 99_999))
def test_no_address_is_allowed_but_that_of_a_host_that_was_named(scheme: str, name: str, number: int) -> None:
    address = f"{scheme}://{name}:{number}"
    remote = RemotePort.of(address)
    assert remote is None or RemotePort.of(str(remote)) == remote
    try:
        allowed = RemotePorts.named(["a:1"]).allowed(address)
    except Rejected:
        return
    assert (str(allowed.host), name, number) == ("a:1", "a", 1)


def found(address: str, number: int) -> list[tuple[object, ...]]:
    return [(socket.AF_INET, socket.SOCK_STREAM, 6, "", (address, number))]


def test_a_name_leads_for_good_where_it_led_first(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whoever answers for it later can't have the server speak to another host."""
    answers = iter([found("10.0.0.7", 2217), found("169.254.169.254", 2217)])
    monkeypatch.setattr(socket, "getaddrinfo", lambda *_, **__: next(answers))
    remote = RemotePorts.named(NAMED)
    host = remote.allowed("socket://printer.local:2217").host
    assert remote.places(host, 5.0) == remote.places(host, 5.0) == [(socket.AF_INET, ("10.0.0.7", 2217))]


def test_a_name_that_is_not_found_is_looked_for_again(monkeypatch: pytest.MonkeyPatch) -> None:
    tried = itertools.count()

    def look(*_: object, **__: object) -> object:
        if next(tried) == 0:
            raise socket.gaierror(socket.EAI_NONAME, "Name or service not known")
        return found("10.0.0.7", 2217)

    monkeypatch.setattr(socket, "getaddrinfo", look)
    remote = RemotePorts.named(NAMED)
    host = remote.allowed("socket://printer.local:2217").host
    with pytest.raises(DeviceLost, match=r"There is no host printer\.local on the network"):
        remote.places(host, 5.0)
    assert remote.places(host, 5.0) == [(socket.AF_INET, ("10.0.0.7", 2217))]


def test_a_name_for_which_nobody_answers_keeps_nobody_waiting(monkeypatch: pytest.MonkeyPatch) -> None:
    answered, tried = threading.Event(), itertools.count()

    def look(*_: object, **__: object) -> object:
        next(tried)
        answered.wait(30)
        return found("10.0.0.7", 2217)

    monkeypatch.setattr(socket, "getaddrinfo", look)
    remote = RemotePorts.named(NAMED)
    host = remote.allowed("socket://printer.local:2217").host
    for _ in range(3):
        with pytest.raises(DeviceLost, match=r"Nobody says where printer\.local is"):
            remote.places(host, 0.01)
    answered.set()
    assert remote.places(host, 5.0) == [(socket.AF_INET, ("10.0.0.7", 2217))]
    assert next(tried) == 1


def test_without_the_option_the_one_place_that_opens_ports_opens_none() -> None:
    assert list(serial_port.NO_REMOTE_PORTS) == []
