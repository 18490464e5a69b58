"""What may stand in a document: ranges and choices that say so themselves when a value is refused."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import Any, NoReturn, Self

from pydantic import (
    BaseModel,
    ConfigDict,
    GetCoreSchemaHandler,
    GetJsonSchemaHandler,
    ModelWrapValidatorHandler,
    ValidationError,
    ValidatorFunctionWrapHandler,
    model_validator,
)
from pydantic.fields import FieldInfo
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, ErrorDetails, InitErrorDetails, PydanticCustomError, core_schema

from stepramp.errors import MOST_TOLD, Choices, Count, Limits, Rejected, Rejection, Told, escaped

LONGEST_NAME = 100
"""Length of the longest field name that is told whole [characters]."""
LONGEST_TOLD = 1_000
"""Of a longer text it is told how long it is [characters]."""


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
            raise rejected(error.errors(include_url=False)) from error

    @model_validator(mode="before")
    @classmethod
    def _unknown_fields(cls, document: object) -> object:
        """Have unknown fields say which ones there are; count the many: an error for each of 100,000 takes a second."""
        if not isinstance(document, dict) or cls.model_config.get("extra") != "forbid":
            return document
        fields = _fields_of(cls)
        if document.keys() <= fields.keys():
            return document
        unknown = [name for name in document if name not in fields]
        known = ", ".join(
            f"{name} (missing)" if field.is_required() and name not in document else name
            for name, field in fields.items()
        )
        told = {name: each for name, each in document.items() if name in fields}
        told |= {name: _Unknown(document[name], known) for name in unknown[:MOST_TOLD]}
        if len(unknown) > MOST_TOLD:
            told[unknown[MOST_TOLD]] = _Untold(len(unknown) - MOST_TOLD)
        return told


@cache
def _fields_of(kind: type[BaseModel]) -> dict[str, FieldInfo]:
    """Return the fields of a document by their names in it."""
    return {field.alias or name: field for name, field in kind.model_fields.items()}


class UnitNamedBy(str):
    """A unit that another field of the document names; as a text, all that it may be."""

    __slots__ = ("field", "units")
    field: str
    units: Mapping[str, str]

    def __new__(cls, field: str, units: Mapping[str, str]) -> Self:
        """Return the unit that a field names. units: what each of the field's values stands for."""
        unit = super().__new__(cls, " or ".join(units.values()))
        unit.field, unit.units = field, units
        return unit


class NamesUnits(Document):
    """A document that says itself which unit some of its numbers are in: so does what is refused of them."""

    @model_validator(mode="wrap")
    @classmethod
    def _in_their_units(cls, document: object, validate: ModelWrapValidatorHandler[Self]) -> Self:
        try:
            return validate(document)
        except ValidationError as error:
            told = [cls._told(each, document) for each in error.errors(include_url=False)]
            raise ValidationError.from_exception_data(error.title, told) from None

    @classmethod
    def _told(cls, error: ErrorDetails, document: object) -> InitErrorDetails:
        context = error.get("ctx", {})
        if error["type"] != "refused":
            return InitErrorDetails(type=error["type"], loc=error["loc"], input=error["input"], ctx=context)
        limits = context.get("limits")
        if limits is not None and isinstance(limits.unit, UnitNamedBy) and isinstance(document, dict):
            named = document.get(limits.unit.field, cls.model_fields[limits.unit.field].default)
            limits = replace(limits, unit=limits.unit.units.get(str(named), str(limits.unit)))
            context = context | {"limits": limits, "allowed": limits.words}
        refusal = PydanticCustomError("refused", "allowed: {allowed}", context)
        return InitErrorDetails(type=refusal, loc=error["loc"], input=error["input"])


@dataclass(frozen=True)
class _Unknown:
    """Stands for the value of an unknown field; known: which fields there are, and which of them are missing."""

    value: object
    known: str


@dataclass(frozen=True)
class _Untold:
    """Stands for unknown fields that are only counted."""

    count: int


def is_none(value: object) -> bool:
    """Tell what is left out of documents, of fields that not all of them have."""
    return value is None


