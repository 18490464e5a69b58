"""Routes over the settings of attached controllers. Which there are is the affair of a controller's family."""

from fastapi import APIRouter
from starlette.responses import Response

from stepramp.errors import Rejected
from stepramp.http_api.bodies import JsonRoute
from stepramp.http_api.device_registry import Acting, Registry
from stepramp.http_api.errors import error_response
from stepramp.http_api.lanes import ACTING
from stepramp.http_api.settings_models import ANSWERED, AnySettings
from stepramp.validation import Document

router = APIRouter(route_class=JsonRoute)


@router.get("/devices/{device_id}/settings", response_model=ANSWERED)
@ACTING.serves
def settings(device_id: str, devices: Registry) -> Document:
    """Return the settings in use."""
    return devices.get(device_id).settings()


@router.put("/devices/{device_id}/settings", response_model=ANSWERED)
@ACTING.serves
def use_settings(request: AnySettings, device: Acting) -> Document | Response:
    """Use other settings, what isn't given being the default; they are on trial until they are kept.

    Those of inputs stay as they are when they aren't given, or null: nobody loses an emergency stop who doesn't know of
    it. For a controller without inputs they are refused unless they are null, as it answers them.
    """
    try:
        device.use_settings(device.settings_model.checked(request.model_extra))
    except Rejected as error:
        return error_response(error)  # Whatever the fields are called, they are none of a design.
    return device.settings()
