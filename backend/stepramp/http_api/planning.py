"""Routes that plan: a design in, profiles and errors out. They keep nothing."""

from fastapi import APIRouter

from stepramp.examples import all_examples
from stepramp.http_api.bodies import JsonRoute
from stepramp.http_api.formats import IN_ANY_FORMAT, AnyFormat
from stepramp.http_api.lanes import planning_lane, profile_turns
from stepramp.http_api.planned import Planned
from stepramp.http_api.planning_models import (
    ErrorsAnswer,
    ErrorsPayload,
    ExamplesAnswer,
    HealthAnswer,
    ProfileAnswer,
    ProfilePayload,
)
from stepramp.ramp.error_curves import all_error_curves
from stepramp.ramp.plan import tuning_report
from stepramp.ramp.profile import profile_of
from stepramp.version import __version__

router = APIRouter(tags=["planning"], route_class=JsonRoute)


@router.post("/profile", responses=IN_ANY_FORMAT)
async def profile(request: ProfilePayload, as_wanted: AnyFormat) -> Planned[ProfileAnswer]:
    """Plan a design's move: intervals, times, positions and speeds of its steps, its phases, and a summary.

    `Accept: text/csv` or `application/x-npz` asks for the columns only.
    """
    design = request.design
    turns = profile_turns(design, request.max_points)
    return Planned(turns, lambda: ProfileAnswer.of(profile_of(design), tuning_report(design), request), as_wanted)


@router.post("/errors", responses=IN_ANY_FORMAT)
async def errors(request: ErrorsPayload, as_wanted: AnyFormat) -> Planned[ErrorsAnswer]:
    """Compare methods with a reference, step by step: relative error and error in ticks of each interval.

    `Accept: text/csv` or `application/x-npz` asks for the columns only, with the method's name before them.
    """
    lane = planning_lane([request.design], len(request.methods), request.max_points)
    return Planned(lane, lambda: _errors(request), as_wanted)


@router.get("/examples", response_model_exclude_unset=True)
async def example_designs() -> ExamplesAnswer:
    """Return designs to start from."""
    return ExamplesAnswer.model_validate({"examples": all_examples()})


@router.get("/health")
async def health() -> HealthAnswer:
    """Tell that the server works."""
    return HealthAnswer(status="ok", version=__version__)


def _errors(request: ErrorsPayload) -> ErrorsAnswer:
    judged = all_error_curves(request.design, request.methods, request.reference, request.segment_bound_ticks)
    return ErrorsAnswer.of(judged, request)
