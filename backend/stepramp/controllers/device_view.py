"""What is known of a device at one moment."""

from dataclasses import dataclass, replace
from enum import StrEnum

from stepramp.controllers.controller import Activity, AxisStatus, ControllerStatus, PushReport, StoredRamp


class DeviceState(StrEnum):
    """Where a device is between connecting and being lost."""

    CONNECTING = "connecting"
    READY = "ready"
    MOVING = "moving"
    STOPPING = "stopping"
    WRITING = "writing"
    LOST = "lost"


STATES = {activity: DeviceState(activity.value) for activity in Activity}
UNDER_WAY = (DeviceState.MOVING, DeviceState.STOPPING)


@dataclass(frozen=True)
class AxisView:
    """An axis as it was at one moment; positions [steps], speed without sign [steps/s]."""

    axis: int
    state: DeviceState
    position_steps: int
    target_steps: int
    speed_steps_per_s: float
    steps_made: int


@dataclass(frozen=True)
class DeviceView:
    """A device as it was at one moment. Position, target and speed are those of axis 0."""

    id: str
    port: str
    name: str
    state: DeviceState = DeviceState.CONNECTING
    message: str | None = None
    """Why the device is lost."""
    position_steps: int = 0
    target_steps: int = 0
    speed_steps_per_s: float = 0.0
    axes: tuple[AxisView, ...] = ()
    """Each axis that has a ramp; the first one in any case, once connected."""
    timer_hz: int | None = None
    """Known once connected, as are the clocks, the firmware's version and the ramp."""
    clocks_hz: tuple[int, int] | None = None
    firmware_version: str | None = None
    ramp: StoredRamp | None = None
    on_trial: bool = False
    motors_on: bool = False
    starved: int = 0
    pushed: PushReport | None = None
    """The last push over this connection."""

    def with_status(self, status: ControllerStatus) -> "DeviceView":
        """Return the device as its controller now says it is."""
        first = status.axes[0]
        return replace(
            self,
            state=STATES[status.activity],
            position_steps=first.position_steps,
            target_steps=first.target_steps,
            speed_steps_per_s=first.speed_steps_per_s,
            axes=tuple(map(_axis_view, status.axes)),
            ramp=status.ramp,
            on_trial=status.on_trial,
            motors_on=status.motors_on,
            starved=status.starved,
        )

    def at_a_loss(self, message: str) -> "DeviceView":
        """Return the device as it is once its controller is no longer there."""
        axes = tuple(replace(axis, state=DeviceState.LOST, speed_steps_per_s=0.0) for axis in self.axes)
        return replace(self, state=DeviceState.LOST, message=message, speed_steps_per_s=0.0, axes=axes)


def _axis_view(status: AxisStatus) -> AxisView:
    return AxisView(
        axis=status.axis,
        state=STATES[status.activity],
        position_steps=status.position_steps,
        target_steps=status.target_steps,
        speed_steps_per_s=status.speed_steps_per_s,
        steps_made=status.steps_made,
    )
