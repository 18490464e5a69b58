"""Everything StepRamp raises on purpose.

StepRampError
├── Rejected            values from outside that can't be used; carries one Rejection a value
├── NotFound            no such device, port or page
├── Refused             understood, but not now (a device that moves takes no ramp)
├── Forbidden           a request from a page or a host that isn't ours, or of who may only look on
├── Unauthorized        somebody who isn't known
├── TooOften            one client asks for more than its share
├── Overloaded          too much is asked for at the same time
├── DeviceLost          the device doesn't answer, or its port is gone
└── NoServer            to programs: no StepRamp answers there
"""

import json
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal, Self

MOST_TOLD = 20
"""So many rejections are told one by one, and so many items of a value that is told back."""
LONGEST_TOLD = 200
"""Length of the longest text that is told back whole [characters]."""
DEEPEST_TOLD = 3
"""How deep lists and objects that are told back may be nested."""


class Count(str):
    """How many of something there are, in words: told in place of all of them, and no text that anybody wrote."""


class StepRampError(Exception):
    """The root of the tree; its text is one sentence for people."""


@dataclass(frozen=True)
class Limits:
    """From where to where a number may lie, or how long a text or a list may be; None where there is no end."""

    lowest: float | None = None
    highest: float | None = None
    unit: str = ""
    is_whole: bool = False
    note: str = ""
    """How a sentence goes on that ends with them: why they hold, or what is allowed besides."""

    @property
    def words(self) -> str:
        """What is allowed of a number."""
        if self.lowest is not None and self.lowest == self.highest:
            ends = f"only {_figure(self.lowest)}"
        elif self.lowest is not None and self.highest is not None:
            kind = "a whole number" if self.is_whole else "a number"
            ends = f"{kind} from {_figure(self.lowest)} to {_figure(self.highest)}"
        elif self.lowest is not None:
            ends = f"at least {_figure(self.lowest)}"
        else:
            ends = "any" if self.highest is None else f"at most {_figure(self.highest)}"
        return f"{ends} {self.unit}".rstrip() + self.note


StepUnit = Literal["steps", "steps/s", "steps/s²", "steps/s³"]


@dataclass(frozen=True)
class Told:
    """A quantity as it stands in a message, and as data: whoever shows other units puts it there in them."""

    text: str
    """With its unit, where that follows at once."""
    value: float
    unit: StepUnit
    rounding: Literal["nearest", "down", "up"] = "nearest"
    """To which side it is rounded: a limit so that what is told is allowed."""
    axis: int | None = None
    """The axis that it is of, counted from 0, where that is not the one that the message is about."""

    @classmethod
    def of(
        cls, value: float, unit: StepUnit, figures: int = 6, rounding: Literal["nearest", "down", "up"] = "nearest"
    ) -> Self:
        """Return a quantity told with so many figures."""
        return cls(f"{value:,.{figures}g} {unit}", value, unit, rounding)

    def __str__(self) -> str:
        return self.text


@dataclass(frozen=True)
class Change:
    """A value that would be accepted in place of another."""

    field: str
    value: object


@dataclass(frozen=True)
class Choices:
    """What is allowed while another field has its value: some names, or something that is needed."""

    names: tuple[str, ...]
    """Of a need the one thing, in words."""
    because: Change
    """The other field and its value."""
    is_need: bool = False

    @classmethod
    def needed(cls, what: str, field: str, value: str) -> Self:
        """Return that something has to be there, since a field has its value."""
        return cls((what,), Change(field, value), is_need=True)

    @property
    def words(self) -> str:
        """What is allowed."""
        names, field, value = ", ".join(self.names), self.because.field, self.because.value
        return f"{names}, since {field} is '{value}'" if self.is_need else f"{names} with {field} '{value}'"


@dataclass(frozen=True)
class Remedy:
    """Changes that together make what was refused acceptable, and what people call them."""

    text: str
    changes: tuple[Change, ...]
    told: tuple[Told, ...] = ()
    """The quantities of the text that a design's axis converts, in their order."""


@dataclass(frozen=True)
class Rejection:
    """One value that can't be used: which field, what it was, and what is allowed; what else is known of it as data."""

    field: str
    value: object
    allowed: str
    limits: Limits | None = None
    remedies: tuple[Remedy, ...] = ()
    reason: str = ""
    """Why, as a sentence without the field, where more than the value is wrong."""
    is_null: bool = False
    """Whether None was given as the value; otherwise None says that there is none."""
    told: tuple[Told, ...] = ()
    """The quantities of the reason, or else of what is allowed, in their order."""
    choices: Choices | None = None
    """What is allowed, where that is names."""

    @classmethod
    def outside(cls, field: str, value: object, limits: Limits) -> Self:
        """Return the rejection of a number outside of limits."""
        return cls(field, value, limits.words, limits)

    @classmethod
    def of_choices(cls, field: str, value: object, choices: Choices) -> Self:
        """Return the rejection of a name that is not among those that another field's value leaves."""
        return cls(field, value, choices.words, choices=choices)

    def within(self, place: str) -> Self:
        """Return the same with the paths of its fields below a place, such as "axes.0."."""
        remedies = tuple(
            replace(each, changes=tuple(Change(place + change.field, change.value) for change in each.changes))
            for each in self.remedies
        )
        choices = self.choices and replace(
            self.choices, because=replace(self.choices.because, field=place + self.choices.because.field)
        )
        return replace(self, field=place + self.field, remedies=remedies, choices=choices)

    @property
    def message(self) -> str:
        """The rejection as one sentence."""
        return (
            self.reason or f"{self.field} is {'null' if self.is_null else shown(self.value)}; allowed: {self.allowed}."
        )


