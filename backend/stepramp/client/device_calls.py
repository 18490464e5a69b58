"""What a client can ask of devices.

Nothing here moves a motor but `move`, `line`, `there_and_back`, `run`, `run_for`, `home` and `zero`.
"""

import re
from collections.abc import Callable, Mapping, Sequence
from time import monotonic
from typing import Literal
from urllib.parse import quote
from uuid import uuid4

from stepramp.client.calls import CONNECTING_S, PUSHING_S, QUICK_S, Call, Pause, Script, get, payload, post
from stepramp.client.design_calls import ADesign
from stepramp.errors import Overloaded, Refused, Rejected, Rejection, TooOften
from stepramp.http_api.backups_models import ArchiveAnswer, BackupsAnswer, RestoredAnswer, RestorePayload
from stepramp.http_api.devices_models import (
    ConnectPayload,
    DeviceAnswer,
    DevicesAnswer,
    DisconnectedAnswer,
    KeptAnswer,
    PortsAnswer,
    PreviewAnswer,
    PushDesigns,
    PushedAnswer,
    PushPayload,
)
from stepramp.http_api.motion_models import (
    HomePayload,
    LinePayload,
    Motion,
    MovePayload,
    PositionPayload,
    RunPayload,
    ShuttlePayload,
    SoftLimitsPayload,
    TraceAnswer,
    TracePayload,
    TracingAnswer,
    ZeroPayload,
)

STOPS_HEADER = "X-StepRamp-Stops"
KEY_HEADER = "Idempotency-Key"
MOST_KEY = 200
"""Length of the longest key that a server takes [characters]."""
LEASE_S = 2.0
"""So long an axis runs on after whoever makes it run is gone [s]."""
RENEWED_EVERY_S = 0.5
LOOKED_AT_EVERY_S = 0.05
ASKED_AGAIN_AFTER_S = 0.5
"""So long a server that was asked too much is left alone [s]."""


def ports() -> Call[PortsAnswer]:
    """Return what can be connected to, and the families that a controller there may be of."""
    return get("ports", PortsAnswer)


def devices() -> Call[DevicesAnswer]:
    """Return the devices that are connected, or were until they were lost."""
    return get("devices", DevicesAnswer)


def device(device_id: str) -> Call[DeviceAnswer]:
    """Return a device as it is now."""
    return get(_path(device_id), DeviceAnswer)


def connect(port: str, family: str | None = None) -> Call[DeviceAnswer]:
    """Connect to a port, and return its device. Nothing moves. family: of its controller; None: StepRamp's own."""
    body = payload(ConnectPayload, port=port, family=family)
    return post("devices", DeviceAnswer, body, patience_s=CONNECTING_S)


def disconnect(device_id: str) -> Call[DisconnectedAnswer]:
    """Let go of a device; refused while a motor of it moves."""
    return Call("DELETE", _path(device_id), DisconnectedAnswer.model_validate_json, patience_s=CONNECTING_S)


def preview_push(
    device_id: str, design: ADesign | None = None, *, to_axis: int | None = None, axes: Sequence[ADesign] | None = None
) -> Call[PreviewAnswer]:
    """Return what a push would change; nothing is sent to the device."""
    body = payload(PushDesigns, design=design, to_axis=to_axis, axes=None if axes is None else list(axes))
    return post(_path(device_id, "push/preview"), PreviewAnswer, body, patience_s=PUSHING_S)


def push(
    device_id: str,
    design: ADesign | None = None,
    *,
    to_axis: int | None = None,
    axes: Sequence[ADesign] | None = None,
    mode: Literal["keep", "try"] | None = None,
    key: str | None = None,
) -> Call[PushedAnswer]:
    """Have a device use a design's ramp, or those of all axes, stored or on trial, and read it back. key: see move."""
    given = None if axes is None else list(axes)
    body = payload(PushPayload, design=design, to_axis=to_axis, axes=given, mode=mode)
    return post(_path(device_id, "push"), PushedAnswer, body, patience_s=PUSHING_S, headers=_keyed(key))


