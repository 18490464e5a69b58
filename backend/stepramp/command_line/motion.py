"""Commands that move motors: they say what they have set in motion, and stop it when they are interrupted."""

import csv
import io
import shlex
import signal
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from types import FrameType
from typing import Annotated, Any

import typer

from stepramp.client import device_calls
from stepramp.client.clients import STOP_WITHIN_S
from stepramp.command_line.commands import Find, command
from stepramp.command_line.device_list import axes_of
from stepramp.command_line.exit_codes import FAILED
from stepramp.command_line.files import write
from stepramp.command_line.output import Format, Rows, progress, show, tell, warn
from stepramp.command_line.stop import USUAL_FAMILY, places_of
from stepramp.command_line.where import Where
from stepramp.errors import DeviceLost, NoServer, Overloaded, Refused, Rejected, Rejection, StepRampError, TooOften
from stepramp.http_api.devices_models import AxisAnswer, DeviceAnswer
from stepramp.http_api.motion_models import TraceAnswer

Axis = Annotated[int, typer.Option("--axis", help="which axis, from 0")]
TRACE_WITHIN_S = 5.0
"""So long the rest of a trace is waited for once the motor rests [s]."""


def add(app: typer.Typer) -> None:
    """Add the commands to the program."""
    command(app, "move", example="stepramp move --port sim:// --by 200 --trace trace.csv")(move)
    command(app, "run", example="stepramp run --port sim:// --speed 400 --for 0.5")(run)
    command(app, "home", example="stepramp home --port sim:// --fast=-400 --slow 50")(home)
    command(app, "trace", example="stepramp trace --port sim:// --format csv")(trace)


def move(
    where: Where,
    find: Find,
    by_steps: Annotated[int | None, typer.Option("--by", help="how far, negative for backwards [steps]")] = None,
    to_steps: Annotated[int | None, typer.Option("--to", help="to which position [steps]")] = None,
    axis: Axis = 0,
    trace_file: Annotated[
        str | None,
        typer.Option(
            "--trace", metavar="FILE", help="have its steps traced, and write them as CSV; - for standard output"
        ),
    ] = None,
    no_wait: Annotated[bool, typer.Option("--no-wait", help="don't wait until it rests; needs a server")] = False,
    format: Format = "table",
) -> None:
    """MOVE a motor, and wait until it rests. Ctrl+C stops it."""
    asked = {"axis": axis}
    if by_steps is not None:
        asked["by_steps"] = by_steps
    if to_steps is not None:
        asked["to_steps"] = to_steps
    device_calls.move("", axes=[asked])  # What can't be used is refused before a port is opened.
    client = where.client
    if no_wait and trace_file is not None:
        raise Rejected([Rejection("--no-wait", True, "nothing with --trace")])
    if no_wait and where.is_alone:
        allowed = "nothing without a server: as it ends, this program stops what it has set in motion"
        raise Rejected([Rejection("--no-wait", True, allowed)])
    device = find()
    planned = device_calls.move(device.id, axes=[asked], stops=device.stops)
    far = f"to position {to_steps or 0:,}" if by_steps is None else f"by {by_steps:,} steps"
    with stopping(where, device) as motion:
        if trace_file is not None:
            client.trace_moves(device.id, axis)
        now = client.send(planned)
        # What is refused moves nothing: it is told once it was accepted.
        tell(f"axis {axis} of {device.name} at {device.port} moves {far}; Ctrl+C stops it")
        if no_wait:
            show(format, now, axes_of(now))
            return
        motion.is_granted = True
        with progress("Move") as told:
            rested = client.until_rest(device.id, tell=_part(axis, device, told))
        motion.is_granted = False
        traced = None if trace_file is None else _whole_trace(where, device.id)
    not_written = None
    if traced is not None and trace_file is not None:
        _warn_of(traced)
        try:
            write(trace_file, _as_csv(traced), "--trace")
        except Rejected as error:
            not_written = f"The move was made, its trace wasn't written: {error}"
    if trace_file != "-":
        show(format, rested, axes_of(rested))
    _refuse_other_end(rested, now, axis)
    if not_written is not None:
        raise Refused(not_written)


