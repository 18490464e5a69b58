"""The command line: `stepramp` starts the server and opens the page."""

import argparse
import socket
import sys
import threading
import webbrowser
from collections.abc import Sequence

import uvicorn

from stepramp.errors import Rejected, Rejection
from stepramp.version import __version__

LOOPBACK = "127.0.0.1"
FIRST_PORT = 8000
PORTS_TRIED = 100


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; return its exit code."""
    parser = argparse.ArgumentParser(prog="stepramp", description="Designs stepper-motor ramps, in the browser.")
    parser.add_argument("--version", action="version", version=f"StepRamp {__version__}")
    port_help = f"port on {LOOPBACK}, the next free one if taken (default: {FIRST_PORT})"
    parser.add_argument("--port", default=str(FIRST_PORT), help=port_help)
    parser.add_argument("--no-browser", action="store_true", help="do not open the page")
    options = parser.parse_args(arguments)
    try:
        listener = free_port(port_number(options.port))
    except Rejected as error:
        print(f"stepramp: {error}", file=sys.stderr)
        return 2
    serve(listener, open_page=not options.no_browser)
    return 0


def port_number(text: str) -> int:
    """Return a port number.

    Raises Rejected when the text isn't one.
    """
    if text.isascii() and text.isdigit() and 1 <= int(text) <= 65535:
        return int(text)
    raise Rejected([Rejection("--port", text, "a whole number from 1 to 65,535")])


def free_port(first: int) -> socket.socket:
    """Return a listening socket on the first free port from `first` on.

    Raises Rejected when a hundred ports in a row are taken.
    """
    last = min(first + PORTS_TRIED - 1, 65535)
    for port in range(first, last + 1):
        listener = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
        # A port of a server that has just ended is free again at once; one that is in use stays refused.
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            listener.bind((LOOPBACK, port))
            listener.listen(128)
        except OSError:
            listener.close()
        else:
            return listener
    raise Rejected([Rejection("--port", first, f"a port with a free one from {first:,} to {last:,}")])


def serve(listener: socket.socket, *, open_page: bool) -> None:
    """Serve the page and the API until interrupted."""
    from stepramp.http_api.app import create_app  # noqa: PLC0415  # numba and FastAPI load slowly: not for --help

    address = f"http://{LOOPBACK}:{listener.getsockname()[1]}/"
    server = uvicorn.Server(uvicorn.Config(create_app(), log_level="warning", ws="websockets-sansio"))
    print(f"StepRamp is at {address} (Ctrl+C ends it)", flush=True)
    if open_page:
        # The socket listens already: a browser that is quicker than the server waits for it.
        threading.Thread(target=webbrowser.open, args=(address,), daemon=True).start()
    server.run(sockets=[listener])


if __name__ == "__main__":
    sys.exit(main())
