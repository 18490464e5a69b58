"""What the routes about jobs answer."""

from typing import Literal, Self

from pydantic import Field

from stepramp.http_api.answer import Answer
from stepramp.http_api.error_items import ErrorItem, error_items
from stepramp.http_api.job_registry import Job, State
from stepramp.http_api.stall_map_models import StallMapAnswer


class JobAnswer(Answer):
    """How far a job is."""

    id: str
    kind: Literal["motor_map"] = Field(description="What it computes")
    state: State = Field(
        description="cancelled: by DELETE, at the end of StepRamp, or since nobody had asked about it for 2 minutes"
    )
    progress: float = Field(description="From 0 to 1, as far as can be told; 1 when it is done")
    result: StallMapAnswer | None = Field(description="What is known so far, and all when it is done; null: nothing")
    errors: list[ErrorItem] | None = Field(None, description="Why it failed; left out where it did not")

    @classmethod
    def of(cls, job: Job) -> Self:
        """Return a job as an answer."""
        # In this order: what is told of one that is done is all of it.
        state = job.state
        told: dict[str, object] = {} if job.error is None else {"errors": error_items(job.error)}
        return cls(id=job.id, kind=job.kind, state=state, progress=job.progress, result=job.result, **told)
