"""Answers: models that describe them, are filled from what they tell of, and are written as they are."""

from typing import Annotated, Any

import numpy as np
from pydantic import BaseModel, ConfigDict, GetCoreSchemaHandler, ValidatorFunctionWrapHandler
from pydantic_core import CoreSchema, core_schema


class Answer(BaseModel):
    """Base of the answers: filled from objects with the same fields. A field with a default is left out without one."""

    model_config = ConfigDict(from_attributes=True)

    @property
    def content(self) -> dict[str, Any]:
        """Its fields by name, but for those that are left out."""
        fields, given = vars(self), self.model_fields_set
        return fields if len(given) == len(fields) else {name: fields[name] for name in fields if name in given}


class _Column:
    """A list, or an array in its place, which is taken as it is: its numbers are not looked at one by one."""

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_wrap_validator_function(_taken, handler(source))


def _taken(value: object, validate: ValidatorFunctionWrapHandler) -> object:
    return value if isinstance(value, np.ndarray) else validate(value)


WholeNumbers = Annotated[list[int], _Column()]
"""A column of whole numbers: an array of shape (n,)."""
WholeNumberRows = Annotated[list[list[int]], _Column()]
"""Rows of whole numbers: an array of shape (n, m)."""
Numbers = Annotated[list[float], _Column()]
"""A column of numbers: an array of shape (n,)."""
NumbersOrNull = Annotated[list[float | None], _Column()]
"""The same with null where there is none: NaN in the array."""