def keep(device_id: str) -> Call[KeptAnswer]:
    """Store the ramps and settings that are in use."""
    return post(_path(device_id, "keep"), KeptAnswer, patience_s=PUSHING_S)


def roll_back(device_id: str) -> Call[DeviceAnswer]:
    """Drop the ramps and settings that are on trial."""
    return _told(device_id, "roll_back", PUSHING_S)


def restore(device_id: str) -> Call[DeviceAnswer]:
    """Bring back the ramps and settings that were stored before the present ones."""
    return _told(device_id, "restore", PUSHING_S)


def backups(device_id: str) -> Call[BackupsAnswer]:
    """Return what was saved of a device before it was written to, the newest first."""
    return get(_path(device_id, "backups"), BackupsAnswer)


def all_backups() -> Call[ArchiveAnswer]:
    """Return all backups that there are, also of controllers that aren't connected."""
    return get("backups", ArchiveAnswer)


def restore_backup(device_id: str, name: str) -> Call[RestoredAnswer]:
    """Write what differs of a backup, one setting at a time, and read it back."""
    path = _path(device_id, f"backups/{quote(name, safe='')}/restore")
    return post(path, RestoredAnswer, patience_s=PUSHING_S)


def restore_backup_of(device_id: str, source: str, name: str) -> Call[RestoredAnswer]:
    """Write what differs of any backup of the same family, as all_backups names them, and read it back."""
    body = payload(RestorePayload, source=source, name=name)
    return post(_path(device_id, "backups/restore"), RestoredAnswer, body, patience_s=PUSHING_S)


def move(
    device_id: str,
    *,
    by_steps: int | None = None,
    to_steps: int | None = None,
    axes: Sequence[Mapping[str, int]] | None = None,
    wait_s: float | None = None,
    stops: int | None = None,
    key: str | None = None,
) -> Call[DeviceAnswer]:
    """Begin to move axis 0, or several: `axes=[{"axis": 1, "by_steps": 200}]`.

    wait_s: how long the answer may wait until nothing moves any more; None: it comes at once, as of all motions.
    stops: the `stops` that the device told when the move was decided; after a stop since, it is refused.
    key: what stands for this one move, however often it is asked for.
    """
    asked = {"by_steps": by_steps, "to_steps": to_steps, "axes": _listed(axes)}
    return _motion(device_id, "move", MovePayload, asked, wait_s, stops, key)


def run(
    device_id: str,
    *,
    speed_steps_per_s: float | None = None,
    axes: Sequence[Mapping[str, float]] | None = None,
    for_s: float | None = None,
    name: str | None = None,
    renews: bool | None = None,
    wait_s: float | None = None,
    stops: int | None = None,
    key: str | None = None,
) -> Call[DeviceAnswer]:
    """Run at speeds for so long, 2 s if nothing is said. The others: see move.

    name: another one for each run. renews: let the run of that name go on; refused once it has slowed down.
    """
    how = {"for_s": for_s, "name": name, "renews": renews}
    asked = {"speed_steps_per_s": speed_steps_per_s, "axes": _listed(axes), **how}
    return _motion(device_id, "run", RunPayload, asked, wait_s, stops, key)


def line(
    device_id: str,
    axes: Sequence[Mapping[str, int]],
    *,
    ramp_axis: int | None = None,
    wait_s: float | None = None,
    stops: int | None = None,
    key: str | None = None,
) -> Call[DeviceAnswer]:
    """Begin to move along a straight line: `axes=[{"axis": 0, "by_steps": 200}, …]`. The others: see move."""
    asked = {"axes": _listed(axes), "ramp_axis": ramp_axis}
    return _motion(device_id, "line", LinePayload, asked, wait_s, stops, key)


def there_and_back(
    device_id: str,
    by_steps: int,
    *,
    axis: int | None = None,
    times: int | None = None,
    pause_s: float | None = None,
    wait_s: float | None = None,
    stops: int | None = None,
    key: str | None = None,
) -> Call[DeviceAnswer]:
    """Begin to go there and back, so many times. The others: see move."""
    asked = {"axis": axis, "by_steps": by_steps, "times": times, "pause_s": pause_s}
    return _motion(device_id, "there_and_back", ShuttlePayload, asked, wait_s, stops, key)


