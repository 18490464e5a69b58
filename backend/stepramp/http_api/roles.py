"""The route that tells who asks what they may do."""

from fastapi import APIRouter
from starlette.requests import Request

from stepramp.http_api.access import Role
from stepramp.http_api.roles_models import AccessAnswer
from stepramp.http_api.sign_in import client_of

router = APIRouter(tags=["access"])


@router.get("/access")
async def access(request: Request) -> AccessAnswer:
    """Return what whoever asks may do. On a server of its own machine only that is everything."""
    client = client_of(request.scope)
    if client is None:
        return AccessAnswer(role=Role.OPERATE, is_shared=False, place=None)
    return AccessAnswer(role=client.role, is_shared=True, place=client.place)
