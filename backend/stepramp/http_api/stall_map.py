"""The route that has a stall map computed, as a job."""

from functools import partial

from fastapi import APIRouter
from starlette.requests import Request

from stepramp.executors.choice import executor
from stepramp.http_api.bodies import JsonRoute
from stepramp.http_api.device_registry import JobRegistry
from stepramp.http_api.job_registry import Computation
from stepramp.http_api.json_response import JsonResponse, json_bytes
from stepramp.http_api.stall_map_models import MapPayload, StallMapAnswer, StartedAnswer
from stepramp.motor.map_points import own_verdict, verdict_at
from stepramp.motor.map_ranges import question_of
from stepramp.motor.stall_map import stall_map
from stepramp.motor.torque import drive_train

router = APIRouter(prefix="/motor", tags=["motor"], route_class=JsonRoute)


@router.post("/map", status_code=202)
async def begin_map(request: MapPayload, connection: Request, jobs: JobRegistry) -> JsonResponse[StartedAnswer]:
    """Begin to play the design's move with other accelerations, and other speeds, loads or voltages, as a job.

    The same question asked again has a job of its own, and is computed once: as long as its answer is kept, that is
    there at once.
    """
    drive_train(request.design)
    job = jobs.start("motor_map", _told_apart_by(request), partial(_map, request))
    place = str(connection.app.url_path_for("job", job_id=job.id))
    return JsonResponse(StartedAnswer(id=job.id), 202, {"location": place})


def _told_apart_by(request: MapPayload) -> bytes:
    """Return what tells a question apart: all of it but the design's name."""
    asked = request.model_dump(by_alias=True)
    del asked["design"]["name"]
    return json_bytes(asked)


def _map(request: MapPayload, computation: Computation) -> None:
    ranges = request.range, request.accelerations_steps_per_s2
    question = question_of(request.design, request.over, *ranges, request.cells)
    with executor() as spread:
        own = own_verdict(question, computation.is_wanted)
        task = partial(verdict_at, question)
        for picture in stall_map(request.cells, lambda points: spread.results(task, points, computation.is_wanted)):
            computation.tell(picture.progress, StallMapAnswer.of(question, own, picture))
