"""Whether the servers of this machine are well, as what keeps a container running asks: wherever they listen."""

from http.client import HTTPConnection, HTTPException, HTTPSConnection

from stepramp.client.servers import Server, running
from stepramp.client.urgent import tls_of

ANSWER_WITHIN_S = 4.0


def are_well() -> bool:
    """Tell whether a server runs, and each that does answers. No token is needed, and none is sent."""
    servers = running()
    return bool(servers) and all(map(_is_well, servers))


def _is_well(server: Server) -> bool:
    host, port = server.place
    if server.url.startswith("https:"):
        connection: HTTPConnection = HTTPSConnection(host, port, timeout=ANSWER_WITHIN_S, context=tls_of(server))
    else:
        connection = HTTPConnection(host, port, timeout=ANSWER_WITHIN_S)
    try:
        connection.request("GET", "/api/v1/health")
        return connection.getresponse().status == 200
    except (OSError, HTTPException):
        return False
    finally:
        connection.close()
