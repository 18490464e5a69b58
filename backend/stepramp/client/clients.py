"""The clients: the same methods, that wait or are awaited."""

import asyncio
import json
import ssl
import time
from collections.abc import Sequence
from typing import Any, Self

import httpx2

from stepramp.client import design_calls, device_calls, library_calls
from stepramp.client.calls import A, Asked, Awaiting, Blocking, Call, M, Pause, Script, Scripted
from stepramp.client.refusals import error_of
from stepramp.client.servers import URL_VARIABLE, Server, named, running
from stepramp.client.urgent import ANSWER_WITHIN_S, PAUSE_S, is_of_a_proxy, stop_path, tls_of
from stepramp.errors import NoServer
from stepramp.http_api.devices_models import DeviceAnswer
from stepramp.http_api.stopping_models import AllStoppedAnswer

CONNECT_WITHIN_S = 5.0
STOP_WITHIN_S = 60.0
"""So long a stop that isn't answered is asked for again [s]."""


class Requests:
    """What both clients can ask. Each method is described where it is written."""

    health = Asked(design_calls.health)
    examples = Asked(design_calls.examples)
    motor_presets = Asked(design_calls.motor_presets)
    profile = Asked(design_calls.profile)
    errors = Asked(design_calls.errors)
    fit = Asked(design_calls.fit)
    play_table = Asked(design_calls.play)
    schedule = Asked(design_calls.schedule)
    torque = Asked(design_calls.torque)
    simulate = Asked(design_calls.simulate)
    fastest = Asked(design_calls.fastest)
    stall_map = Scripted(design_calls.stall_map)
    export = Asked(design_calls.export)
    capture = Asked(design_calls.capture)

    ports = Asked(device_calls.ports)
    devices = Asked(device_calls.devices)
    device = Asked(device_calls.device)
    connect = Asked(device_calls.connect)
    disconnect = Asked(device_calls.disconnect)
    preview_push = Asked(device_calls.preview_push)
    push = Asked(device_calls.push)
    keep = Asked(device_calls.keep)
    roll_back = Asked(device_calls.roll_back)
    restore = Asked(device_calls.restore)
    backups = Asked(device_calls.backups)
    all_backups = Asked(device_calls.all_backups)
    restore_backup = Asked(device_calls.restore_backup)
    restore_backup_of = Asked(device_calls.restore_backup_of)
    move = Asked(device_calls.move)
    run = Asked(device_calls.run)
    run_for = Scripted(device_calls.run_for)
    line = Asked(device_calls.line)
    there_and_back = Asked(device_calls.there_and_back)
    zero = Asked(device_calls.zero)
    home = Asked(device_calls.home)
    set_soft_limits = Asked(device_calls.set_soft_limits)
    set_position = Asked(device_calls.set_position)
    acknowledge = Asked(device_calls.acknowledge)
    until_rest = Scripted(device_calls.until_rest)
    trace_moves = Asked(device_calls.trace_moves)
    trace = Asked(device_calls.trace)

    search_designs = Asked(library_calls.search_designs)
    add_design = Asked(library_calls.add_design)
    kept_design = Asked(library_calls.kept_design)
    describe_design = Asked(library_calls.describe_design)
    save_revision = Asked(library_calls.save_revision)
    revision = Asked(library_calls.revision)
    differences = Asked(library_calls.differences)
    duplicate_design = Asked(library_calls.duplicate_design)
    keep_record = Asked(library_calls.keep_record)
    records = Asked(library_calls.records)
    record = Asked(library_calls.record)
    seen_devices = Asked(library_calls.seen_devices)
    search_pushes = Asked(library_calls.search_pushes)
    pushed = Asked(library_calls.pushed)
    library_file = Asked(library_calls.library_file)
    add_library_file = Asked(library_calls.add_library_file)