def zero(
    device_id: str,
    steps: int,
    *,
    axes: Sequence[int] | None = None,
    wait_s: float | None = None,
    stops: int | None = None,
    key: str | None = None,
) -> Call[DeviceAnswer]:
    """Move gauges backwards against their stop, which is position 0 from then on. The others: see move."""
    asked = {"axes": None if axes is None else list(axes), "steps": steps}
    return _motion(device_id, "zero", ZeroPayload, asked, wait_s, stops, key)


def home(
    device_id: str,
    axes: Sequence[Mapping[str, float]],
    slow_steps_per_s: float,
    *,
    back_off_steps: int | None = None,
    for_s: float | None = None,
    wait_s: float | None = None,
    stops: int | None = None,
    key: str | None = None,
) -> Call[DeviceAnswer]:
    """Begin to find limit switches: `axes=[{"axis": 0, "fast_steps_per_s": -400}]`. The others: see move."""
    asked = {
        "axes": _listed(axes),
        "slow_steps_per_s": slow_steps_per_s,
        "back_off_steps": back_off_steps,
        "for_s": for_s,
    }
    return _motion(device_id, "home", HomePayload, asked, wait_s, stops, key)


def set_soft_limits(device_id: str, axes: Sequence[Mapping[str, int | None]]) -> Call[DeviceAnswer]:
    """Keep axes within positions: `axes=[{"axis": 0, "lowest_steps": 0, "highest_steps": 4000}]`. Nothing moves."""
    body = payload(SoftLimitsPayload, axes=_listed(axes))
    return Call("PUT", _path(device_id, "soft_limits"), DeviceAnswer.model_validate_json, body)


def set_position(device_id: str, position_steps: int, axis: int = 0) -> Call[DeviceAnswer]:
    """Call the place where an axis is at rest something else. Nothing moves."""
    body = payload(PositionPayload, axes=[{"axis": axis, "position_steps": position_steps}])
    return post(_path(device_id, "position"), DeviceAnswer, body)


def acknowledge(device_id: str) -> Call[DeviceAnswer]:
    """Let motions be taken again after an emergency stop or a driver's fault. Nothing moves."""
    return _told(device_id, "acknowledge")


def trace_moves(device_id: str, axis: int | None = 0, *, every_steps: int | None = None) -> Call[TracingAnswer]:
    """Trace the moves of an axis that begin from now on; None: of none."""
    body = TracePayload.checked({"traced_axis": axis, "every_steps": every_steps or 0}).model_dump_json().encode()
    return Call("PUT", _path(device_id, "trace"), TracingAnswer.model_validate_json, body)


def trace(device_id: str) -> Call[TraceAnswer]:
    """Return when the steps of the last traced move were made."""
    return get(_path(device_id, "trace"), TraceAnswer)


def until_rest(
    device_id: str, *, within_s: float | None = None, tell: Callable[[DeviceAnswer], None] = lambda _: None
) -> Script[DeviceAnswer]:
    """Wait until a device moves no more, and return it as it is then; or is lost, or so much time is over [s].

    A server that doesn't tell just now, as it was asked too much, is asked again. tell: called with it as it moves.
    """
    begin_s = monotonic()
    while True:
        try:
            now: DeviceAnswer = yield device(device_id)
        except (TooOften, Overloaded):
            if within_s is not None and monotonic() - begin_s > within_s:
                raise
            # What moves goes on meanwhile.
            yield Pause(ASKED_AGAIN_AFTER_S)
            continue
        tell(now)
        is_over = within_s is not None and monotonic() - begin_s > within_s
        if is_over or (now.state not in ("moving", "stopping") and now.shuttle is None):
            return now
        yield Pause(LOOKED_AT_EVERY_S)


