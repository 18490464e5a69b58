"""WebKitGTK over WebDriver, on a display of its own."""

import http.client
import json
import os
import socket
import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

DRIVER, DISPLAY_SERVER = "WebKitWebDriver", "Xvfb"
PROGRAMS = (DRIVER, DISPLAY_SERVER)
WINDOW = {"x": 0, "y": 0, "width": 1440, "height": 900}
START_WITHIN_S = 60
ANSWER_WITHIN_S = 60

LISTEN = """() => {
    window.reported = [];
    // As the page itself does: a box that is measured again within one frame is nothing wrong.
    addEventListener('error', ({message}) => /^ResizeObserver loop/.test(message) || reported.push(message));
    addEventListener('unhandledrejection', ({reason}) => reported.push(String(reason)));
    const tell = console.error;
    console.error = (...parts) => { reported.push(parts.join(' ')); tell(...parts); };
}"""
"""What a page reports while it loads is not heard: WebKit's driver tells of no errors, so the page itself has to."""


class WebKit:
    """The small browser that WebKitGTK comes with, and its one window."""

    def __init__(self, port: int) -> None:
        self._connection = http.client.HTTPConnection("127.0.0.1", port, timeout=ANSWER_WITHIN_S)
        self._session = ""
        self._session = f"/{self._ask('POST', '', capabilities={})['sessionId']}"
        self._ask("POST", "window/rect", **WINDOW)

    def open(self, url: str) -> None:
        self._ask("POST", "url", url=url)
        self.call(LISTEN)

    def call(self, function: str, *arguments: object) -> Any:
        return self._ask("POST", "execute/sync", script=f"return ({function})(...arguments)", args=arguments)

    def perform(self, device: dict[str, Any]) -> None:
        self._ask("POST", "actions", actions=[device])

    def errors(self) -> list[str]:
        return list(self.call("() => window.reported"))

    def close(self) -> None:
        self._ask("DELETE", "")
        self._connection.close()

    def _ask(self, method: str, command: str, **parameters: object) -> Any:
        address = f"/session{self._session}/{command}".rstrip("/")
        self._connection.request(method, address, json.dumps(parameters) if method == "POST" else None)
        with self._connection.getresponse() as response:
            told = json.load(response)["value"]
            assert response.status == 200, f"{command}: {told}"
            return told


@contextmanager
def webkit() -> Iterator[WebKit]:
    """Start WebKit's browser; end it and its display afterwards."""
    with display() as name, driver(name) as port:
        started = WebKit(port)
        try:
            yield started
        finally:
            started.close()


@contextmanager
def driver(display_name: str) -> Iterator[int]:
    """Start the program that drives the browser, and return the port where it listens."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port: int = probe.getsockname()[1]
    # Without a graphics card it draws much faster when it doesn't act as if there were one.
    environment = {**os.environ, "DISPLAY": display_name, "WEBKIT_DISABLE_COMPOSITING_MODE": "1"}
    with subprocess.Popen([DRIVER, f"--port={port}"], env=environment) as process:
        try:
            wait_for(port)
            yield port
        finally:
            process.terminate()


def wait_for(port: int) -> None:
    deadline = time.monotonic() + START_WITHIN_S
    while True:
        try:
            socket.create_connection(("127.0.0.1", port), timeout=1).close()
            return
        except OSError:
            assert time.monotonic() < deadline, f"{DRIVER} did not start"
            time.sleep(0.05)


@contextmanager
def display() -> Iterator[str]:
    """Start a display that nobody sees, and return its name."""
    reading, writing = os.pipe()
    command = [DISPLAY_SERVER, "-displayfd", str(writing), "-screen", "0", "1600x1200x24", "-nolisten", "tcp"]
    with subprocess.Popen(command, pass_fds=[writing], stderr=subprocess.DEVNULL) as process:
        os.close(writing)
        try:
            with open(reading, encoding="ascii") as told:
                yield f":{told.readline().strip()}"
        finally:
            process.terminate()
