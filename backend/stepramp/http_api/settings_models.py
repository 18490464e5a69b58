"""What the routes of the settings take and answer: what the families say."""

from functools import reduce
from operator import or_
from typing import Any

from pydantic import ConfigDict, GetJsonSchemaHandler
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema

from stepramp.controllers.families import FAMILIES
from stepramp.validation import Document

MODELS = [family.settings for family in FAMILIES.values() if family.settings is not None]
"""What the settings of any device are a document of."""
ANSWERED: Any = reduce(or_, MODELS)


class AnySettings(Document):
    """Settings before it is known of which family."""

    model_config = ConfigDict(extra="allow")

    @classmethod
    def __get_pydantic_json_schema__(cls, _: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        return {"anyOf": [handler(model.__pydantic_core_schema__) for model in MODELS]}
