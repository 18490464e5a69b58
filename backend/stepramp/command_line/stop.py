"""`stepramp stop`: goes out first, and needs nothing but Python itself where a server runs.

What can't be understood of it stops everything all the same, and is told afterwards.
"""

import json
import os
import sys
import threading
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from time import monotonic
from typing import Any

from stepramp.client.servers import Server, is_here, named, running
from stepramp.client.urgent import stop_until_answered
from stepramp.command_line.exit_codes import FAILED, INTERRUPTED, NOBODY_THERE, OK, WRONG_INPUT
from stepramp.command_line.visible import visible
from stepramp.errors import NoServer, Rejected, StepRampError

WITH_VALUE = ("--device", "--axis", "--server", "--port", "--family")
HALT = "--halt"
USUAL_FAMILY = "stepramp"
STOP_BYTES = b"\x00\xff\xff\x00"
"""A stop of all axes outside of all frames: docs/serial_protocol.md, Stop and halt."""
VIRTUAL = "sim:"
OK_STATUS, UNAUTHORIZED, LOST_STATUS = 200, 401, 502
SILENT_S = 2.5
"""After so long it is told that it is still asked [s]."""


@dataclass
class Asked:
    """What is to be stopped, and where."""

    device: str | None = None
    axes: list[int] | None = None
    halt: bool = False
    server: str | None = None
    port: str | None = None
    family: str = USUAL_FAMILY
    not_understood: list[str] = field(default_factory=list)


def asked_by(words: Sequence[str]) -> Asked:
    """Return what the words after `stop` ask for; of words that aren't understood, all devices and axes."""
    asked, left = Asked(), list(words)
    while left:
        name, equals, value = left.pop(0).partition("=")
        if name == HALT and not equals:
            asked.halt = True
            continue
        if name not in WITH_VALUE or not (equals or left):
            asked.not_understood.append(name)
            continue
        value = value if equals else left.pop(0)
        if not value:
            asked.not_understood.append(f"{name} without a value")
            continue
        if name == "--axis":
            if value in ("0", "1", "2", "3"):
                asked.axes = [*(asked.axes or []), int(value)]
            else:
                asked.not_understood.append(f"--axis {value}")
        else:
            setattr(asked, name[2:], value)
    if asked.axes is not None and asked.device is None:
        asked.not_understood.append("--axis without --device")
    if asked.port is not None and asked.device is not None:
        asked.not_understood.append("--port with --device")
    if asked.not_understood:
        asked.device = asked.axes = None
    return asked


@dataclass(frozen=True)
class _Answered:
    """What came of asking a server."""

    code: int
    ports: tuple[str, ...] = ()
    """Of the devices that it has connected, or is connecting: nobody else can open them."""


def carry_out(asked: Asked) -> int:
    """Stop, tell what came of it, and return the exit code."""
    try:
        servers = _servers(asked)
        if not servers and asked.port is None:
            raise NoServer("No server of this machine runs. What is at a port without one: stepramp stop --port PORT.")
        code = _stop_all(servers, asked)
    except KeyboardInterrupt:
        _tell("Given up before the stop was answered: whether it was carried out is not known.")
        return INTERRUPTED
    except StepRampError as error:
        _tell(str(error))
        return WRONG_INPUT if isinstance(error, Rejected) else NOBODY_THERE
    if asked.not_understood:
        words, allowed = ", ".join(asked.not_understood), ", ".join((*WITH_VALUE, HALT))
        _tell(f"{words} was not understood; allowed: {allowed}. All were stopped.")
        return code or WRONG_INPUT
    return code


def _servers(asked: Asked) -> list[Server]:
    """Return who is asked; nobody where no server runs."""
    try:
        told = named(asked.server, field="--server")
    except Rejected as error:
        # All that run are stopped all the same.
        asked.not_understood.append(str(error))
        told = None
    return [told] if told is not None else running()


