"""Routes that move the axes of attached controllers."""

from typing import Any

from fastapi import APIRouter
from starlette.responses import Response

from stepramp.http_api.bodies import JsonRoute
from stepramp.http_api.device_registry import Acting, Page, Registry
from stepramp.http_api.devices_models import DeviceAnswer
from stepramp.http_api.json_response import JsonResponse
from stepramp.http_api.lanes import ACTING
from stepramp.http_api.motion_models import (
    HomePayload,
    LinePayload,
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
from stepramp.http_api.request_numbers import RequestNumber
from stepramp.http_api.rest import then_waits

router = APIRouter(route_class=JsonRoute)

_CSV: dict[str, Any] = {"text/csv": {"schema": {"type": "string"}}}


@router.post("/devices/{device_id}/move")
@then_waits
@ACTING.serves
def move(request: MovePayload, device: Acting, request_number: RequestNumber) -> DeviceAnswer:
    """Begin to move with the ramps in use, by so many steps or to positions, also from the midst of a move.

    As of all motions, the answer tells how it begins, or with `wait_s` how the device is at rest. A wait that is over
    before, or whose client leaves, ends no motion.
    """
    if request.is_relative:
        device.move_by(request.commands, request_number)
    else:
        device.move_to(request.commands, request_number)
    return DeviceAnswer.model_validate(device.view)


@router.post("/devices/{device_id}/there_and_back")
@then_waits
@ACTING.serves
def there_and_back(request: ShuttlePayload, device: Acting, request_number: RequestNumber, page: Page) -> DeviceAnswer:
    """Begin to go there and back, so many times, from rest. Whatever else is asked of axes ends it, as does a stop.

    What a page has begun ends with it, as a run does.
    """
    device.go_there_and_back(request.shuttle(page), request.command, request_number)
    return DeviceAnswer.model_validate(device.view)


@router.post("/devices/{device_id}/run")
@then_waits
@ACTING.serves
def run(request: RunPayload, device: Acting, request_number: RequestNumber, page: Page) -> DeviceAnswer:
    """Run at speeds for so long, also from the midst of a move; asked again in time, it goes on. Then it slows down.

    So a program that is gone leaves no motor running, nor does a page: what it runs ends with it. Asked again without a
    name, it begins anew if it has slowed down already. A program that may be held up names its run, and renews it by
    that name: once it has slowed down, for whatever reason, that is refused (409), and nothing moves. To run only as
    long as somebody holds a button, open the WebSocket `/devices/{device_id}/jog` instead: send
    `{"do": "run", "axis": 0, "speed_steps_per_s": 400}`, then `{"do": "hold"}` at least every 0.4 s. The axis slows
    down when that stops, when the socket closes, or at `{"do": "end"}`.
    """
    lease = request.lease(page)
    if request.renews:
        device.renew_run(lease, request_number)
    else:
        device.run(request.commands, lease, request_number)
    return DeviceAnswer.model_validate(device.view)


@router.post("/devices/{device_id}/line")
@then_waits
@ACTING.serves
def line(request: LinePayload, device: Acting, request_number: RequestNumber) -> DeviceAnswer:
    """Begin to move along a straight line, from rest."""
    device.line(request.commands, request.ramp_axis, request_number)
    return DeviceAnswer.model_validate(device.view)


@router.post("/devices/{device_id}/position")
@ACTING.serves
def position(request: PositionPayload, device: Acting) -> DeviceAnswer:
    """Call the places where axes are at rest something else. Nothing moves."""
    device.set_position(request.commands)
    return DeviceAnswer.model_validate(device.view)


@router.post("/devices/{device_id}/zero")
@then_waits
@ACTING.serves
def zero(request: ZeroPayload, device: Acting, request_number: RequestNumber) -> DeviceAnswer:
    """Move gauges backwards against their stop, which is position 0 from then on."""
    device.zero(request.axes, request.steps, request_number)
    return DeviceAnswer.model_validate(device.view)


@router.post("/devices/{device_id}/home")
@then_waits
@ACTING.serves
def home(request: HomePayload, device: Acting, request_number: RequestNumber, page: Page) -> DeviceAnswer:
    """Begin to find limit switches, from rest: fast towards them, slowly away until they let go, slowly back to them.

    The place of the last step before the switch is active again is position 0 then, and known. Where `position_steps`
    says another, it is called so, and known, as soon as all axes rest. `axes[].homing` tells how long it takes,
    `axes[].position_known` whether it has come to that: a stop, an emergency stop, or a switch that doesn't let go ends
    it, and the position is unknown.

    It ends after `for_s`, and with the page that began it, as a run does. Soft limits don't hold while an axis is
    homed, since it isn't known where they are: the answer says so by `axes[].limits_hold`. Which switches there are the
    settings say; towards an end without one it is refused.
    """
    device.home(request.homing, request.lease(page), request_number)
    return DeviceAnswer.model_validate(device.view)


@router.post("/devices/{device_id}/acknowledge")
@ACTING.serves
def acknowledge(device: Acting, request_number: RequestNumber) -> DeviceAnswer:
    """Let motions be taken again after an emergency stop or a driver's fault; nothing moves by that.

    Refused while one of their inputs is active: release the emergency stop, or mend the fault, first. `stopped_by` says
    what is to be acknowledged; with nothing it is harmless.
    """
    device.acknowledge(request_number)
    return DeviceAnswer.model_validate(device.view)


@router.put("/devices/{device_id}/soft_limits")
@ACTING.serves
def limit(request: SoftLimitsPayload, device: Acting) -> DeviceAnswer:
    """Keep axes within positions from now on; null takes a limit away. Nothing moves.

    An axis may be beyond them: `is_beyond_limits` says so, and it is taken by moves that end within them, and by runs
    towards them, only.

    The server keeps them until it ends, also when the device is disconnected and connected again, for its port, or its
    USB serial number: what leads beyond is refused, and a run slows down in time. Controllers know nothing of them, so
    that a run slows down as far before a limit as it goes in half a second; a move reaches it to the step.
    While `unknown_positions` names an axis, since its device was lost or disconnected, it isn't known where its limits
    are: nothing moves it until its position is set, or its limits are taken away. So while its `microsteps`, or its
    `steps_per_mm`, are others than when they were set, which `message` says with both: until they are set anew, or
    taken away.
    """
    device.limit(request.spans)
    return DeviceAnswer.model_validate(device.view)


@router.put("/devices/{device_id}/trace")
@ACTING.serves
def trace_moves(request: TracePayload, device: Acting) -> TracingAnswer:
    """Trace the moves of an axis that begin from now on: when each step, or every so many-th, was made."""
    following = device.trace_moves(request.traced_axis, request.every_steps)
    return TracingAnswer(
        traced_axis=request.traced_axis, every_steps=following.every_steps, next_number=following.number
    )


@router.get("/devices/{device_id}/trace")
@ACTING.serves
def trace(device_id: str, devices: Registry) -> JsonResponse[TraceAnswer]:
    """Return the trace of the last move that was traced, as far as it is known."""
    return JsonResponse(TraceAnswer.of(devices.get(device_id).trace()))


@router.get("/devices/{device_id}/trace.csv", response_class=Response, responses={200: {"content": _CSV}})
@ACTING.serves
def trace_as_csv(device_id: str, devices: Registry) -> Response:
    """Return the same as a file that `/capture` reads, unless it lacks steps: each edge is one."""
    headers = {"content-disposition": 'attachment; filename="trace.csv"'}
    return Response(devices.get(device_id).trace_as_csv(), headers=headers, media_type="text/csv")
