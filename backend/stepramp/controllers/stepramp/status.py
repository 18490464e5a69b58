"""What a controller is doing: by what it replies, and by what it reports from then on."""

from collections.abc import Container, Sequence
from dataclasses import replace

from stepramp.controllers.contract import UNDER_WAY, Activity, AxisStatus, ControllerStatus, StoredRamp
from stepramp.controllers.inputs import InputsState, StopCause
from stepramp.controllers.stepramp.input_roles import INPUTS, InputRole
from stepramp.controllers.stepramp.messages.report import ReportNotice
from stepramp.controllers.stepramp.messages.status import (
    AxisState,
    InputsStatus,
    MachineState,
    StatusFlag,
    StatusReply,
    StopBit,
)
from stepramp.units import speed_from_interval

ACTIVITIES = {
    AxisState.IDLE: Activity.READY,
    AxisState.MOVING: Activity.MOVING,
    AxisState.STOPPING: Activity.STOPPING,
}

CAUSES: dict[StopBit, StopCause] = {
    StopBit.EMERGENCY_STOP: "emergency_stop",
    StopBit.DRIVER_FAULT: "driver_fault",
    StopBit.LATENESS: "stepped_late",
}


def status_of(
    replies: Sequence[StatusReply], timer_hz: int, roles: Sequence[InputRole] = (), *, has_ramp: bool
) -> ControllerStatus:
    """Return the status that the replies for each axis tell. roles: what the inputs are for."""
    first, of_inputs = replies[0], replies[-1].inputs
    axes = tuple(_axis_status(axis, reply, of_inputs, timer_hz) for axis, reply in enumerate(replies))
    state = None if of_inputs is None else _inputs_state(of_inputs, roles)
    return ControllerStatus(
        activity=Activity.WRITING if first.state == MachineState.WRITING else _activity_of(axes),
        axes=axes,
        ramp=StoredRamp(first.ramp_sequence, first.image_crc) if has_ramp else None,
        on_trial=bool(first.flags & StatusFlag.ON_TRIAL),
        motors_on=bool(first.flags & StatusFlag.ENABLED),
        starved=max(reply.starved for reply in replies),
        trouble=None if state is None else state.trouble,
        of_inputs=state,
    )


def status_after(
    before: ControllerStatus, report: ReportNotice, running: Container[int], timer_hz: int
) -> ControllerStatus | None:
    """Return the status of a controller whose axes do what they did before; None when one does something else.

    running: the axes that run at a speed.
    """
    if [ACTIVITIES[report.state_of(axis)] for axis in range(len(report.axes))] != [
        axis.activity for axis in before.axes
    ]:
        return None
    axes = tuple(
        _moved_on(axis, position, _speed(interval, timer_hz), runs=axis.axis in running)
        for axis, (position, interval) in zip(before.axes, report.axes, strict=True)
    )
    return replace(before, axes=axes)


def _inputs_state(said: InputsStatus, roles: Sequence[InputRole]) -> InputsState:
    inputs = tuple(role.status(is_active=bool(said.active >> INPUTS.index(role.input) & 1)) for role in roles)
    return InputsState(inputs, tuple(cause for bit, cause in CAUSES.items() if said.stopped_by & bit))


def _axis_status(axis: int, reply: StatusReply, of_inputs: InputsStatus | None, timer_hz: int) -> AxisStatus:
    homing = None if of_inputs is None else bool(of_inputs.homing_axes >> axis & 1)
    activity = ACTIVITIES[AxisState(reply.axis_state)]
    return AxisStatus(
        axis=axis,
        # Where it turns round it rests for a moment, and yet isn't ready.
        activity=Activity.MOVING if homing and activity is Activity.READY else activity,
        position_steps=reply.position_steps,
        target_steps=reply.target_steps,
        speed_steps_per_s=_speed(reply.interval_ticks, timer_hz),
        steps_made=reply.steps_made,
        position_known=None if of_inputs is None else bool(of_inputs.known_axes >> axis & 1),
        homing=homing,
    )


def _moved_on(before: AxisStatus, position: int, speed_steps_per_s: float, *, runs: bool) -> AxisStatus:
    """Return the status of an axis that still does what it did."""
    follows = before.activity is Activity.READY or (runs and before.activity is Activity.MOVING)
    made = before.steps_made + abs(_steps_between(before.position_steps, position))
    return replace(
        before,
        position_steps=position,
        target_steps=position if follows else before.target_steps,
        speed_steps_per_s=speed_steps_per_s,
        steps_made=made if before.activity in UNDER_WAY else before.steps_made,
    )


def _speed(interval_ticks: int, timer_hz: int) -> float:
    return speed_from_interval(interval_ticks, timer_hz) if interval_ticks else 0.0


def _steps_between(before: int, after: int) -> int:
    """Return the steps from one position to another soon after: runs go on past the last position to the first."""
    return (after - before + 2**31) % 2**32 - 2**31


def _activity_of(axes: Sequence[AxisStatus]) -> Activity:
    """Return what a controller does as a whole: it stops when all that move stop."""
    activities = {axis.activity for axis in axes}
    return next((each for each in (Activity.MOVING, Activity.STOPPING) if each in activities), Activity.READY)
