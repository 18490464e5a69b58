"""The server as a user starts it, in a process of its own, and requests to it."""

import http.client
import json
import subprocess
import sys
from typing import Any, Self
from urllib.parse import urlsplit

PATIENCE_S = 60.0


class ServerProcess:
    """`stepramp` from a port on, or the next free one. Its requests go over a connection each."""

    def __init__(self, first_port: int, *options: str) -> None:
        command = [sys.executable, "-m", "stepramp", "--no-browser", "--port", str(first_port), *options]
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        assert self.process.stdout is not None
        self.address = urlsplit(self.process.stdout.readline().split()[3])

    def connection(self) -> http.client.HTTPConnection:
        """Return a connection of one's own, for several requests."""
        assert self.address.hostname is not None
        return http.client.HTTPConnection(self.address.hostname, self.address.port, timeout=PATIENCE_S)

    def ask(self, method: str, route: str, body: object = None) -> Any:
        """Return the content of an answer that must be a good one."""
        status, content = self.answer(method, route, body)
        assert status == 200, content
        return content

    def answer(self, method: str, route: str, body: object = None) -> tuple[int, Any]:
        """Return status and content of an answer."""
        connection = self.connection()
        try:
            return answer_over(connection, method, route, body)
        finally:
            connection.close()

    def ended(self) -> str:
        """Wait for the end; return what it complained of."""
        _, errors = self.process.communicate(timeout=PATIENCE_S)
        return errors

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        if self.process.returncode is None:
            self.process.kill()
            self.process.communicate()


def answer_over(
    connection: http.client.HTTPConnection, method: str, route: str, body: object = None
) -> tuple[int, Any]:
    """Return status and content of an answer over a connection that stays open."""
    headers = {} if body is None else {"content-type": "application/json"}
    connection.request(method, f"/api/v1/{route}", None if body is None else json.dumps(body), headers)
    with connection.getresponse() as response:
        return response.status, json.load(response)
