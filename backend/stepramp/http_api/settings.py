"""Routes over the settings of attached controllers. Which there are is the affair of a controller's family."""

from functools import reduce
from operator import or_
from typing import Any

from fastapi import APIRouter
from pydantic import ConfigDict, GetJsonSchemaHandler, model_validator
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema
from starlette.responses import Response

from stepramp.controllers.families import FAMILIES
from stepramp.errors import Rejected
from stepramp.http_api.bodies import JsonRoute
from stepramp.http_api.device_registry import Acting, Registry
from stepramp.http_api.errors import error_response
from stepramp.http_api.lanes import ACTING
from stepramp.validation import Document

MODELS = [family.settings for family in FAMILIES.values() if family.settings is not None]
"""What the settings of any device are a document of."""
ANSWERED: Any = reduce(or_, MODELS)
router = APIRouter(route_class=JsonRoute)


class AnySettings(Document):
    """Settings before it is known of which family."""

    model_config = ConfigDict(extra="allow")

    @model_validator(mode="before")
    @classmethod
    def _few_unknown_fields(cls, document: object) -> object:
        return document  # All are, until it is known.

    @classmethod
    def __get_pydantic_json_schema__(cls, _: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        return {"anyOf": [handler(model.__pydantic_core_schema__) for model in MODELS]}


@router.get("/devices/{device_id}/settings", response_model=ANSWERED)
@ACTING.serves
def settings(device_id: str, devices: Registry) -> Document:
    """Return the settings in use."""
    return devices.get(device_id).settings()


@router.put("/devices/{device_id}/settings", response_model=ANSWERED)
@ACTING.serves
def use_settings(request: AnySettings, device: Acting) -> Document | Response:
    """Use other settings, what isn't given being the default; they are on trial until they are kept."""
    model = device.settings_model
    try:
        wanted = model.checked(request.model_extra)
    except Rejected as error:
        return error_response(error)  # Whatever the fields are called, they are none of a design.
    device.use_settings(wanted)
    return device.settings()