def run_for(
    device_id: str,
    axis: int,
    speed_steps_per_s: float,
    for_s: float,
    *,
    stops: int | None = None,
    tell: Callable[[DeviceAnswer], None] = lambda _: None,
) -> Script[DeviceAnswer]:
    """Run an axis for so long, and wait until it rests. It slows down within 2 s of when whoever waits is gone.

    After a stop, whoever asked for it, it is refused to go on; so once this program was silent for 2 s, as when it is
    paused: then the motor has slowed down, and is not moved again.
    """
    refuse_rest(speed_steps_per_s)
    if stops is None:
        known: DeviceAnswer = yield device(device_id)
        stops = known.stops
    axes, name = [{"axis": axis, "speed_steps_per_s": speed_steps_per_s}], uuid4().hex
    begin_s = asked_s = monotonic()
    until_s, held_until_s = begin_s + for_s, None
    # What is left of the last renewal lasts to the end: one more might come as the axis slows down already.
    while held_until_s is None or held_until_s < until_s or until_s - monotonic() > RENEWED_EVERY_S:
        now_s = monotonic()
        _refuse_silence(now_s, asked_s, held_until_s)
        renews = None if held_until_s is None else True
        lasts_s = min(LEASE_S, max(until_s - now_s, 0.05))
        lasts_to_the_end = lasts_s >= until_s - now_s
        try:
            now: DeviceAnswer = yield run(device_id, axes=axes, for_s=lasts_s, name=name, renews=renews, stops=stops)
        except (TooOften, Overloaded):
            # What was granted goes on meanwhile, and may be renewed before it is over.
            if held_until_s is None or monotonic() + ASKED_AGAIN_AFTER_S > held_until_s:
                raise
            yield Pause(ASKED_AGAIN_AFTER_S)
            continue
        asked_s, held_until_s = now_s, until_s if lasts_to_the_end else now_s + lasts_s
        tell(now)
        yield Pause(min(RENEWED_EVERY_S, max(0.0, until_s - monotonic())))
    yield Pause(max(0.0, until_s - monotonic()))
    return (yield from until_rest(device_id, tell=tell))


def refuse_rest(speed_steps_per_s: float) -> None:
    """Refuse to run at no speed. Raises Rejected."""
    if speed_steps_per_s == 0:
        raise Rejected([Rejection("speed_steps_per_s", speed_steps_per_s, "a number of steps/s, but not 0")])


def _refuse_silence(now_s: float, asked_s: float, held_until_s: float | None) -> None:
    """Refuse to go on with a run that has slowed down meanwhile: this program was paused, or had no turn.

    The server refuses that, too; it can't tell for how long this program was silent.
    """
    if held_until_s is not None and now_s > held_until_s:
        silent = f"{now_s - asked_s:,.3g} s"
        raise Refused(f"The run was given up, since this program was silent for {silent}: the motor has slowed down.")


def _path(device_id: str, what: str = "") -> str:
    return f"devices/{quote(device_id, safe='')}" + (what and f"/{what}")


def _told(device_id: str, what: str, patience_s: float = 20.0) -> Call[DeviceAnswer]:
    return post(_path(device_id, what), DeviceAnswer, patience_s=patience_s)


def _listed(axes: Sequence[Mapping[str, object]] | None) -> list[dict[str, object]] | None:
    return None if axes is None else [dict(each) for each in axes]


def _motion(
    device_id: str,
    what: str,
    model: type[Motion],
    asked: Mapping[str, object],
    wait_s: float | None,
    stops: int | None,
    key: str | None,
) -> Call[DeviceAnswer]:
    body = payload(model, **asked, wait_s=wait_s)
    headers = ({} if stops is None else {STOPS_HEADER: str(stops)}) | _keyed(key)
    return post(_path(device_id, what), DeviceAnswer, body, headers=headers, patience_s=QUICK_S + (wait_s or 0.0))


def _keyed(key: str | None) -> dict[str, str]:
    if key is None:
        return {}
    if not re.fullmatch(f"[!-~]{{1,{MOST_KEY}}}", key):
        raise Rejected([Rejection("key", key, f"1 to {MOST_KEY} visible ASCII characters")])
    return {KEY_HEADER: key}