class Client(Requests, Blocking):
    """A client whose methods wait for their answers; for any thread. Close it, or use it as a context."""

    def __init__(
        self,
        url: str | None = None,
        token: str | None = None,
        *,
        server: Server | None = None,
        tls: ssl.SSLContext | None = None,
        transport: httpx2.BaseTransport | None = None,
    ) -> None:
        """Ask the server at a URL, or else at STEPRAMP_URL, or else the one of this machine that began last.

        token: of a server that asks for one; else STEPRAMP_TOKEN's. server: all of that, instead. tls: which
        certificates count; None: those that the system trusts. transport: how requests get there otherwise.
        Raises NoServer where none is named and none runs, Rejected for what is no URL.
        """
        self.server = server or _server(url, token)
        options = _options(self.server, tls)
        # Nothing of its own connections is kept: a stop never waits behind another request, nor for one.
        alone = httpx2.Limits(max_keepalive_connections=0)
        self._usual = httpx2.Client(transport=transport, **options)
        self._urgent = httpx2.Client(transport=transport, limits=alone, **options)

    def send(self, call: Call[A]) -> A:
        """Send a call; return what it is answered."""
        try:
            response = self._usual.request(**_request(call))
        except httpx2.TransportError as error:
            raise _lost(self.server, error) from error
        return _read(call, response, self.server)

    def play(self, script: Script[A]) -> A:
        """Send the calls of a script, and return what came of them."""
        try:
            step = next(script)
            while True:
                answer: object = None
                try:
                    if isinstance(step, Pause):
                        time.sleep(step.pause_s)
                    else:
                        answer = self.send(step)
                except BaseException as error:
                    # The script may have something to undo; else it raises the same.
                    step = script.throw(error)
                else:
                    step = script.send(answer)
        except StopIteration as end:
            result: A = end.value
            return result

    def stop(self, device_id: str, axes: Sequence[int] | None = None) -> DeviceAnswer:
        """Slow axes of a device down, or all: asked again, each time over a new connection, until it is answered."""
        return self._stop(stop_path(device_id), DeviceAnswer, axes)

    def halt(self, device_id: str, axes: Sequence[int] | None = None) -> DeviceAnswer:
        """Have axes of a device make no further step, or all; as stop."""
        return self._stop(stop_path(device_id, halt=True), DeviceAnswer, axes)

    def stop_all(self) -> AllStoppedAnswer:
        """Stop every device; as stop. `errors` of the answer tells which are stopped only as soon as they answer."""
        return self._stop(stop_path(None), AllStoppedAnswer, None)

    def close(self) -> None:
        """Close its connections."""
        self._usual.close()
        self._urgent.close()

    def _stop(self, path: str, answer: type[M], axes: Sequence[int] | None) -> M:
        call, until_s = _stop_call(path, answer, axes), time.monotonic() + STOP_WITHIN_S
        while True:
            try:
                response = self._urgent.request(**_request(call))
            except httpx2.TransportError as error:
                if time.monotonic() > until_s:
                    raise _lost(self.server, error) from error
            else:
                if time.monotonic() > until_s or not is_of_a_proxy(response.status_code, response.content):
                    return _read(call, response, self.server)
            time.sleep(PAUSE_S)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


