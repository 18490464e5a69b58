"""What soft limits forbid a device, as it was last heard of."""

import math
from bisect import bisect_left
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import replace
from time import monotonic

from stepramp.controllers.contract import AxisCommand
from stepramp.devices.leases import Leases
from stepramp.devices.soft_limits import FREE, Span, comes_too_near, out_of_limits, refuse_beyond, trouble_of
from stepramp.devices.view import AxisView, DeviceView
from stepramp.errors import Refused, Rejected, Rejection

StepsToRest = Callable[[int, float], int]
"""How many steps an axis takes to slow down from a speed [steps/s]."""


def refuse_absent(view: DeviceView, spans: Mapping[int, Span]) -> None:
    """Reject limits of axes that aren't there, counted as they were asked for: nobody would see them."""
    present = [axis.axis for axis in view.axes]
    allowed = f"an axis that has a ramp: 0 to {present[-1]}"
    absent = [
        Rejection(f"axes.{number}.axis", axis, allowed) for number, axis in enumerate(spans) if axis not in present
    ]
    if absent:
        raise Rejected(absent)


def refuse_targets(view: DeviceView, commands: Sequence[AxisCommand], *, relative: bool) -> None:
    """Reject what leads beyond soft limits, or too far without; commands: distances, or else positions [steps]."""
    _refuse_unknown(view, [each.axis for each in commands])
    refuse_beyond(view.soft_limits, commands, _targets(view), relative=relative)


def refuse_there_and_back(view: DeviceView, leg: AxisCommand) -> None:
    """Reject a leg that leads beyond soft limits, or whose leg back does."""
    refuse_targets(view, [leg], relative=True)
    there = {axis: target + int(leg.value) for axis, target in _targets(view).items()}
    refuse_beyond(view.soft_limits, [replace(leg, value=-leg.value)], there, relative=True)


def refuse_outward(view: DeviceView, speeds: Sequence[AxisCommand], steps_to_rest: StepsToRest) -> None:
    """Reject speeds with which axes can't be kept within their soft limits."""
    going = [each for each in speeds if each.value]
    _refuse_unknown(view, [each.axis for each in going])
    limited = {axis.axis: axis for axis in view.axes if axis.axis in view.soft_limits}
    near = [
        each
        for each in going
        if each.axis in limited and _is_near(view, limited[each.axis], each.value, steps_to_rest, since_s=0.0)
    ]
    if near:
        fastest = {each.axis: _fastest(view, limited[each.axis], each.value, steps_to_rest) for each in near}
        raise Rejected([out_of_limits(each, view.soft_limits[each.axis], fastest[each.axis]) for each in near])


def refuse_running(view: DeviceView, running: Collection[int], steps: Sequence[AxisCommand]) -> None:
    """Refused for axes that run and have soft limits: where they are when the controller hears it isn't known."""
    for each in steps:
        if each.axis in running and each.axis in view.soft_limits:
            raise Refused(f"Axis {each.axis} runs, and has soft limits: say a position, or stop it first.")


def refuse_limited(view: DeviceView, axes: Iterable[int]) -> None:
    """Reject axes that have soft limits, for what goes on to wherever a stop is."""
    limited = sorted(set(axes) & set(view.soft_limits))
    if limited:
        allowed = "axes without soft limits: to zero is to run against a stop, wherever that is"
        raise Rejected([Rejection("axes", axis, allowed) for axis in limited])


def too_near(view: DeviceView, leases: Leases, steps_to_rest: StepsToRest) -> list[int]:
    """Return which axes of those that run on leases must slow down now to stay within their soft limits."""
    now_s, speeds = monotonic(), leases.speeds
    return [
        axis.axis
        for axis in view.axes
        if axis.axis in view.soft_limits
        and axis.axis in speeds
        # What was heard of an axis before it set out may be old: it rested until then.
        and _is_near(
            view, axis, speeds[axis.axis], steps_to_rest, now_s - max(view.heard_s, leases.set_out_s(axis.axis))
        )
    ]


def _refuse_unknown(view: DeviceView, axes: Collection[int]) -> None:
    """Refused for axes with soft limits that may be elsewhere than they count, or count by others than those.

    Limits would be at other places.
    """
    trouble = trouble_of(view.soft_limits, [each for each in view.axes if each.axis in axes])
    if trouble is not None:
        raise Refused(trouble)
    lost = sorted(set(axes) & set(view.unknown_positions) & set(view.soft_limits))
    if any(axis.homing for axis in view.axes if axis.axis in lost):
        raise Refused("The motor moves: it is being homed. Stop it first, or wait.")
    if named_later := sorted(set(lost) & set(view.after_homing)):
        raise Refused(
            f"Axis {named_later[0]} was homed, and where it is gets its name once all axes rest: wait for that."
        )
    if lost:
        which = f"Axis {lost[0]}" if len(lost) == 1 else f"Axes {', '.join(map(str, lost))}"
        raise Refused(
            f"{which} may be elsewhere than counted, since the device was lost or disconnected, or it wasn't homed "
            "to the end, or by somebody else, so soft limits can't be kept: set its position, or take the limits away."
        )


def _fastest(view: DeviceView, axis: AxisView, speed_steps_per_s: float, steps_to_rest: StepsToRest) -> int:
    """Return the fastest whole speed the same way with which an axis is kept within its soft limits; 0: none."""

    def is_near(slower: int) -> bool:
        return _is_near(view, axis, math.copysign(slower, speed_steps_per_s), steps_to_rest, since_s=0.0)

    return bisect_left(range(1, math.ceil(abs(speed_steps_per_s))), True, key=is_near)


def _is_near(
    view: DeviceView, axis: AxisView, speed_steps_per_s: float, steps_to_rest: StepsToRest, since_s: float
) -> bool:
    """Tell whether an axis can't be kept within its soft limits when it runs at a speed, negative for backwards.

    since_s: how long it has gone on since it was heard of [s].
    """
    fastest = max(axis.speed_steps_per_s, abs(speed_steps_per_s))
    velocity = fastest if speed_steps_per_s > 0 else -fastest
    span = view.soft_limits.get(axis.axis, FREE)
    position = axis.position_steps + velocity * since_s
    return comes_too_near(span, position, velocity, steps_to_rest(axis.axis, fastest))


def _targets(view: DeviceView) -> dict[int, int]:
    """Return where each axis would come to rest [steps]."""
    return {each.axis: each.target_steps for each in view.axes}
