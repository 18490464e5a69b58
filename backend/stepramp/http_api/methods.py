"""The route that tells what methods there are: the page's list, and that of any other program."""

from fastapi import APIRouter

from stepramp.http_api.bodies import JsonRoute
from stepramp.http_api.methods_models import MethodsAnswer

router = APIRouter(tags=["planning"], route_class=JsonRoute)


@router.get("/methods")
async def methods() -> MethodsAnswer:
    """Return the methods that a ramp can be computed by."""
    return MethodsAnswer.of_all()
