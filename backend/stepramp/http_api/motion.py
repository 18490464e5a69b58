"""Routes that move the axes of attached controllers, and stop them."""

from fastapi import APIRouter
from starlette.responses import Response

from stepramp.http_api.device_models import DeviceAnswer, DevicesAnswer
from stepramp.http_api.device_registry import Acting, Registry
from stepramp.http_api.json_response import json_response
from stepramp.http_api.motion_models import (
    AxesRequest,
    LineRequest,
    MoveRequest,
    PositionRequest,
    RunRequest,
    ShuttleRequest,
    TraceAnswer,
    TraceRequest,
    TracingAnswer,
    ZeroRequest,
    trace_content,
)

router = APIRouter()


@router.post("/devices/stop")
def stop_all(devices: Registry) -> DevicesAnswer:
    """Stop every device, whatever it does."""
    devices.stop_all()
    return DevicesAnswer.model_validate({"devices": devices.views()})


@router.post("/devices/{device_id}/move")
def move(request: MoveRequest, device: Acting) -> DeviceAnswer:
    """Begin to move with the ramps in use, by so many steps or to positions, also from the midst of a move."""
    if request.is_relative:
        device.move_by(request.asked)
    else:
        device.move_to(request.asked)
    return DeviceAnswer.model_validate(device.view)


@router.post("/devices/{device_id}/there_and_back")
def there_and_back(request: ShuttleRequest, device: Acting) -> DeviceAnswer:
    """Begin to go there and back, so many times, from rest. Whatever else is asked of axes ends it, as does a stop."""
    device.go_there_and_back(request.shuttle, request.asked)
    return DeviceAnswer.model_validate(device.view)


@router.post("/devices/{device_id}/run")
def run(request: RunRequest, device: Acting) -> DeviceAnswer:
    """Run at speeds until something else is asked for, also from the midst of a move.

    To run only as long as somebody holds a button, open the WebSocket `/devices/{device_id}/jog` instead: send
    `{"do": "run", "axis": 0, "speed_steps_per_s": 400}`, then `{"do": "hold"}` at least every 0.4 s. The axis slows
    down when that stops, when the socket closes, or at `{"do": "end"}`.
    """
    device.run(request.asked)
    return DeviceAnswer.model_validate(device.view)


@router.post("/devices/{device_id}/line")
def line(request: LineRequest, device: Acting) -> DeviceAnswer:
    """Begin to move along a straight line, from rest."""
    device.line(request.asked, request.ramp_axis)
    return DeviceAnswer.model_validate(device.view)


@router.post("/devices/{device_id}/position")
def position(request: PositionRequest, device: Acting) -> DeviceAnswer:
    """Call the places where axes are at rest something else. Nothing moves."""
    device.set_position(request.asked)
    return DeviceAnswer.model_validate(device.view)


@router.post("/devices/{device_id}/zero")
def zero(request: ZeroRequest, device: Acting) -> DeviceAnswer:
    """Move gauges backwards against their stop, which is position 0 from then on."""
    device.zero(request.axes, request.steps)
    return DeviceAnswer.model_validate(device.view)


@router.put("/devices/{device_id}/trace")
def trace_moves(request: TraceRequest, device: Acting) -> TracingAnswer:
    """Trace the moves of an axis that begin from now on: when each step, or every so many-th, was made."""
    every = device.trace_moves(request.traced_axis, request.every_steps)
    return TracingAnswer(traced_axis=request.traced_axis, every_steps=every)


@router.get("/devices/{device_id}/trace", response_model=TraceAnswer)
def trace(device_id: str, devices: Registry) -> Response:
    """Return the trace of the last move that was traced, as far as it is known."""
    return json_response(trace_content(devices.get(device_id).trace()))


@router.post("/devices/{device_id}/stop")
def stop(device_id: str, devices: Registry, request: AxesRequest | None = None) -> DeviceAnswer:
    """Slow axes, or all, down with their ramps, before anything else that was asked for."""
    device = devices.get(device_id)
    device.stop(request.axes if request else None).result()
    return DeviceAnswer.model_validate(device.view)


@router.post("/devices/{device_id}/halt")
def halt(device_id: str, devices: Registry, request: AxesRequest | None = None) -> DeviceAnswer:
    """Make no further step, before anything else that was asked for. A fast motor may slip."""
    device = devices.get(device_id)
    device.halt(request.axes if request else None).result()
    return DeviceAnswer.model_validate(device.view)