def run(
    where: Where,
    find: Find,
    speed_steps_per_s: Annotated[float, typer.Option("--speed", help="negative for backwards [steps/s]")],
    for_s: Annotated[float, typer.Option("--for", help="how long [s]")],
    axis: Axis = 0,
    format: Format = "table",
) -> None:
    """RUN a motor at a speed for so long, then let it slow down. Ctrl+C stops it.

    Once this program is gone, however it ended, the motor slows down within 2 s.
    """
    if not 0.05 <= for_s <= 86_400:
        raise Rejected([Rejection("--for", for_s, "a number from 0.05 to 86,400 s")])
    device_calls.refuse_rest(speed_steps_per_s)
    device_calls.run("", axes=[{"axis": axis, "speed_steps_per_s": speed_steps_per_s}])
    device, begin_s, is_told = find(), time.monotonic(), False
    with stopping(where, device) as motion, progress("Run") as told:

        def tell_part(_: DeviceAnswer) -> None:
            nonlocal is_told
            if not is_told:
                tell(
                    f"axis {axis} of {device.name} at {device.port} runs at {speed_steps_per_s:,.6g} steps/s "
                    f"for {for_s:,.6g} s; Ctrl+C stops it"
                )
            is_told = motion.is_granted = True
            told(min(1.0, (time.monotonic() - begin_s) / for_s))

        rested = where.client.run_for(device.id, axis, speed_steps_per_s, for_s, stops=device.stops, tell=tell_part)
    show(format, rested, axes_of(rested))


def home(
    where: Where,
    find: Find,
    fast_steps_per_s: Annotated[
        float, typer.Option("--fast", help="towards the switch, negative for the one at the low end [steps/s]")
    ],
    slow_steps_per_s: Annotated[float, typer.Option("--slow", help="away from it, and back [steps/s]")],
    axis: Axis = 0,
    position_steps: Annotated[int, typer.Option("--position", help="what the place is called then [steps]")] = 0,
    back_off_steps: Annotated[int | None, typer.Option("--back-off", help="how far beyond the switch [steps]")] = None,
    for_s: Annotated[float | None, typer.Option("--within", help="how long it may take [s]")] = None,
    format: Format = "table",
) -> None:
    """MOVE an axis until it has found its limit switch. Ctrl+C stops it."""
    asked = {"axis": axis, "fast_steps_per_s": fast_steps_per_s, "position_steps": position_steps}
    device_calls.home("", [asked], slow_steps_per_s, back_off_steps=back_off_steps, for_s=for_s)
    device = find()
    with stopping(where, device) as motion:
        where.client.home(
            device.id, [asked], slow_steps_per_s, back_off_steps=back_off_steps, for_s=for_s, stops=device.stops
        )
        tell(f"axis {axis} of {device.name} at {device.port} looks for its limit switch; Ctrl+C stops it")
        motion.is_granted = True
        rested = where.client.until_rest(device.id)
    show(format, rested, axes_of(rested))
    if not next(each for each in rested.axes if each.axis == axis).position_known:
        tell("the switch was not found: where the axis is, is not known")
        raise typer.Exit(FAILED)


def trace(where: Where, find: Find, format: Format = "table") -> None:
    """Show when the steps of the last traced move were made."""
    traced = where.client.trace(find().id)
    _warn_of(traced)
    rows = zip(traced.step, traced.planned_ticks, traced.measured_ticks, traced.deviation_us, strict=True)
    listed = Rows(("step", "planned_ticks", "measured_ticks", "deviation_us"), rows)
    worst = max(traced.deviation_us, key=abs, default=None)
    figures = Rows(
        ("axis", "steps traced", "timer [Hz]", "largest deviation [µs]", "complete", "changed on its way"),
        [(traced.traced_axis, len(traced.step), traced.timer_hz, worst, traced.complete, traced.changed)],
    )
    show(format, traced, figures, listed=listed)


@dataclass
class Motion:
    """What a command sets in motion."""

    is_granted: bool = False
    """Whether it was, and has not come to its end."""


@contextmanager
def stopping(where: Where, device: DeviceAnswer) -> Iterator[Motion]:
    """Stop a device when the context is interrupted, also by a signal, or it isn't known what came of it.

    What was refused has set nothing in motion: somebody else's motion goes on. So it does where a motion that was
    granted is refused to go on: it is over. After any other error it may go on, with nobody who waits for it.
    """
    motion = Motion()
    with _signals(_interrupt):
        try:
            yield motion
        except BaseException as error:
            is_lost = isinstance(error, NoServer | DeviceLost)
            is_left = motion.is_granted and isinstance(error, StepRampError) and not isinstance(error, Refused)
            if isinstance(error, StepRampError) and not (is_lost or is_left):
                raise
            # A reflex presses Ctrl+C twice: the stop isn't given up by that.
            with _signals(signal.SIG_IGN):
                if isinstance(error, NoServer):
                    tell(f"{error} The motor may still move: the stop is asked for, for up to {STOP_WITHIN_S:g} s.")
                    tell(f"If the server is gone: {_how_to_stop(device)}")
                _stop(where, device, is_told=isinstance(error, KeyboardInterrupt) or (is_left and not is_lost))
            raise


