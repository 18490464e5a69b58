"""The command line: `stepramp` starts the server and opens the page; `stepramp export` writes a design as a file."""

import argparse
import gc
import ipaddress
import json
import logging
import os
import socket
import ssl
import sys
import threading
import webbrowser
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Self

import uvicorn

from stepramp.errors import Rejected, Rejection
from stepramp.link.remote_ports import KEYS_VARIABLE, RemotePorts
from stepramp.version import __version__

LOOPBACK = "127.0.0.1"
FIRST_PORT = 8000
PORTS_TRIED = 100
LOG_LEVELS = ("critical", "error", "warning", "info", "debug")
MOST_BYTES = 2_000_000
"""Size of the largest file with a design, as of the largest body with one [bytes]."""
SWITCH_S = 0.0005
"""After so long a thread that computes in Python lets another go on [s]. A stop wakes several, one after the other."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; return its exit code."""
    parser = argparse.ArgumentParser(prog="stepramp", description="Designs stepper-motor ramps, in the browser.")
    parser.add_argument("--version", action="version", version=f"StepRamp {__version__}")
    host_help = (
        f"address to listen on (default: {LOOPBACK}, this machine only); on another one everybody has to show a token, "
        "which the printed links have"
    )
    parser.add_argument("--host", default=LOOPBACK, help=host_help)
    token_help = "ask for a token on this machine's own address, too: for a tunnel or a proxy that others come through"
    parser.add_argument("--require-token", action="store_true", help=token_help)
    parser.add_argument("--certfile", help="certificate, to be spoken to over TLS; with --keyfile")
    parser.add_argument("--keyfile", help="the certificate's key, without a password")
    port_help = f"port to listen on, the next free one if taken (default: {FIRST_PORT})"
    parser.add_argument("--port", default=str(FIRST_PORT), help=port_help)
    parser.add_argument("--no-browser", action="store_true", help="do not open the page")
    parser.add_argument(
        "--data-folder", help="where backups of controllers are kept (default: the user's own folder for that)"
    )
    levels = ", ".join(LOG_LEVELS)
    level_help = f"how much is told of what goes on, up to each byte: {levels} (default: warning)"
    parser.add_argument("--log-level", default="warning", help=level_help)
    remote_help = (
        "connect also to controllers of this other machine, over rfc2217://, socket:// or moonraker://; may be repeated"
    )
    parser.add_argument("--allow-remote-port", metavar="HOST:PORT", action="append", default=[], help=remote_help)
    commands = parser.add_subparsers(dest="command", title="instead of the server")
    exporting = commands.add_parser("export", help="write a design in a format, as C code or as a page of plots")
    exporting.add_argument("format", help="c_table, c_newton, grbl, csv, html …; a wrong one lists them all")
    exporting.add_argument("design", help="file with a design document, - for standard input")
    exporting.add_argument("file", help="file to write, - for standard output")
    letter_help = "axis of a machine that ramps by itself, such as grbl: X, Y, Z, A, B or C (default: X)"
    exporting.add_argument("--axis-letter", default="X", help=letter_help)
    options = parser.parse_args(arguments)
    try:
        if options.command == "export":
            export_design(options.format, options.design, options.file, options.axis_letter)
            return 0
        logging.basicConfig(format="%(asctime)s.%(msecs)03d %(levelname)s %(name)s: %(message)s", datefmt="%H:%M:%S")
        logging.getLogger("stepramp").setLevel(log_level(options.log_level))
        remote_ports = RemotePorts.named(options.allow_remote_port, os.environ.get(KEYS_VARIABLE, ""))
        tls = Tls.named(options.certfile, options.keyfile)
        listener = free_port(port_number(options.port), options.host)
    except Rejected as error:
        print(f"stepramp: {error}", file=sys.stderr)
        return 2
    with suppress(KeyboardInterrupt):  # Ended before there was a server.
        data = None if options.data_folder is None else Path(options.data_folder)
        serve(
            listener,
            remote_ports,
            open_page=not options.no_browser,
            data=data,
            tls=tls,
            require_token=options.require_token,
        )
    return 0