def _stop_all(servers: Sequence[Server], asked: Asked) -> int:
    """Ask all servers at the same time, and stop what is at a port that none of them has; return the worst of it.

    A server that is silent keeps the port from nothing.
    """
    answered: list[_Answered] = []
    threads = [
        threading.Thread(target=lambda each=server: answered.append(_ask(each, asked)), daemon=True)
        for server in servers
    ]
    for thread in threads:
        thread.start()
    _wait_for(threads, SILENT_S)
    at_port = None
    if any(thread.is_alive() for thread in threads):
        _tell("No answer yet: the stop is asked for again and again (Ctrl+C gives up).")
        at_port = None if _is_had(asked.port, answered) else _stop_at_port(asked)
        _wait_for(threads)
    codes = [each.code for each in answered]
    if not _is_had(asked.port, answered):
        codes.append(_stop_at_port(asked) if at_port is None else at_port)
    return max(codes)


def _wait_for(threads: Sequence[threading.Thread], within_s: float | None = None) -> None:
    begin_s = monotonic()
    for thread in threads:
        # In slices: Ctrl+C is heard between them.
        while thread.is_alive() and (within_s is None or monotonic() - begin_s < within_s):
            thread.join(0.05)


def _is_had(port: str | None, answered: Iterable[_Answered]) -> bool:
    """Tell whether a port is a server's, by whichever of its names; so is none."""
    if port is None:
        return True
    from stepramp.link.ports import location_of  # noqa: PLC0415  # most stops name no port

    there = location_of(port)
    return any(location_of(each) == there for server in answered for each in server.ports)


def _ask(server: Server, asked: Asked) -> _Answered:
    try:
        status, answer = _answer_of(server, asked)
        if status == UNAUTHORIZED and is_here(server):
            # A link that is kept is of no use once a server has begun anew, with other tokens: those are in its note.
            # It is asked where it is named: whose note it is, another one at the same port isn't meant.
            for noted in running():
                if status == UNAUTHORIZED and noted.place[1] == server.place[1]:
                    known = replace(server, token=noted.token, certificate=noted.certificate)
                    status, answer = _answer_of(known, asked)
        return _told(server, status, answer)
    except NoServer as error:
        _tell(str(error))
    except (ValueError, KeyError, TypeError, AttributeError):
        _tell(f"NOT stopped by {server.url}: what answers there is no StepRamp.")
    return _Answered(NOBODY_THERE)


def _answer_of(server: Server, asked: Asked) -> tuple[int, dict[str, Any]]:
    is_of_one = asked.device is not None
    status, answer = _ask_until_answered(server, asked.device, asked.axes, halt=asked.halt and is_of_one)
    if not asked.halt or is_of_one or status != OK_STATUS:
        return status, answer
    # Halting is for one device each: all were stopped first, whatever their names.
    refusals = _halt_each(server, [device["id"] for device in answer["devices"]])
    status, answer = _ask_until_answered(server)
    return status, {**answer, "errors": [*(answer.get("errors") or ()), *refusals]}


def _halt_each(server: Server, devices: Sequence[str]) -> list[dict[str, Any]]:
    """Halt devices, each without waiting for another one; return what was refused. Who is lost, its state tells."""
    refusals: list[dict[str, Any]] = []

    def halt(device: str) -> None:
        try:
            status, answer = _ask_until_answered(server, device, halt=True)
            if status not in (OK_STATUS, LOST_STATUS):
                refusals.extend(answer["errors"])
        except (NoServer, ValueError, KeyError, TypeError) as error:
            why = str(error) if isinstance(error, NoServer) else f"{server.url} answered with what is none."
            refusals.append({"message": f"Device {device} was stopped, and not halted: {why}"})

    threads = [threading.Thread(target=halt, args=[device], daemon=True) for device in devices]
    for thread in threads:
        thread.start()
    _wait_for(threads)
    return refusals


