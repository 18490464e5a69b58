"""What a motor is doing, as the protocol says it."""

from stepramp.controllers.stepramp.messages.status import AxisState
from stepramp.ramp.playback.motor import Motor


def state_of(motor: Motor) -> AxisState:
    """Return what a motor is doing."""
    if not motor.moving:
        return AxisState.IDLE
    return AxisState.STOPPING if motor.stopping else AxisState.MOVING