class Rejected(StepRampError, ValueError):
    """One or more values can't be used; nothing was done.

    more: how many there are besides; of the rejections only the first MOST_TOLD are kept, the others are counted.
    """

    def __init__(self, rejections: Sequence[Rejection], more: int = 0) -> None:
        self.rejections = tuple(rejections[:MOST_TOLD])
        self.more = more + len(rejections) - len(self.rejections)
        sentences = [rejection.message for rejection in self.rejections]
        super().__init__("\n".join([*sentences, self.more_message] if self.more else sentences))

    @property
    def more_message(self) -> str:
        """How many there are besides, as a sentence."""
        return f"{self.more:,} more values can't be used." if self.more > 1 else "One more value can't be used."


class NotAcceptable(Rejected):
    """The answer can't be sent in any of the forms that are taken."""


class UnsupportedMediaType(Rejected):
    """A body isn't in a form that is taken."""


class NotFound(StepRampError, LookupError):
    """What was asked for does not exist."""


class Refused(StepRampError):
    """The request is sound, but can't be done in the present state.

    field, value, allowed: of what in the request that is said, where it is of one thing, such as one of several axes.
    """

    def __init__(
        self, message: str = "", field: str | None = None, value: object = None, allowed: str | None = None
    ) -> None:
        super().__init__(message)
        self.field, self.value, self.allowed = field, value, allowed


class Rescaled(Refused):
    """Lengths are other numbers of steps by now. Refused once: whoever asks again is taken to know it."""


class Forbidden(StepRampError):
    """The request comes from a page or a host that may not control this server."""


class Overloaded(StepRampError):
    """Too much is asked for at the same time; later it can be done."""


class Outdated(StepRampError):
    """A change was made on a version that isn't the newest any more; nothing was changed."""


class Unavailable(StepRampError):
    """Something outside of the program, such as a database, can't be used now; later it may be."""


class Unauthorized(StepRampError):
    """Somebody who isn't known, where one has to be."""


class TooOften(StepRampError):
    """One client asks for more than its share."""


class DeviceLost(StepRampError):
    """The device doesn't answer, or its port is gone."""


class NoServer(StepRampError):
    """No StepRamp answers where one was asked."""


def shown(value: object) -> str:
    """Return a value as it stands in a message: short, on one line; all but texts as in JSON."""
    told = brief(value)
    if isinstance(told, bool | list | dict):
        text = json.dumps(told, ensure_ascii=False)
    elif isinstance(value, str):
        text = value if isinstance(value, Count) else repr(told)
    else:
        text = "missing" if value is None else str(told)
    text = " ".join(text.split())
    return text if len(text) <= 80 else text[:77] + "…"


def brief(value: object) -> object:
    """Return a value as it is told back: as it was given if it is short, and always something that JSON can carry.

    Long texts end early, long or deep lists and objects become words, and so do NaN, infinities and numbers of more
    than 64 bits.
    """
    told = _brief(value, DEEPEST_TOLD)
    return _in_words(value) if isinstance(told, list | dict) and len(str(told)) > 2 * LONGEST_TOLD else told


def escaped(text: str) -> str:
    """Return text with a backslash and a number in place of each half of a surrogate pair, which no UTF-8 can carry."""
    return text.encode("utf-8", "backslashreplace").decode()


def _figure(limit: float) -> str:
    return f"{int(limit):,}" if float(limit).is_integer() else f"{limit:,.15g}"


def _brief(value: object, depth: int) -> object:
    if value is None or isinstance(value, bool):
        return value
    if isinstance(value, int):
        return value if abs(value) < 2**63 else _cut(hex(value) if value.bit_length() > 14_000 else str(value))
    if isinstance(value, float):
        return value if math.isfinite(value) else _cut(str(value))
    if isinstance(value, list | tuple):
        few = depth > 0 and len(value) <= MOST_TOLD
        return [_brief(each, depth - 1) for each in value] if few else _in_words(value)
    if isinstance(value, dict):
        few = depth > 0 and len(value) <= MOST_TOLD
        named = {_cut(str(name)): each for name, each in value.items()} if few else {}
        return {name: _brief(each, depth - 1) for name, each in named.items()} if few else _in_words(value)
    return _cut(value if isinstance(value, str) else repr(value))


def _cut(text: str) -> str:
    if len(text) > LONGEST_TOLD:
        return f"{escaped(text[:LONGEST_TOLD])}… ({len(text):,} characters)"
    return escaped(text)


def _in_words(value: object) -> str:
    if isinstance(value, dict):
        return f"an object of {len(value):,} fields"
    return f"a list of {len(value):,} items" if isinstance(value, list | tuple) else "a value"