def _stop(where: Where, device: DeviceAnswer, *, is_told: bool) -> None:
    """Stop, and say so."""
    try:
        stopped = where.client.stop(device.id)
    except StepRampError as error:
        tell(f"THE STOP WAS NOT CONFIRMED: {error} The motor may go on: look with `stepramp status`, and stop it with")
        tell(_how_to_stop(device))
        return
    if is_told:
        axes = ((each.axis, each.position_steps if each.position_told else None) for each in stopped.axes)
        words, rest = ("stopping", ", and slows down") if stopped.state == "moving" else ("stopped", "")
        tell(f"{words}: {device.port}{places_of(axes)}{rest}")


def _how_to_stop(device: DeviceAnswer) -> str:
    family = "" if device.family == USUAL_FAMILY else f" --family {device.family}"
    return f"stepramp stop --port {shlex.quote(device.port)}{family}"


@contextmanager
def _signals(handler: Callable[[int, FrameType | None], Any] | signal.Handlers) -> Iterator[None]:
    """Have the signals that end a program handled otherwise while the context lasts; only in the main thread."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    names = ("SIGINT", "SIGTERM", "SIGHUP", "SIGQUIT")
    before = {}
    for number in (getattr(signal, name) for name in names if hasattr(signal, name)):
        before[number] = signal.signal(number, handler)
    try:
        yield
    finally:
        for number, old in before.items():
            signal.signal(number, old)


def _interrupt(number: int, frame: FrameType | None) -> None:
    del number, frame
    raise KeyboardInterrupt


def _part(axis: int, before: DeviceAnswer, told: Callable[[float], None]) -> Callable[[DeviceAnswer], None]:
    """Return what tells how much of a move is made."""
    begin = _axis(before, axis)

    def tell_part(now: DeviceAnswer) -> None:
        there = _axis(now, axis)
        if begin is not None and there is not None and (whole := there.target_steps - begin.position_steps):
            told(min(1.0, abs((there.position_steps - begin.position_steps) / whole)))

    return tell_part


def _axis(device: DeviceAnswer, axis: int) -> AxisAnswer | None:
    return next((each for each in device.axes if each.axis == axis), None)


def _refuse_other_end(rested: DeviceAnswer, began: DeviceAnswer, axis: int) -> None:
    """Raise Refused when a move has ended elsewhere than where it led: somebody has stopped it, or it is lost."""
    end, target = _axis(rested, axis), _axis(began, axis)
    if rested.stops != began.stops:
        raise Refused("The move was stopped before its end.")
    if rested.state == "lost" or end is None:
        raise Refused(f"The device was lost while it moved: {rested.message}")
    if target is not None and began.state == "moving" and end.position_steps != target.target_steps:
        places = f"at {end.position_steps:,}, not at {target.target_steps:,} steps"
        if rested.stopped_by:
            raise Refused(f"The move ended {places}.")
        raise Refused(f"Another motion came after this move: the axis rests {places}.")


def _whole_trace(where: Where, device_id: str) -> TraceAnswer:
    until_s = time.monotonic() + TRACE_WITHIN_S
    while True:
        is_over = time.monotonic() > until_s
        try:
            traced = where.client.trace(device_id)
        except (TooOften, Overloaded):
            if is_over:
                raise
            time.sleep(device_calls.ASKED_AGAIN_AFTER_S)
            continue
        if traced.complete or traced.changed or is_over:
            return traced
        time.sleep(0.05)


def _warn_of(traced: TraceAnswer) -> None:
    if traced.changed:
        warn(["the move was changed on its way: the trace ends there"])
    elif not traced.complete:
        warn(["the trace lacks the end of the move"])


def _as_csv(traced: TraceAnswer) -> bytes:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(("step", "planned_ticks", "measured_ticks", "deviation_us"))
    writer.writerows(zip(traced.step, traced.planned_ticks, traced.measured_ticks, traced.deviation_us, strict=True))
    return text.getvalue().encode()