def refuse(field: str, value: object, allowed: str | Limits | Choices, told: tuple[Told, ...] = ()) -> NoReturn:
    """Refuse a value from within a validator; field is its path below what is validated, empty for that itself.

    told: see Rejection.
    """
    limits = allowed if isinstance(allowed, Limits) else None
    words = allowed if isinstance(allowed, str) else allowed.words
    choices = allowed if isinstance(allowed, Choices) else None
    context = {"field": field, "value": value, "allowed": words, "limits": limits, "choices": choices, "told": told}
    raise PydanticCustomError("refused", "allowed: {allowed}", context)


class _Allowance:
    """Base of annotations that replace pydantic's message by one that says what is allowed."""

    allowed: str
    limits: Limits | None

    def _guard(self, schema: CoreSchema) -> CoreSchema:
        def check(value: object, validate: ValidatorFunctionWrapHandler) -> Any:
            try:
                return validate(value)
            except ValidationError:
                raise PydanticCustomError("refused", "allowed: {allowed}", self._context) from None

        return core_schema.no_info_wrap_validator_function(check, schema)

    @property
    def _context(self) -> dict[str, object]:
        return {"allowed": self.allowed, "limits": self.limits}


class Within(_Allowance):
    """A number from low to high [unit]. Whole when the annotated type is int. note: what else is allowed, or isn't."""

    def __init__(self, low: float, high: float, unit: str = "", note: str = "") -> None:
        self.low, self.high, self.unit, self.note = low, high, unit, note

    def __get_pydantic_core_schema__(self, source: type, handler: GetCoreSchemaHandler) -> CoreSchema:
        whole = source is int
        self.limits = Limits(self.low, self.high, self.unit, is_whole=whole, note=self.note)
        self.allowed = self.limits.words
        if whole:
            number: CoreSchema = core_schema.no_info_before_validator_function(
                _whole, core_schema.int_schema(strict=True, ge=int(self.low), le=int(self.high))
            )
        else:
            number = core_schema.float_schema(strict=True, allow_inf_nan=False, ge=self.low, le=self.high)
        return self._guard(number)

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        """Return what pydantic says of the number, and its unit for who shows it."""
        described = handler(schema)
        if isinstance(self.unit, UnitNamedBy):
            return {**described, "x-unit-named-by": self.unit.field}
        return {**described, "x-unit": self.unit} if self.unit else described


class AnyNumber(_Allowance):
    """A number whose limits another field says: but for NaN and infinities, which are none."""

    allowed = "a number"
    limits = None

    def __get_pydantic_core_schema__(self, source: type, handler: GetCoreSchemaHandler) -> CoreSchema:
        return self._guard(core_schema.float_schema(strict=True, allow_inf_nan=False))