def export_design(format_name: str, source: str, target: str, axis_letter: str) -> None:
    """Write a design in a format; `-` stands for standard input and output.

    Raises Rejected when a file can't be read or written, the format or the axis is none, or the design can't be
    exported.
    """
    from stepramp.design import Design  # noqa: PLC0415  # load slowly: not for --help
    from stepramp.exports.export import FORMAT_NAMES, Options, export  # noqa: PLC0415
    from stepramp.exports.machines.sheet import LETTERS  # noqa: PLC0415
    from stepramp.json_text import parsed_json  # noqa: PLC0415

    if format_name not in FORMAT_NAMES:
        raise Rejected([Rejection("format", format_name, ", ".join(FORMAT_NAMES))])
    letter = next((each for each in LETTERS if each == axis_letter), None)
    if letter is None:
        raise Rejected([Rejection("axis_letter", axis_letter, ", ".join(LETTERS))])
    try:
        design = Design.checked(parsed_json(_text_of(source)))
    except (OSError, ValueError) as error:
        if isinstance(error, Rejected):
            raise
        raise Rejected([Rejection("design", source, f"a file with a design document ({_why(error)})")]) from None
    if "-" not in (source, target) and Path(target).exists() and Path(source).samefile(target):
        raise Rejected([Rejection("file", target, "another file than that of the design")])
    made = export(design, format_name, Options(axis_letter=letter))
    try:
        if target == "-":
            sys.stdout.buffer.write(made.content)
        else:
            Path(target).write_bytes(made.content)
    except OSError as error:
        raise Rejected([Rejection("file", target, f"a file that can be written ({_why(error)})")]) from None


def _text_of(source: str) -> str:
    """Return the text of a file that may be a design; ValueError when it is none, or larger than any."""
    with sys.stdin.buffer if source == "-" else Path(source).open("rb") as file:
        content = file.read(MOST_BYTES + 1)
    if len(content) > MOST_BYTES:
        raise ValueError(f"it is larger than {MOST_BYTES:,} bytes")
    return content.decode(json.detect_encoding(content))


def _why(error: OSError | ValueError) -> str:
    """Return why a file can't be read or written, in words without the program's own."""
    if isinstance(error, UnicodeDecodeError):
        return "it is no text in UTF-8 or UTF-16"
    if isinstance(error, json.JSONDecodeError):
        return f"it is no JSON: line {error.lineno:,}, column {error.colno:,}" if error.doc.strip() else "it is empty"
    return (error.strerror if isinstance(error, OSError) else None) or str(error)


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
            allowed = f"a certificate in PEM, whose key --keyfile has, without a password ({_why(error)})"
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
) -> None:
    """Serve the page and the API until interrupted.

    remote_ports: those of other machines that may be connected to. data: the folder of what outlasts the program. tls:
    how it is spoken to; None: over plain HTTP. require_token: also where it listens to this machine only; where it
    listens to others, everybody has to show one.
    """
    # numba and FastAPI load slowly: not for --help
    from stepramp.http_api.access import Access, Role  # noqa: PLC0415
    from stepramp.http_api.app import create_app  # noqa: PLC0415
    from stepramp.http_api.bodies import MOST_BYTES as MOST_BODY_BYTES  # noqa: PLC0415
    from stepramp.http_api.connections import MOST_NEW, allow_descriptors  # noqa: PLC0415
    from stepramp.http_api.request_numbers import numbering  # noqa: PLC0415
    from stepramp.http_api.server import GRACE_S, Server  # noqa: PLC0415

    host, port = listener.getsockname()[:2]
    is_shared = require_token or not ipaddress.ip_address(host).is_loopback
    access = Access.with_new_tokens(is_encrypted=tls is not None) if is_shared else None
    name = f"[{host}]" if ":" in host else host
    address = f"{'http' if tls is None else 'https'}://{name}:{port}/"
    # Within one machine, compressing what goes over a WebSocket takes longer than sending it.
    app = create_app(remote_ports=remote_ports, data=data, access=access)
    config = uvicorn.Config(
        app,
        log_level="warning",
        http=numbering(app.state.devices.order.next, app.state.connections),
        ws="websockets-sansio",
        ws_per_message_deflate=False,
        ws_max_size=MOST_BODY_BYTES,
        backlog=MOST_NEW,
        timeout_graceful_shutdown=GRACE_S,
        ssl_certfile=None if tls is None else tls.certfile,
        ssl_keyfile=None if tls is None else tls.keyfile,
    )
    allow_descriptors()
    server = Server(config, app.state.devices.end_motion)
    sys.setswitchinterval(SWITCH_S)
    # What is loaded by now stays: to look through it for garbage again and again would halt all threads for 0.1 s.
    gc.freeze()
    print(f"StepRamp is at {address} (Ctrl+C ends it)", flush=True)
    if access is not None:
        print(f"  to operate: {address}?token={access.token_of(Role.OPERATE)}")
        print(f"  to look on: {address}?token={access.token_of(Role.VIEW)}", flush=True)
        if tls is None:
            print("  Tokens go over the network as they are: --certfile and --keyfile encrypt them.", flush=True)
        address += f"?token={access.token_of(Role.OPERATE)}"
    if open_page:
        # The socket listens already: a browser that is quicker than the server waits for it.
        threading.Thread(target=webbrowser.open, args=(address,), daemon=True).start()
    app.state.connections.listen(listener)
    server.serve_until_ended(listener)


if __name__ == "__main__":
    sys.exit(main())
