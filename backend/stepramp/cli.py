"""The command line: `stepramp` starts the server and opens the page; `stepramp export` writes a design as a file."""

import argparse
import gc
import json
import logging
import os
import socket
import sys
import threading
import webbrowser
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

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
    port_help = f"port on {LOOPBACK}, the next free one if taken (default: {FIRST_PORT})"
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
        listener = free_port(port_number(options.port))
    except Rejected as error:
        print(f"stepramp: {error}", file=sys.stderr)
        return 2
    with suppress(KeyboardInterrupt):  # Ended before there was a server.
        data = None if options.data_folder is None else Path(options.data_folder)
        serve(listener, remote_ports, open_page=not options.no_browser, data=data)
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


def free_port(first: int) -> socket.socket:
    """Return a listening socket on the first free port from `first` on.

    Raises Rejected when a hundred ports in a row are taken.
    """
    last = min(first + PORTS_TRIED - 1, 65535)
    for port in range(first, last + 1):
        # With the protocol named, asyncio sends an answer at once; else its second part waits until the first has
        # been acknowledged, 40 ms later.
        listener = socket.socket(socket.AF_INET, socket.SOCK_STREAM, socket.IPPROTO_TCP)
        if os.name == "posix":
            # A port of a server that has just ended is free again at once; one in use stays refused. Windows does both
            # without it, and with it would share a port in use.
            listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            listener.bind((LOOPBACK, port))
            listener.listen(128)
        except OSError:
            listener.close()
        else:
            return listener
    raise Rejected([Rejection("--port", first, f"a port with a free one from {first:,} to {last:,}")])


def serve(listener: socket.socket, remote_ports: RemotePorts, *, open_page: bool, data: Path | None = None) -> None:
    """Serve the page and the API until interrupted.

    remote_ports: those of other machines that may be connected to. data: the folder of what outlasts the program.
    """
    # numba and FastAPI load slowly: not for --help
    from stepramp.http_api.app import create_app  # noqa: PLC0415
    from stepramp.http_api.bodies import MOST_BYTES as MOST_BODY_BYTES  # noqa: PLC0415
    from stepramp.http_api.connections import MOST_NEW, allow_descriptors  # noqa: PLC0415
    from stepramp.http_api.request_numbers import numbering  # noqa: PLC0415
    from stepramp.http_api.server import GRACE_S, Server  # noqa: PLC0415

    address = f"http://{LOOPBACK}:{listener.getsockname()[1]}/"
    # Within one machine, compressing what goes over a WebSocket takes longer than sending it.
    app = create_app(remote_ports=remote_ports, data=data)
    config = uvicorn.Config(
        app,
        log_level="warning",
        http=numbering(app.state.devices.order.next, app.state.connections),
        ws="websockets-sansio",
        ws_per_message_deflate=False,
        ws_max_size=MOST_BODY_BYTES,
        backlog=MOST_NEW,
        timeout_graceful_shutdown=GRACE_S,
    )
    allow_descriptors()
    server = Server(config, app.state.devices.end_motion)
    sys.setswitchinterval(SWITCH_S)
    # What is loaded by now stays: to look through it for garbage again and again would halt all threads for 0.1 s.
    gc.freeze()
    print(f"StepRamp is at {address} (Ctrl+C ends it)", flush=True)
    if open_page:
        # The socket listens already: a browser that is quicker than the server waits for it.
        threading.Thread(target=webbrowser.open, args=(address,), daemon=True).start()
    app.state.connections.listen(listener)
    server.serve_until_ended(listener)


if __name__ == "__main__":
    sys.exit(main())
