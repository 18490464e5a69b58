"""The route that makes designs of the text that a controller tells its settings as."""

from fastapi import APIRouter

from stepramp.errors import Rejected, Rejection
from stepramp.http_api.bodies import JsonRoute
from stepramp.http_api.device_registry import Registry
from stepramp.http_api.imports_models import ImportAnswer, ImportPayload
from stepramp.http_api.lanes import PLANNING

router = APIRouter(tags=["planning"], route_class=JsonRoute)


@router.post("/import")
@PLANNING.serves
def designs_of_text(request: ImportPayload, devices: Registry) -> ImportAnswer:
    """Return designs of what a controller lists of itself, as grbl after `$$`: one for each of its axes."""
    families = [each for each in devices.families.values() if each.read_settings is not None]
    for family in families:
        if family.read_settings is not None and (axes := family.read_settings(request.text, request.base)):
            return ImportAnswer.model_validate({"family": family.name, "axes": axes})
    known = ", ".join(family.title for family in families)
    raise Rejected(
        [Rejection("text", request.text, f"the settings of a controller of a family that is known: {known}")]
    )
