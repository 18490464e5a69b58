"""The server of the page, as `stepramp serve` starts it."""

import gc
import ipaddress
import logging
import os
import re
import socket
import ssl
import sys
import threading
import webbrowser
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Self

from stepramp.client.servers import Server, noted
from stepramp.data_folder import FOLDER_VARIABLE
from stepramp.errors import Rejected, Rejection
from stepramp.link.remote_ports import KEYS_VARIABLE, RemotePorts

LOOPBACK = "127.0.0.1"
FIRST_PORT = 8000
PORTS_TRIED = 100
A_FOLDER = "a folder that can be written"
LOG_LEVELS = ("critical", "error", "warning", "info", "debug")
SWITCH_S = 0.0005
"""After so long a thread that computes in Python lets another go on [s]. A stop wakes several, one after the other."""
_LABEL = "[a-z0-9_]([a-z0-9_-]{0,61}[a-z0-9_])?"
_PUBLIC_URL = re.compile(
    rf"(?P<scheme>https?)://(?P<host>{_LABEL}(\.{_LABEL})*|\[[0-9a-f:.]+\])(:(?P<port>[0-9]{{1,5}}))?/?"
)
_USUAL_PORTS = {"http": 80, "https": 443}


def port_number(text: str) -> int:
    """Return a port number.

    Raises Rejected when the text isn't one.
    """
    if text.isascii() and text.isdigit() and 1 <= int(text) <= 65535:
        return int(text)
    raise Rejected([Rejection("--port", text, "a whole number from 1 to 65,535")])


def log_level(text: str) -> int:
    """Return a level of the standard logging.

    Raises Rejected when the text names none of LOG_LEVELS.
    """
    if text in LOG_LEVELS:
        return logging.getLevelNamesMapping()[text.upper()]
    raise Rejected([Rejection("--log-level", text, ", ".join(LOG_LEVELS))])


def public_url(text: str) -> str:
    """Return how a server is reached, as browsers tell where a page comes from.

    Raises Rejected when the text is no such address.
    """
    match = _PUBLIC_URL.fullmatch(text.strip().lower())
    try:
        scheme, host, port = match.group("scheme", "host", "port") if match else ("", "", "0")
        if host.startswith("["):
            host = f"[{ipaddress.IPv6Address(host[1:-1])}]"
        if port is None or 1 <= int(port) <= 65535:
            is_usual = port is None or int(port) == _USUAL_PORTS[scheme]
            return f"{scheme}://{host}" if is_usual else f"{scheme}://{host}:{int(port)}"
    except ValueError:
        pass
    allowed = "http:// or https://, a host, and its port if it has one, as https://lab.example"
    raise Rejected([Rejection("--public-url", text, allowed)])


def usable_data_folder(named: str | None) -> Path | None:
    """Return the folder that is named for data, None for the user's own. Raises Rejected for what can't be one.

    One that is there is taken, full or not to be written to: the page works without its library.
    """
    field, name = ("--data-folder", named) if named is not None else (FOLDER_VARIABLE, os.environ.get(FOLDER_VARIABLE))
    if not name:
        if named is not None:
            raise Rejected([Rejection(field, named, A_FOLDER)])
        return None
    try:
        Path(name).mkdir(parents=True, exist_ok=True)
    except (OSError, ValueError):
        raise Rejected([Rejection(field, name, A_FOLDER)]) from None
    return None if named is None else Path(named)


@dataclass(frozen=True)
class Tls:
    """Files of a certificate and its key."""

    certfile: str
    keyfile: str

    @classmethod
    def named(cls, certfile: str | None, keyfile: str | None) -> Self | None:
        """Return both, None where none is named. Raises Rejected for one alone, and for what is none."""
        if certfile is None and keyfile is None:
            return None
        if certfile is None or keyfile is None:
            missing, named = ("--keyfile", "--certfile") if keyfile is None else ("--certfile", "--keyfile")
            raise Rejected([Rejection(missing, None, f"a file, since {named} is given")])
        for option, file in (("--certfile", certfile), ("--keyfile", keyfile)):
            if not Path(file).is_file():
                raise Rejected([Rejection(option, file, "a file that can be read")])
        try:
            # A key with a password would be asked for at the terminal.
            ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER).load_cert_chain(certfile, keyfile, password=lambda: b"")
        except (OSError, ssl.SSLError) as error:
            why = (error.strerror if isinstance(error, OSError) else None) or str(error)
            allowed = f"a certificate in PEM, whose key --keyfile has, without a password ({why})"
            raise Rejected([Rejection("--certfile", certfile, allowed)]) from None
        return cls(certfile, keyfile)