class AsyncClient(Requests, Awaiting):
    """A client whose methods are awaited. Close it, or use it as a context."""

    def __init__(
        self,
        url: str | None = None,
        token: str | None = None,
        *,
        server: Server | None = None,
        tls: ssl.SSLContext | None = None,
        transport: httpx2.AsyncBaseTransport | None = None,
    ) -> None:
        """Ask a server; as Client."""
        self.server = server or _server(url, token)
        options = _options(self.server, tls)
        alone = httpx2.Limits(max_keepalive_connections=0)
        self._usual = httpx2.AsyncClient(transport=transport, **options)
        self._urgent = httpx2.AsyncClient(transport=transport, limits=alone, **options)

    async def send(self, call: Call[A]) -> A:
        """Send a call; return what it is answered."""
        try:
            response = await self._usual.request(**_request(call))
        except httpx2.TransportError as error:
            raise _lost(self.server, error) from error
        return _read(call, response, self.server)

    async def play(self, script: Script[A]) -> A:
        """Send the calls of a script, and return what came of them."""
        try:
            step = next(script)
            while True:
                answer: object = None
                try:
                    if isinstance(step, Pause):
                        await asyncio.sleep(step.pause_s)
                    else:
                        answer = await self.send(step)
                except BaseException as error:
                    # The script may have something to undo; else it raises the same.
                    step = script.throw(error)
                else:
                    step = script.send(answer)
        except StopIteration as end:
            result: A = end.value
            return result

    async def stop(self, device_id: str, axes: Sequence[int] | None = None) -> DeviceAnswer:
        """Slow axes of a device down, or all: asked again, each time over a new connection, until it is answered."""
        return await self._stop(stop_path(device_id), DeviceAnswer, axes)

    async def halt(self, device_id: str, axes: Sequence[int] | None = None) -> DeviceAnswer:
        """Have axes of a device make no further step, or all; as stop."""
        return await self._stop(stop_path(device_id, halt=True), DeviceAnswer, axes)

    async def stop_all(self) -> AllStoppedAnswer:
        """Stop every device; as stop. `errors` of the answer tells which are stopped only as soon as they answer."""
        return await self._stop(stop_path(None), AllStoppedAnswer, None)

    async def close(self) -> None:
        """Close its connections."""
        await self._usual.aclose()
        await self._urgent.aclose()

    async def _stop(self, path: str, answer: type[M], axes: Sequence[int] | None) -> M:
        call, until_s = _stop_call(path, answer, axes), time.monotonic() + STOP_WITHIN_S
        while True:
            try:
                response = await self._urgent.request(**_request(call))
            except httpx2.TransportError as error:
                if time.monotonic() > until_s:
                    raise _lost(self.server, error) from error
            else:
                if time.monotonic() > until_s or not is_of_a_proxy(response.status_code, response.content):
                    return _read(call, response, self.server)
            await asyncio.sleep(PAUSE_S)

    async def __aenter__(self) -> Self:
        return self

    async def __aexit__(self, *_: object) -> None:
        await self.close()


def _server(url: str | None, token: str | None) -> Server:
    if (told := named(url, token)) is not None:
        return told
    if found := running():
        return found[0]
    raise NoServer(f"No server of this machine runs: start one with `stepramp`, or name one by url or {URL_VARIABLE}.")


def _options(server: Server, tls: ssl.SSLContext | None) -> dict[str, Any]:
    # Proxies of the surroundings are for pages elsewhere: a motor is not moved through one.
    is_tls = server.url.startswith("https:")
    return {
        "base_url": f"{server.url}/api/v1/",
        "headers": {} if server.token is None else {"authorization": f"Bearer {server.token}"},
        "verify": (tls or tls_of(server)) if is_tls else False,
        "trust_env": False,
    }


def _request(call: Call[Any]) -> dict[str, Any]:
    headers = dict(call.headers)
    if call.body is not None:
        headers["content-type"] = call.content_type
    return {
        "method": call.method,
        "url": call.path,
        "content": call.body,
        "headers": headers,
        "params": dict(call.parameters) or None,
        "timeout": httpx2.Timeout(call.patience_s, connect=min(call.patience_s, CONNECT_WITHIN_S)),
    }


def _stop_call(path: str, answer: type[M], axes: Sequence[int] | None) -> Call[M]:
    body = None if axes is None else json.dumps({"axes": list(axes)}).encode()
    return Call("POST", path, answer.model_validate_json, body, patience_s=ANSWER_WITHIN_S)


def _read(call: Call[A], response: httpx2.Response, server: Server) -> A:
    if not response.is_success:
        raise error_of(response.status_code, response.content, server.url)
    try:
        return call.read(response.content)
    except ValueError as error:
        raise NoServer(f"What answers at {server.url} is no StepRamp, or one of another version.") from error


def _lost(server: Server, error: httpx2.TransportError) -> NoServer:
    if isinstance(error, httpx2.ConnectError | httpx2.ConnectTimeout):
        return NoServer(f"No server answers at {server.url}.")
    return NoServer(f"The server at {server.url} has not answered, or not to the end.")
