"""What may stand in a document: ranges and choices that say so themselves when a value is refused."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NoReturn, Self, get_args

from pydantic import BaseModel, ConfigDict, GetCoreSchemaHandler, ValidationError, ValidatorFunctionWrapHandler
from pydantic_core import CoreSchema, ErrorDetails, PydanticCustomError, core_schema

from stepramp.errors import Rejected, Rejection


class Document(BaseModel):
    """A part of a document: unknown fields are errors, and nothing changes once it is valid."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    @classmethod
    def checked(cls, document: object) -> Self:
        """Return the document as an instance.

        Raises Rejected with one Rejection for each value that can't be used.
        """
        try:
            return cls.model_validate(document)
        except ValidationError as error:
            raise Rejected(rejections(error.errors())) from error


def refuse(field: str, value: object, allowed: str) -> NoReturn:
    """Refuse a value from within a validator; field is its path below the model that is validated."""
    raise PydanticCustomError("refused", "allowed: {allowed}", {"field": field, "value": value, "allowed": allowed})


class _Allowance:
    """Base of annotations that replace pydantic's message by one that says what is allowed."""

    allowed: str

    def _guard(self, schema: CoreSchema) -> CoreSchema:
        def check(value: object, validate: ValidatorFunctionWrapHandler) -> Any:
            try:
                return validate(value)
            except ValidationError:
                raise PydanticCustomError("refused", "allowed: {allowed}", {"allowed": self.allowed}) from None

        return core_schema.no_info_wrap_validator_function(check, schema)


class Within(_Allowance):
    """A number from low to high [unit]. Whole when the annotated type is int."""

    def __init__(self, low: float, high: float, unit: str = "") -> None:
        self.low, self.high, self.unit = low, high, unit

    def __get_pydantic_core_schema__(self, source: type, handler: GetCoreSchemaHandler) -> CoreSchema:
        whole = source is int
        kind = "a whole number" if whole else "a number"
        self.allowed = f"{kind} from {self.low:,} to {self.high:,} {self.unit}".rstrip()
        if whole:
            number: CoreSchema = core_schema.no_info_before_validator_function(
                _whole, core_schema.int_schema(strict=True, ge=int(self.low), le=int(self.high))
            )
        else:
            number = core_schema.float_schema(strict=True, allow_inf_nan=False, ge=self.low, le=self.high)
        return self._guard(number)


class OneOf(_Allowance):
    """One of the words of a Literal."""

    def __get_pydantic_core_schema__(self, source: type, handler: GetCoreSchemaHandler) -> CoreSchema:
        self.allowed = ", ".join(get_args(source))
        return self._guard(handler(source))


@dataclass
class ListOf(_Allowance):
    """A list of things described in words, of a given length or any; its items are validated on their own."""

    things: str
    length: int | None = None

    def __get_pydantic_core_schema__(self, source: type, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_before_validator_function(self._check, handler(source))

    def _check(self, value: object) -> object:
        if not isinstance(value, list | tuple) or self.length not in (None, len(value)):
            raise PydanticCustomError("refused", "allowed: {allowed}", {"allowed": f"a list of {self.things}"})
        return value


@dataclass
class Text(_Allowance):
    """A text of up to `longest` characters."""

    longest: int

    def __get_pydantic_core_schema__(self, source: type, handler: GetCoreSchemaHandler) -> CoreSchema:
        self.allowed = f"a text of up to {self.longest} characters"
        return self._guard(core_schema.str_schema(strict=True, max_length=self.longest))


def _whole(value: object) -> object:
    """Let 2e6 pass where a whole number is asked for: JSON does not tell it from 2000000."""
    return int(value) if isinstance(value, float) and value.is_integer() else value


def rejections(errors: Sequence[ErrorDetails], skip: int = 0) -> list[Rejection]:
    """Return pydantic's errors as rejections; the first `skip` parts of each location are left out."""
    return [_rejection(error, skip) for error in errors]


def _rejection(error: ErrorDetails, skip: int) -> Rejection:
    context = error.get("ctx", {})
    path = [str(part) for part in error["loc"][skip:]]
    value = context.get("value", error["input"])
    if "field" in context:
        path.append(str(context["field"]))
    match error["type"]:
        case "refused":
            allowed = str(context["allowed"])
        case "missing":
            value, allowed = None, "a value; this field is required"
        case "extra_forbidden":
            allowed = "nothing; there is no such field"
        case "model_type" | "dict_type" | "model_attributes_type":
            allowed = "an object with named fields"
        case _:
            allowed = error["msg"]
    return Rejection(".".join(path) or "document", value, allowed)