def _ask_until_answered(
    server: Server, device: str | None = None, axes: Sequence[int] | None = None, *, halt: bool = False
) -> tuple[int, dict[str, Any]]:
    """Ask a server; why no answer comes is told once, where it is more than its silence."""
    told: set[str] = set()

    def tell(why: str) -> None:
        if why not in told:
            told.add(why)
            _tell(f"{server.url} can't be asked: {why}. It is tried again (Ctrl+C gives up).")

    status, content = stop_until_answered(server, device, axes, halt=halt, tell=tell)
    return status, json.loads(content)


def _told(server: Server, status: int, answer: dict[str, Any]) -> _Answered:
    if status != OK_STATUS:
        for error in answer["errors"]:
            _tell(f"NOT stopped by {server.url}: {error['message']}")
        if status == UNAUTHORIZED:
            _tell("Each start of a server makes new tokens, which it prints. If anything moves, cut the motor's power.")
        return _Answered({UNAUTHORIZED: NOBODY_THERE, LOST_STATUS: NOBODY_THERE}.get(status, FAILED))
    devices = answer.get("devices", [answer])
    code = OK
    # Of all: whose stop was refused, as of a machine that somebody else has set in motion.
    for error in answer.get("errors") or ():
        _tell(error["message"])
        code = FAILED
    for device in devices:
        if device["state"] in ("lost", "connecting"):
            _tell(
                f"Device {device['id']} at {device['port']} is {device['state']}: it is stopped as soon as it answers."
            )
            code = NOBODY_THERE
        else:
            places = places_of((axis["axis"], _position_of(axis)) for axis in device["axes"])
            said = "Asked to stop" if device["state"] == "moving" else "Stopped"
            _say(f"{said}: device {device['id']} at {device['port']}, {device['state']}{places}.")
    if not devices:
        _say(f"Stopped: the server at {server.url}, which has no device.")
    return _Answered(code, tuple(device["port"] for device in devices if device["state"] != "lost"))


def places_of(axes: Iterable[tuple[int, int | None]]) -> str:
    """Return where axes are [steps] as the rest of a sentence; None for one that doesn't tell: no place is made up."""
    axes = list(axes)
    told = ", ".join(f"axis {axis} at {place:,}" for axis, place in axes if place is not None)
    untold = "".join(f", axis {axis} tells no position" for axis, place in axes if place is None)
    return (f", {told} steps" if told else "") + untold


def _position_of(axis: dict[str, Any]) -> int | None:
    # A server of an older version doesn't say whether it is told.
    return axis["position_steps"] if axis.get("position_told", True) else None


def _stop_at_port(asked: Asked) -> int:
    """Stop what is at the port that is named, without a server."""
    assert asked.port is not None
    outcome = "was NOT stopped"
    if asked.port.startswith(VIRTUAL):
        _tell(f"Nothing at {asked.port} was stopped: it is within a server, and none that answered has it.")
        return NOBODY_THERE
    try:
        if asked.family == USUAL_FAMILY and "://" not in asked.port:
            _send_at_once(asked.port)
            outcome = "was sent a stop, which is NOT confirmed"
        # It goes the usual way, too, which waits until it is granted: this takes a second to load.
        from stepramp.command_line.stop_at_port import stop_at  # noqa: PLC0415  # as said

        _say(stop_at(asked.port, asked.family, halt=asked.halt))
    except StepRampError as error:
        _tell(f"Port {asked.port} {outcome}: {error} If it moves, cut the motor's power.")
        return WRONG_INPUT if isinstance(error, Rejected) else NOBODY_THERE
    return OK


def _send_at_once(port: str) -> None:
    from stepramp.link.serial_port import SerialPort  # noqa: PLC0415

    opened = SerialPort(port)
    try:
        opened.write(STOP_BYTES)
        # What is still to be sent as a port is closed may be dropped.
        opened.read(0.05)
    finally:
        opened.close()


def _say(words: str) -> None:
    """Print what was done; where that can't be written, it was done all the same."""
    try:
        print(visible(words), flush=True)
    except OSError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)


def _tell(words: str) -> None:
    if sys.stderr is not None:
        print(f"stepramp: {visible(words)}", file=sys.stderr, flush=True)
