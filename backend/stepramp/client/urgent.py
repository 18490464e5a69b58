"""A stop with nothing in its way: a connection of its own, a short time-out, asked again until it is answered.

Only what Python itself has is loaded here: it goes out before anything else would have been loaded.
"""

import http.client
import json
import socket
import ssl
from collections.abc import Callable, Sequence
from time import monotonic, sleep
from urllib.parse import quote, urlsplit

from stepramp.client.servers import Server
from stepramp.errors import NoServer

ANSWER_WITHIN_S = 4.0
"""So long an answer is waited for; then it is asked again, over another connection [s].

A Marlin that heats, or a Klipper that prints, is asked by its server for up to 2.5 s before that answers."""
LONGEST_ANSWER_S = 32.0
"""Each time it is waited for twice as long, up to this: many stops may wait for one port, each in its turn."""
PAUSE_S = 0.1
PROXYS_OWN = (502, 503, 504)
"""Such answers a proxy makes itself, while the server behind it begins anew; StepRamp's have errors."""


def stop_path(device: str | None, *, halt: bool = False) -> str:
    """Return the path of a stop below /api/v1: of one device, or of all."""
    return "devices/stop" if device is None else f"devices/{quote(device, safe='')}/{'halt' if halt else 'stop'}"


def ask_to_stop(
    server: Server,
    device: str | None = None,
    axes: Sequence[int] | None = None,
    *,
    halt: bool = False,
    within_s: float = ANSWER_WITHIN_S,
) -> tuple[int, bytes]:
    """Ask a server once; return the status and the content of its answer. Raises OSError or HTTPException without."""
    connection = _connection(server, within_s)
    body = None if axes is None else json.dumps({"axes": list(axes)})
    headers = {} if server.token is None else {"authorization": f"Bearer {server.token}"}
    if body is not None:
        headers["content-type"] = "application/json"
    try:
        connection.request("POST", f"{urlsplit(server.url).path}/api/v1/{stop_path(device, halt=halt)}", body, headers)
        response = connection.getresponse()
        return response.status, response.read()
    finally:
        connection.close()


def stop_until_answered(
    server: Server,
    device: str | None = None,
    axes: Sequence[int] | None = None,
    *,
    halt: bool = False,
    within_s: float | None = None,
    tell: Callable[[str], None] = lambda _: None,
) -> tuple[int, bytes]:
    """Ask a server until it answers; return status and content. within_s: how long; None: for ever [s].

    tell: hears each time why it can't be asked at all, as for a name that nobody knows, or a certificate that isn't
    trusted; silence isn't told.

    Raises NoServer once that time is over, and at once where nothing listens.
    """
    begin_s, answer_within_s = monotonic(), ANSWER_WITHIN_S
    while True:
        try:
            status, content = ask_to_stop(server, device, axes, halt=halt, within_s=answer_within_s)
            if not is_of_a_proxy(status, content):
                return status, content
            if within_s is not None and monotonic() - begin_s > within_s:
                raise NoServer(f"The server at {server.url} has not answered: a proxy did, with {status}.")
            tell(f"a proxy answers in its place, with {status}")
        except ConnectionRefusedError:
            raise NoServer(f"No server answers at {server.url}.") from None
        except (OSError, http.client.HTTPException) as error:
            if within_s is not None and monotonic() - begin_s > within_s:
                raise NoServer(f"The server at {server.url} has not answered: {error}.") from None
            if isinstance(error, (socket.gaierror, ssl.SSLError)):
                tell(error.strerror or str(error))
            if isinstance(error, TimeoutError):
                answer_within_s = min(2 * answer_within_s, LONGEST_ANSWER_S)
        sleep(PAUSE_S)


def is_of_a_proxy(status: int, content: bytes) -> bool:
    """Tell whether an answer is of who passes requests on to a server, and can't just now."""
    if status not in PROXYS_OWN:
        return False
    try:
        return "errors" not in json.loads(content)
    except (ValueError, TypeError):
        return True


def _connection(server: Server, within_s: float) -> http.client.HTTPConnection:
    host, port = server.place
    if not server.url.startswith("https:"):
        return http.client.HTTPConnection(host, port, timeout=within_s)
    return http.client.HTTPSConnection(host, port, timeout=within_s, context=tls_of(server))


def tls_of(server: Server) -> ssl.SSLContext:
    """Return how a server is spoken to over TLS.

    One that left a note is known by its very certificate, whatever name that is for.
    """
    context = ssl.create_default_context(cafile=server.certificate)
    if server.certificate is not None:
        context.check_hostname = False
        context.verify_flags |= ssl.VERIFY_X509_PARTIAL_CHAIN  # Whoever has signed it isn't in its file.
    return context
