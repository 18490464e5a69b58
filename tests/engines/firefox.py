"""Firefox over WebDriver BiDi, which it speaks itself."""

import json
import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from websockets.sync.client import ClientConnection, connect

FIREFOX = "firefox-esr"
PROGRAMS = (FIREFOX,)
VIEWPORT = {"width": 1440, "height": 900}
START_WITHIN_S = 60
ANSWER_WITHIN_S = 60


class Firefox:
    """A running Firefox and the one tab of it that is used."""

    def __init__(self, socket: ClientConnection) -> None:
        self._socket = socket
        self._number = 0
        self._errors: list[str] = []
        self._ask("session.new", capabilities={})
        # In the tab that it starts with the address bar has the focus, and keys press nothing in the page.
        self._tab: str = self._ask("browsingContext.create", type="tab")["context"]
        self._ask("session.subscribe", events=["log.entryAdded"])
        self._ask("browsingContext.setViewport", context=self._tab, viewport=VIEWPORT)

    def open(self, url: str) -> None:
        self._errors.clear()
        self._ask("browsingContext.navigate", context=self._tab, url=url, wait="complete")

    def call(self, function: str, *arguments: object) -> Any:
        answer = self._ask(
            "script.callFunction",
            functionDeclaration=f"async (given) => JSON.stringify(await ({function})(...JSON.parse(given)) ?? null)",
            arguments=[{"type": "string", "value": json.dumps(arguments)}],
            target={"context": self._tab},
            awaitPromise=True,
        )
        assert answer["type"] == "success", answer["exceptionDetails"]["text"]
        return json.loads(answer["result"]["value"])

    def perform(self, device: dict[str, Any]) -> None:
        self._ask("input.performActions", context=self._tab, actions=[device])

    def errors(self) -> list[str]:
        self.call("() => null")  # What was reported before its answer has been received with it.
        return self._errors

    def _ask(self, method: str, **params: object) -> Any:
        self._number += 1
        self._socket.send(json.dumps({"id": self._number, "method": method, "params": params}))
        while True:
            told = json.loads(self._socket.recv(timeout=ANSWER_WITHIN_S))
            if told.get("id") == self._number:
                assert told["type"] == "success", f"{method}: {told}"
                return told["result"]
            if told.get("method") == "log.entryAdded" and told["params"]["level"] == "error":
                self._errors.append(told["params"]["text"])


@contextmanager
def firefox(profile: Path) -> Iterator[Firefox]:
    """Start Firefox with an empty profile; end it afterwards."""
    command = [FIREFOX, "--headless", "--no-remote", "--profile", str(profile), "--remote-debugging-port", "0"]
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as process:
        try:
            with connect(f"{listening(profile)}/session", max_size=None) as socket:
                yield Firefox(socket)
        finally:
            process.terminate()


def listening(profile: Path) -> str:
    """Wait until Firefox listens, and return the address that it has written down."""
    deadline = time.monotonic() + START_WITHIN_S
    while True:
        try:
            told = json.loads((profile / "WebDriverBiDiServer.json").read_text())
            return f"ws://{told['ws_host']}:{told['ws_port']}"
        except (FileNotFoundError, json.JSONDecodeError):
            assert time.monotonic() < deadline, "Firefox did not start"
            time.sleep(0.05)
