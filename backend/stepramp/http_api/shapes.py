"""The route that tells what shapes of ramps there are: the page's list, and that of any other program."""

from fastapi import APIRouter

from stepramp.http_api.bodies import JsonRoute
from stepramp.http_api.shapes_models import ShapesAnswer

router = APIRouter(tags=["planning"], route_class=JsonRoute)


@router.get("/shapes")
async def shapes() -> ShapesAnswer:
    """List the shapes of ramps, what each is good for, and which fields and methods it has."""
    return ShapesAnswer.of_all()
