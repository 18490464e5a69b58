"""The route that tells who asks what they may do."""

from fastapi import APIRouter
from pydantic import Field
from starlette.requests import Request

from stepramp.http_api.access import Role
from stepramp.http_api.answer import Answer
from stepramp.http_api.sign_in import client_of

router = APIRouter(tags=["access"])


class AccessAnswer(Answer):
    """What somebody may do."""

    role: Role = Field(description="view: see everything, compute and stop. operate: also connect, push and move")
    is_shared: bool = Field(description="Whether other machines may use the server, too, by a token")
    place: str | None = Field(description="Address that whoever asks has; null for a server of its own machine only")


@router.get("/access")
async def access(request: Request) -> AccessAnswer:
    """Return what whoever asks may do. On a server of its own machine only that is everything."""
    client = client_of(request.scope)
    if client is None:
        return AccessAnswer(role=Role.OPERATE, is_shared=False, place=None)
    return AccessAnswer(role=client.role, is_shared=True, place=client.place)
