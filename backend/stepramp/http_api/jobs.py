"""Routes about jobs, whatever they compute: how far they are, and their end."""

from fastapi import APIRouter

from stepramp.http_api.bodies import JsonRoute
from stepramp.http_api.device_registry import JobRegistry
from stepramp.http_api.error_items import ErrorList
from stepramp.http_api.jobs_models import JobAnswer
from stepramp.http_api.json_response import JsonResponse

router = APIRouter(
    prefix="/jobs",
    tags=["jobs"],
    route_class=JsonRoute,
    responses={404: {"model": ErrorList, "description": "There is no such job, or none any more"}},
)


@router.get("/{job_id}")
async def job(job_id: str, jobs: JobRegistry) -> JsonResponse[JobAnswer]:
    """Tell how far a job is, and what is known so far."""
    return JsonResponse(JobAnswer.of(jobs.get(job_id)))


@router.delete("/{job_id}")
async def cancel(job_id: str, jobs: JobRegistry) -> JsonResponse[JobAnswer]:
    """End a job that waits or runs; one that has ended stays as it is. What is known so far is kept.

    Others that ask the same have jobs of their own, which go on.
    """
    cancelled = jobs.get(job_id)
    cancelled.cancel()
    return JsonResponse(JobAnswer.of(cancelled))
