"""Moonraker, as its API documentation has it (external_api), before a Printer: each request is checked against that."""

from __future__ import annotations

import email.parser
import email.policy
import hashlib
import json
from typing import Any
from urllib.parse import unquote

from controllers.klipper.printer import GcodeError, Printer

NOTIFIES_EVERY_S = 0.25
PARAMETERS: dict[str, dict[str, type]] = {
    "server.info": {},
    "printer.info": {},
    "printer.objects.query": {"objects": dict},
    "printer.objects.subscribe": {"objects": dict},
    "printer.gcode.script": {"script": str},
    "printer.emergency_stop": {},
    "printer.restart": {},
    "server.files.roots": {},
    "server.files.list": {"root": str},
    "server.files.copy": {"source": str, "dest": str},
}


class ApiError(Exception):
    def __init__(self, code: int, message: str) -> None:
        super().__init__(message)
        self.code = code


class Moonraker:
    """What is asked of it, and what it answers. key: that it wants, if any."""

    def __init__(self, printer: Printer, key: str | None = None) -> None:
        self.printer = printer
        self.key = key
        self.asked: list[tuple[str, dict[str, Any]]] = []
        self.wrong: list[str] = []
        """What is not as documented."""
        self.unanswered: list[str] = []
        """Methods whose next request gets no answer, though it is carried out."""
        self.loses: list[str] = []
        """Methods whose next request never comes in."""
        self.cuts_upload_after: int | None = None
        """Power is cut in the midst of the next upload, after so many bytes: the file has them, and no more."""
        self.fails_upload_after: int | None = None
        """The next upload fails after so many bytes, as on a disk that is full."""
        self.garbles_upload = False
        self.withheld: dict[str, tuple[int, bytes]] = {}
        """By path, what is answered instead of a file that is there: status and body."""
        self.refuses_copies = False
        self.is_cut_off_until_s = 0.0
        """Until then it doesn't reach Klipper, which is going [s]."""
        self.calls_it_ready_until_s = 0.0
        """Until then it doesn't know that [s]."""
        self._subscribed: dict[str, list[str] | None] = {}
        self._told: dict[str, dict[str, Any]] = {}
        self._next_s = 0.0
        self._told_state, self._told_restarts = printer.state, printer.restarts
        self._waiting: list[tuple[int, str]] = []

    @property
    def waiting(self) -> list[str]:
        """The G-code that waits for its turn."""
        return [script for _, script in self._waiting]

    @property
    def methods(self) -> list[str]:
        return [method for method, _ in self.asked]

    def message(self, text: str) -> list[str]:
        """Return what is said to a message over the WebSocket."""
        request = json.loads(text)
        method, params, number = request.get("method"), request.get("params", {}), request.get("id")
        if self.loses and self.loses[0] == method:
            self.loses.pop(0)
            return []
        self._check(request)
        self.asked.append((method, params))
        if method == "printer.gcode.script" and self.printer.is_held_up:
            self._waiting.append((number, params["script"]))
            return []
        answer: dict[str, Any] = {"jsonrpc": "2.0", "id": number}
        try:
            answer["result"] = self._answer(method, params)
        except (ApiError, GcodeError) as error:
            answer["error"] = {"code": getattr(error, "code", 400), "message": str(error)}
        if self.unanswered and self.unanswered[0] == method:
            self.unanswered.pop(0)
            return []
        said = [json.dumps(answer), *self.notifications()]
        if method == "printer.emergency_stop":
            said += [_error(waiting, "Klippy Disconnected") for waiting, _ in self._waiting]
            self._waiting = []
        return said

    def let_go(self) -> list[str]:
        """Let G-code that waited have its turn."""
        self.printer.is_held_up, said = False, []
        for number, script in self._waiting:
            try:
                self.printer.run(script)
                said.append(json.dumps({"jsonrpc": "2.0", "id": number, "result": "ok"}))
            except GcodeError as error:
                said.append(_error(number, str(error)))
        self._waiting = []
        return said

    def notifications(self) -> list[str]:
        """Return what is told unasked by now."""
        said = []
        if self.printer.restarts != self._told_restarts and self.printer.clock() >= self.calls_it_ready_until_s:
            self._told_restarts, self._told_state = self.printer.restarts, "disconnected"
            said.append(_notice("notify_klippy_disconnected"))
        if self.printer.state != self._told_state:
            self._told_state = self.printer.state
            said.append(_notice(f"notify_klippy_{self.printer.state}"))
        if self._subscribed and self.printer.clock() >= self._next_s:
            self._next_s = self.printer.clock() + NOTIFIES_EVERY_S
            now = self._objects(self._subscribed)
            changed = {
                name: {field: value for field, value in fields.items() if self._told.get(name, {}).get(field) != value}
                for name, fields in now.items()
            }
            self._told = now
            if changed := {name: fields for name, fields in changed.items() if fields}:
                said.append(_notice("notify_status_update", [changed, self.printer.clock()]))
        return said

    def http(self, method: str, path: str, headers: dict[str, str], body: bytes) -> tuple[int, bytes]:
        """Return status and body of what is answered over HTTP."""
        if not self.lets_in(headers):
            return 401, _http_error(401, "Unauthorized")
        self.asked.append((f"{method} {path}", {}))
        files, place = self.printer.files, unquote(path).removeprefix("/server/files/config/")
        if method == "GET" and place in self.withheld:
            return self.withheld[place]
        if method == "GET" and path.startswith("/server/files/config/"):
            return (200, files[place].encode()) if place in files else (404, _http_error(404, "File not found"))
        if (method, path) == ("POST", "/server/files/upload"):
            return self._upload(headers["content-type"], body)
        self.wrong.append(f"{method} {path}")
        return 404, _http_error(404, "Not Found")

    def lets_in(self, headers: dict[str, str]) -> bool:
        return self.key is None or headers.get("x-api-key") == self.key

    def _upload(self, kind: str, body: bytes) -> tuple[int, bytes]:
        head = f"Content-Type: {kind}\r\nMIME-Version: 1.0\r\n\r\n".encode()
        form = email.parser.BytesParser(policy=email.policy.HTTP).parsebytes(head + body)
        parts = {part.get_param("name", header="content-disposition"): part for part in form.iter_parts()}
        fields = {name: part.get_payload(decode=True).decode() for name, part in parts.items() if name != "file"}
        data = parts["file"].get_payload(decode=True)
        if set(fields) - {"root", "path", "checksum"} or fields["root"] != "config":
            self.wrong.append(f"upload {fields}")
        if fields["checksum"] != hashlib.sha256(data).hexdigest():
            return 422, _http_error(422, "File checksum mismatch")
        path = "/".join(each for each in (fields.get("path", ""), parts["file"].get_filename()) if each)
        if self.cuts_upload_after is not None:
            data, self.cuts_upload_after = data[: self.cuts_upload_after], None
            self.printer.files[path] = data.decode()
            raise ConnectionError("power cut")
        if self.fails_upload_after is not None:
            data, self.fails_upload_after = data[: self.fails_upload_after], None
            self.printer.files[path] = data.decode()
            return 500, _http_error(500, "No space left on device")
        self.printer.files[path] = data.decode() + ("#" if self.garbles_upload else "")
        self.withheld.pop(path, None)
        item = {"path": path, "root": "config", "modified": 1.0, "size": len(data), "permissions": "rw"}
        answer = {"item": item, "print_started": False, "print_queued": False, "action": "create_file"}
        return 201, json.dumps(answer).encode()

    def _check(self, request: dict[str, Any]) -> None:
        params, wanted = request.get("params", {}), PARAMETERS.get(request.get("method", ""))
        is_right = (
            wanted is not None
            and set(request) <= {"jsonrpc", "method", "params", "id"}
            and request["jsonrpc"] == "2.0"
            and isinstance(request["id"], int)
            and set(params) == set(wanted)
            and all(isinstance(params[name], kind) for name, kind in wanted.items())
        )
        if not is_right:
            self.wrong.append(json.dumps(request))

    def _answer(self, method: str, params: dict[str, Any]) -> Any:
        return self._of_server(method, params) if method.startswith("server.") else self._of_klipper(method, params)

    def _of_server(self, method: str, params: dict[str, Any]) -> Any:
        printer = self.printer
        match method:
            case "server.info":
                state = "ready" if printer.clock() < self.calls_it_ready_until_s else printer.state
                return {
                    "klippy_connected": state != "disconnected",
                    "klippy_state": state,
                    "components": ["file_manager", "klippy_apis"],
                    "moonraker_version": "v0.9.3-1-g4e00a07",
                    "api_version_string": "1.5.0",
                }
            case "server.files.roots":
                return [{"name": "config", "path": "/home/pi/printer_data/config", "permissions": "rw"}]
            case "server.files.list":
                return [{"path": path, "modified": 1.0, "size": 1, "permissions": "rw"} for path in printer.files]
        source, dest = (params[name].removeprefix("config/") for name in ("source", "dest"))
        if self.refuses_copies or source not in printer.files:
            raise ApiError(400, f"File {params['source']} does not exist")
        printer.files[dest] = printer.files[source]
        return {"item": {"root": "config", "path": dest}, "action": "create_file"}

    def _of_klipper(self, method: str, params: dict[str, Any]) -> Any:
        printer = self.printer
        if printer.clock() < self.is_cut_off_until_s:
            raise ApiError(503, "Klippy Disconnected")
        if printer.state == "disconnected":
            raise ApiError(503, "Klippy Host not connected")
        match method:
            case "printer.info":
                return {
                    "state": printer.state,
                    "state_message": printer.message,
                    "config_file": printer.config_file,
                    "software_version": "v0.12.0-85-gd785b396",
                }
            case "printer.objects.query":
                return {"eventtime": printer.clock(), "status": self._objects(params["objects"])}
            case "printer.objects.subscribe":
                self._subscribed, self._told = params["objects"], self._objects(params["objects"])
                self._next_s = printer.clock() + NOTIFIES_EVERY_S
                return {"eventtime": printer.clock(), "status": self._told}
            case "printer.gcode.script":
                printer.run(params["script"])
            case "printer.emergency_stop":
                printer.emergency_stop()
            case "printer.restart":
                self._subscribed = {}
                printer.restart()
        return "ok"

    def _objects(self, wanted: dict[str, list[str] | None]) -> dict[str, dict[str, Any]]:
        if self.printer.state == "error":
            # Objects that come after what is wrong are not there.
            return {"webhooks": {"state": "error", "state_message": self.printer.message}}
        now = self.printer.status()
        return {
            name: {field: value for field, value in now[name].items() if fields is None or field in fields}
            for name, fields in wanted.items()
            if name in now
        }


def _notice(method: str, params: list[Any] | None = None) -> str:
    return json.dumps({"jsonrpc": "2.0", "method": method} | ({} if params is None else {"params": params}))


def _error(number: int, message: str) -> str:
    return json.dumps({"jsonrpc": "2.0", "error": {"code": 400, "message": message}, "id": number})


def _http_error(code: int, message: str) -> bytes:
    return json.dumps({"error": {"code": code, "message": message}}).encode()