def free_port(first: int, host: str = LOOPBACK) -> socket.socket:
    """Return a listening socket on the first free port of an address from `first` on.

    Raises Rejected for what is no address of this machine, and when a hundred ports in a row are taken.
    """
    family = _family_of(host)
    last = min(first + PORTS_TRIED - 1, 65535)
    for port in range(first, last + 1):
        # With the protocol named, asyncio sends an answer at once; else its second part waits until the first has
        # been acknowledged, 40 ms later.
        listener = socket.socket(family, socket.SOCK_STREAM, socket.IPPROTO_TCP)
        if os.name == "posix":
            # A port of a server that has just ended is free again at once; one in use stays refused. Windows does both
            # without it, and with it would share a port in use.
            listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            listener.bind((host, port))
            listener.listen(128)
        except OSError:
            listener.close()
        else:
            return listener
    raise Rejected([Rejection("--port", first, f"a port with a free one from {first:,} to {last:,}")])


def _family_of(host: str) -> socket.AddressFamily:
    """Return the family of an address of this machine. Raises Rejected for what is none."""
    allowed = "an IP address of this machine; 0.0.0.0 stands for all of its own"
    try:
        address = ipaddress.ip_address(host)
        family = socket.AF_INET if address.version == 4 else socket.AF_INET6
        with socket.socket(family, socket.SOCK_STREAM) as probe:
            probe.bind((host, 0))
    except (OSError, ValueError):
        raise Rejected([Rejection("--host", host, allowed)]) from None
    return family


def serve(
    listener: socket.socket,
    remote_ports: RemotePorts,
    *,
    open_page: bool,
    data: Path | None = None,
    tls: Tls | None = None,
    require_token: bool = False,
    public: str | None = None,
) -> None:
    """Serve the page and the API until interrupted.

    remote_ports: those of other machines that may be connected to. data: the folder of what outlasts the program. tls:
    how it is spoken to; None: over plain HTTP. require_token: also where it listens to this machine only; where it
    listens to others, or these reach it at a public address, everybody has to show one.
    """
    # These load slowly: not for --help, nor for a command that asks a server
    import uvicorn  # noqa: PLC0415

    from stepramp.http_api.access import Access, Role  # noqa: PLC0415
    from stepramp.http_api.app import create_app  # noqa: PLC0415
    from stepramp.http_api.bodies import MOST_BYTES as MOST_BODY_BYTES  # noqa: PLC0415
    from stepramp.http_api.connections import MOST_NEW, allow_descriptors  # noqa: PLC0415
    from stepramp.http_api.request_numbers import numbering  # noqa: PLC0415
    from stepramp.http_api.server import GRACE_S, Sockets  # noqa: PLC0415
    from stepramp.http_api.server import Server as Running  # noqa: PLC0415

    host, port = listener.getsockname()[:2]
    is_shared = require_token or public is not None or not ipaddress.ip_address(host).is_loopback
    access = Access.with_new_tokens(is_encrypted=tls is not None, public_url=public) if is_shared else None
    name = f"[{host}]" if ":" in host else host
    scheme = "http" if tls is None else "https"
    # Nobody can open 0.0.0.0: it stands for all addresses of this machine.
    addresses = [f"{scheme}://{each}:{port}/" for each in names_elsewhere(host) or [_name_here(host)]]
    address = addresses[0]
    # Within one machine, compressing what goes over a WebSocket takes longer than sending it.
    app = create_app(remote_ports=remote_ports, data=data, access=access, host=name)
    config = uvicorn.Config(
        app,
        log_level="warning",
        access_log=False,
        proxy_headers=False,  # Whoever asks could say in them who they are.
        http=numbering(app.state.devices.order.next, app.state.connections),
        ws=Sockets,
        ws_per_message_deflate=False,
        ws_max_size=MOST_BODY_BYTES,
        backlog=MOST_NEW,
        timeout_graceful_shutdown=GRACE_S,
        ssl_certfile=None if tls is None else tls.certfile,
        ssl_keyfile=None if tls is None else tls.keyfile,
    )
    allow_descriptors()
    server = Running(config, app.state.devices.end_motion)
    sys.setswitchinterval(SWITCH_S)
    # What is loaded by now stays: to look through it for garbage again and again would halt all threads for 0.1 s.
    gc.freeze()
    print(f"StepRamp is at {address} (Ctrl+C ends it)", flush=True)
    if access is not None:
        if public is not None:
            addresses = [f"{public}/"]
        for each in addresses:
            print(f"  to operate: {each}?token={access.token_of(Role.OPERATE)}")
            print(f"  to look on: {each}?token={access.token_of(Role.VIEW)}", flush=True)
        if not access.is_reached_over_tls:
            print("  Tokens go over the network as they are: --certfile and --keyfile encrypt them.", flush=True)
        address = f"{addresses[0]}?token={access.token_of(Role.OPERATE)}"
    if open_page:
        # The socket listens already: a browser that is quicker than the server waits for it.
        threading.Thread(target=webbrowser.open, args=(address,), daemon=True).start()
    app.state.connections.listen(listener)
    token = None if access is None else access.token_of(Role.OPERATE)
    certificate = None if tls is None else str(Path(tls.certfile).resolve())
    with noted(Server(f"{scheme}://{_name_here(host)}:{port}", token, certificate), data):
        server.serve_until_ended(listener)


