"""Controllers at other machines: the addresses of their ports, and which of them may be reached at all.

Whoever may use the server may name a port to it: also a page or a program that would have it speak to whatever else is
on the network. So an address is compared with the hosts that were named at start before its name is resolved or
anything is sent, and a name leads for good where it led first, whoever answers for it later.
"""

import re
import socket
import threading
from collections.abc import Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Future
from dataclasses import dataclass
from ipaddress import ip_address
from typing import Literal, Self

from stepramp.errors import DeviceLost, Rejected, Rejection

Scheme = Literal["rfc2217", "socket", "moonraker"]
SERIAL_SCHEMES: tuple[Scheme, ...] = ("rfc2217", "socket")
SCHEMES: tuple[Scheme, ...] = (*SERIAL_SCHEMES, "moonraker")
OPTION = "--allow-remote-port"
KEYS_VARIABLE = "STEPRAMP_MOONRAKER_KEYS"
"""Has the API keys of Moonrakers that want one: host:port=key, with blanks between several."""
_HOST = re.compile(r"(?:\[([0-9A-Fa-f:.]+)\]|([A-Za-z0-9._-]{1,253})):([0-9]{1,5})")
_LABEL = re.compile(r"[A-Za-z0-9_](?:[A-Za-z0-9_-]{0,61}[A-Za-z0-9_])?")
_NUMBER = re.compile(r"[0-9]+|0[xX][0-9A-Fa-f]*")
_KEY = re.compile(r"[A-Za-z0-9._-]{1,256}")

Place = tuple[socket.AddressFamily, tuple[str, int] | tuple[str, int, int, int] | tuple[int, bytes]]
"""Where a connection leads: the family of addresses, and the address in it."""


@dataclass(frozen=True)
class Host:
    """A host and the number of a TCP port there, in one form however they were written."""

    name: str
    """In lower case; an IP address in its shortest form, without brackets."""
    number: int

    @classmethod
    def of(cls, text: str) -> Self | None:
        """Return what a text such as printer:2217, 10.0.0.7:2217 or [::1]:2217 names; None when that is no host."""
        found = _HOST.fullmatch(text)
        if found is None or not 1 <= int(found[3]) <= 65_535:
            return None
        name = _ip(found[1], version=6) if found[1] else _name(found[2])
        return None if name is None else cls(name, int(found[3]))

    def __str__(self) -> str:
        return f"[{self.name}]:{self.number}" if ":" in self.name else f"{self.name}:{self.number}"


@dataclass(frozen=True)
class RemotePort:
    """A port of another machine: where it is, and how bytes travel there."""

    scheme: Scheme
    """rfc2217: a serial port, whose baud rate is told along the way. socket: nothing but its bytes. moonraker: no
    serial port, but Klipper's server."""
    host: Host

    @classmethod
    def of(cls, address: str) -> Self | None:
        """Return what an address such as rfc2217://printer:2217 names; None when it is none.

        It has nothing else in it: no user, no path, no options.
        """
        for scheme in SCHEMES:
            if address.startswith(f"{scheme}://") and (host := Host.of(address.removeprefix(f"{scheme}://"))):
                return cls(scheme, host)
        return None

    def __str__(self) -> str:
        return f"{self.scheme}://{self.host}"


class RemotePorts:
    """The hosts whose ports may be reached, and the keys that some of them want. For any thread."""

    def __init__(self, hosts: Iterable[Host] = (), keys: Mapping[Host, str] | None = None) -> None:
        self._hosts = tuple(dict.fromkeys(hosts))
        self._keys = dict(keys or {})
        self._lock = threading.Lock()
        self._places: dict[Host, Future[list[Place]]] = {}

    @classmethod
    def named(cls, texts: Iterable[str], keys: str = "") -> Self:
        """Return those that the command line names, each as host:port; Rejected when one is none.

        keys: as in KEYS_VARIABLE. What is rejected of them is not told: it may be a key.
        """
        hosts = {text: Host.of(text) for text in texts}
        allowed = "host:port, as printer.local:2217 or [::1]:2217, the port from 1 to 65,535"
        wrong = [Rejection(OPTION, text, allowed) for text, host in hosts.items() if host is None]
        pairs = [(Host.of(name), key) for name, _, key in (each.partition("=") for each in keys.split())]
        if any(host is None or not _KEY.fullmatch(key) for host, key in pairs):
            wrong.append(Rejection(KEYS_VARIABLE, "", "host:port=key, with blanks between several"))
        if wrong:
            raise Rejected(wrong)
        known = {host: key for host, key in pairs if host is not None}
        return cls((host for host in hosts.values() if host is not None), known)

    def __iter__(self) -> Iterator[RemotePort]:
        """Yield each way to each of the hosts."""
        return (RemotePort(scheme, host) for host in self._hosts for scheme in SCHEMES)

    def allowed(self, address: str, schemes: Sequence[Scheme] = SERIAL_SCHEMES, besides: str = "") -> RemotePort:
        """Return the port of an address; Rejected for one that is none, or of a host that was not named.

        besides: what else a port may be called, as the beginning of what is allowed.
        """
        remote = RemotePort.of(address)
        if remote is not None and remote.scheme in schemes and remote.host in self._hosts:
            return remote
        named = ", ".join(map(str, self._hosts)) or "none was named"
        ways = " or ".join(f"{scheme}://host:port" for scheme in schemes)
        raise Rejected([Rejection("port", address, f"{besides}{ways}, only hosts named at start by {OPTION}: {named}")])

    def key_of(self, host: Host) -> str | None:
        """Return the API key of a host; None for none."""
        return self._keys.get(host)

    def places(self, host: Host, within_s: float) -> list[Place]:
        """Return where a host is: as it was found the first time; DeviceLost when it isn't found in time [s]."""
        with self._lock:
            finding = self._places.get(host)
            if finding is None or (finding.done() and finding.exception() is not None):
                finding = self._places[host] = Future()
                # Nothing ends the system's search for a name; in a thread of its own it keeps nobody waiting.
                threading.Thread(target=_find, args=(host, finding), name=f"name of {host}", daemon=True).start()
        try:
            return finding.result(within_s)
        except TimeoutError as error:
            raise DeviceLost(f"Nobody says where {host.name} is: is the network there?") from error
        except (OSError, UnicodeError) as error:
            raise DeviceLost(f"There is no host {host.name} on the network.") from error


def _find(host: Host, finding: "Future[list[Place]]") -> None:
    try:
        found = socket.getaddrinfo(host.name, host.number, type=socket.SOCK_STREAM)
    except (OSError, UnicodeError) as error:
        finding.set_exception(error)
    else:
        finding.set_result([(family, address) for family, _, _, _, address in found])


def _name(text: str) -> str | None:
    """Return a name in lower case, or an IPv4 address; None for anything else, also for what is read as an address.

    The system takes 127.1, 0x7f000001 and 2130706433 for addresses, too: they are none here.
    """
    labels = text.split(".")
    if _NUMBER.fullmatch(labels[-1]):
        return _ip(text, version=4)
    return text.lower() if all(map(_LABEL.fullmatch, labels)) else None


def _ip(text: str, version: int) -> str | None:
    try:
        address = ip_address(text)
    except ValueError:
        return None
    return str(address) if address.version == version else None
