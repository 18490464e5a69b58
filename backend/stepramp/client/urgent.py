"""A stop with nothing in its way: a connection of its own, a short time-out, asked again until it is answered.

Only what Python itself has is loaded here: it goes out before anything else would have been loaded.
"""

import http.client
import json
import ssl
from collections.abc import Sequence
from time import monotonic, sleep
from urllib.parse import quote, urlsplit

from stepramp.client.servers import Server
from stepramp.errors import NoServer

ANSWER_WITHIN_S = 2.0
"""So long an answer is waited for; then it is asked again, over another connection [s]."""
PAUSE_S = 0.1


def stop_path(device: str | None, *, halt: bool = False) -> str:
    """Return the path of a stop below /api/v1: of one device, or of all."""
    return "devices/stop" if device is None else f"devices/{quote(device, safe='')}/{'halt' if halt else 'stop'}"


def ask_to_stop(
    server: Server, device: str | None = None, axes: Sequence[int] | None = None, *, halt: bool = False
) -> tuple[int, bytes]:
    """Ask a server once; return the status and the content of its answer. Raises OSError or HTTPException without."""
    connection = _connection(server)
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
) -> tuple[int, bytes]:
    """Ask a server until it answers; return status and content. within_s: how long; None: for ever [s].

    Raises NoServer once that time is over, and at once where nothing listens.
    """
    begin_s = monotonic()
    while True:
        try:
            return ask_to_stop(server, device, axes, halt=halt)
        except ConnectionRefusedError:
            raise NoServer(f"No server answers at {server.url}.") from None
        except (OSError, http.client.HTTPException) as error:
            if within_s is not None and monotonic() - begin_s > within_s:
                raise NoServer(f"The server at {server.url} has not answered: {error}.") from None
        sleep(PAUSE_S)


def _connection(server: Server) -> http.client.HTTPConnection:
    host, port = server.place
    if not server.url.startswith("https:"):
        return http.client.HTTPConnection(host, port, timeout=ANSWER_WITHIN_S)
    return http.client.HTTPSConnection(host, port, timeout=ANSWER_WITHIN_S, context=tls_of(server))


def tls_of(server: Server) -> ssl.SSLContext:
    """Return how a server is spoken to over TLS.

    One that left a note is known by its very certificate, whatever name that is for.
    """
    context = ssl.create_default_context(cafile=server.certificate)
    if server.certificate is not None:
        context.check_hostname = False
        context.verify_flags |= ssl.VERIFY_X509_PARTIAL_CHAIN  # Whoever has signed it isn't in its file.
    return context