class OneOf:
    """One of some words; for a str whose words no Literal can say, since they are registered by being there."""

    def __init__(self, words: Iterable[str]) -> None:
        self.words = list(words)

    def __get_pydantic_core_schema__(self, source: type, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.literal_schema(self.words)


@dataclass(eq=False)
class ListOf(_Allowance):
    """A list of things described in words, of a given length, or of `least` to `most` of them.

    Its length is checked before its items, which are validated on their own.
    """

    things: str
    length: int | None = None
    most: int | None = None
    least: int = 0

    def __post_init__(self) -> None:
        counted = self.most is not None
        self.limits = Limits(self.least, self.most, "items", is_whole=True) if counted else None
        if self.most is None:
            self.allowed = f"a list of {self.things}"
        elif self.least:
            self.allowed = f"a list of {self.least} to {self.most:,} {self.things}"
        else:
            self.allowed = f"a list of up to {self.most:,} {self.things}"

    def __get_pydantic_core_schema__(self, source: type, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_before_validator_function(self._check, handler(source))

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        described = handler(schema)
        if self.most is not None:
            of_list = next(each for each in (described, *described.get("anyOf", ())) if each.get("type") == "array")
            of_list |= {"minItems": self.least, "maxItems": self.most}
        return described

    def _check(self, value: object) -> object:
        context = self._context
        if not isinstance(value, list | tuple) or self.length not in (None, len(value)):
            raise PydanticCustomError("refused", "allowed: {allowed}", context)
        if len(value) < self.least or (self.most is not None and len(value) > self.most):
            raise PydanticCustomError(
                "refused",
                "allowed: {allowed}",
                context | {"value": Count(f"{len(value):,} item{'' if len(value) == 1 else 's'}")},
            )
        return value


class ListOrNull(ListOf):
    """A list of things described in words, or null."""

    def _check(self, value: object) -> object:
        return None if value is None else super()._check(value)


@dataclass
class Text(_Allowance):
    """A text of up to `longest` characters."""

    longest: int

    def __get_pydantic_core_schema__(self, source: type, handler: GetCoreSchemaHandler) -> CoreSchema:
        self.allowed = f"a text of up to {self.longest:,} characters"
        self.limits = Limits(0, self.longest, "characters", is_whole=True)
        return core_schema.no_info_wrap_validator_function(
            self._check, core_schema.str_schema(strict=True, max_length=self.longest)
        )

    def _check(self, value: object, validate: ValidatorFunctionWrapHandler) -> Any:
        try:
            return validate(value)
        except ValidationError:
            is_long = isinstance(value, str) and len(value) > LONGEST_TOLD
            told = {"value": Count(f"{len(str(value)):,} characters")} if is_long else {}
            raise PydanticCustomError("refused", "allowed: {allowed}", self._context | told) from None


def _whole(value: object) -> object:
    """Let 2e6 pass where a whole number is asked for: JSON does not tell it from 2000000."""
    return int(value) if isinstance(value, float) and value.is_integer() else value


def rejected(errors: Sequence[ErrorDetails], skip: int = 0) -> Rejected:
    """Return pydantic's errors as one Rejected; the first `skip` parts of each location are left out.

    A field that is missing where there is an unknown one is told with that: it may be meant by it.
    """
    with_unknown = {error["loc"][:-1] for error in errors if isinstance(error["input"], _Unknown)}
    errors = [error for error in errors if error["type"] != "missing" or error["loc"][:-1] not in with_unknown]
    untold = (error["input"] for error in errors[MOST_TOLD:])
    more = sum(each.count if isinstance(each, _Untold) else 1 for each in untold)
    return Rejected([_rejection(error, skip) for error in errors[:MOST_TOLD]], more)


def _rejection(error: ErrorDetails, skip: int) -> Rejection:
    context = error.get("ctx", {})
    path = list(error["loc"][skip:])
    value = context.get("value", error["input"])
    is_null = value is None and "value" not in context and error["type"] != "missing"
    if context.get("field"):
        path.append(str(context["field"]))
    match error["type"]:
        case "refused":
            allowed = str(context["allowed"])
        case "literal_error":  # Expected are 'a', 'b' or 'c'.
            allowed = str(context["expected"]).replace(" or ", ", ").replace("'", "")
        case "bool_type":
            allowed = "true or false"
        case "string_type":
            allowed = "a text"
        case "missing":
            value, allowed = None, "a value; this field is required"
        case "extra_forbidden":
            value, allowed = value.value, f"nothing; there is no such field, only {value.known}"
        case "model_type" | "dict_type" | "model_attributes_type":
            allowed = "an object with named fields"
        case _:
            allowed = error["msg"]
    limits, choices, told = context.get("limits"), context.get("choices"), context.get("told", ())
    return Rejection(path_in_words(path), value, allowed, limits, is_null=is_null, choices=choices, told=told)


def path_in_words(path: Iterable[int | str]) -> str:
    """Return the path of a field; of no field, that of the document."""
    return ".".join(map(_part, path)) or "document"


def _part(part: int | str) -> str:
    """Return a part of a field's path, short: a name may be anything that the client has made up."""
    name = escaped(str(part))
    return name if len(name) <= LONGEST_NAME else name[:LONGEST_NAME] + "…"