def begin(options: "Options") -> None:
    """Start the server as the command line says, until it is interrupted. Raises Rejected for what can't be used."""
    logging.basicConfig(format="%(asctime)s.%(msecs)03d %(levelname)s %(name)s: %(message)s", datefmt="%H:%M:%S")
    logging.getLogger("stepramp").setLevel(log_level(options.log_level))
    remote_ports = RemotePorts.named(options.allow_remote_port, os.environ.get(KEYS_VARIABLE, ""))
    tls = Tls.named(options.certfile, options.keyfile)
    public = None if options.public_url is None else public_url(options.public_url)
    data = usable_data_folder(options.data_folder)
    listener = free_port(port_number(options.port), options.host)
    with suppress(KeyboardInterrupt):  # Ended before there was a server.
        serve(
            listener,
            remote_ports,
            open_page=not options.no_browser,
            data=data,
            tls=tls,
            require_token=options.require_token,
            public=public,
        )


@dataclass(frozen=True)
class Options:
    """What the command line says of a server; see there."""

    host: str
    port: str
    require_token: bool
    public_url: str | None
    certfile: str | None
    keyfile: str | None
    no_browser: bool
    data_folder: str | None
    log_level: str
    allow_remote_port: tuple[str, ...]


def names_elsewhere(host: str) -> list[str]:
    """Return how the server is reached from other machines where it listens to all of them: address, and name.

    Empty where it listens at one address.
    """
    if not ipaddress.ip_address(host).is_unspecified:
        return []
    names = [socket.gethostname()]
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    with suppress(OSError), socket.socket(family, socket.SOCK_DGRAM) as probe:
        # Nothing is sent: it only tells from which address this machine would. That of a network for documentation.
        probe.connect(("2001:db8::1" if ":" in host else "192.0.2.1", 9))
        own = probe.getsockname()[0]
        names.insert(0, f"[{own}]" if ":" in own else own)
    return names


def _name_here(host: str) -> str:
    """Return how the server is reached from this machine, as it stands in an address."""
    if ipaddress.ip_address(host).is_unspecified:
        return "[::1]" if ":" in host else LOOPBACK
    return f"[{host}]" if ":" in host else host
