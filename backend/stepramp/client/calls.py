"""What a client sends, before it is sent: a Call for one request, a Script for several with pauses between them.

Each is written once, and sent by the client that waits as by the one that awaits: `Asked` and `Scripted` make methods
of both of them.
"""

from abc import ABC, abstractmethod
from collections.abc import Awaitable, Callable, Generator, Mapping
from dataclasses import dataclass, field
from functools import update_wrapper
from typing import Any, Generic, ParamSpec, TypeVar, overload

from stepramp.http_api.answer import Answer
from stepramp.validation import Document

A = TypeVar("A")
P = ParamSpec("P")
M = TypeVar("M", bound=Answer)

QUICK_S = 20.0
"""So long an answer may take that takes no work: a device's port may be busy with a request that is repeated [s]."""
CONNECTING_S = 45.0
PLANNING_S = 150.0
"""The longest plans wait 30 s for those of others."""
PUSHING_S = 300.0
"""Of a ramp of the most segments, over a slow line [s]."""


@dataclass(frozen=True)
class Call(Generic[A]):
    """One request, and how its answer is read."""

    method: str
    path: str
    """Below /api/v1, with what stands in it already quoted."""
    read: Callable[[bytes], A]
    body: bytes | None = None
    content_type: str = "application/json"
    headers: Mapping[str, str] = field(default_factory=dict)
    parameters: Mapping[str, str] = field(default_factory=dict)
    patience_s: float = QUICK_S
    """So long each part of the answer is waited for [s]."""


@dataclass(frozen=True)
class Pause:
    """So long nothing is asked [s]."""

    pause_s: float


Script = Generator[Call[Any] | Pause, Any, A]
"""Yields calls, is sent their answers, and returns what came of them."""


def payload(model: type[Document], **fields: object) -> bytes:
    """Return the body of a request; what is None is left out. Raises Rejected as the server would."""
    given = {
        name: dict(value) if isinstance(value, Mapping) else value
        for name, value in fields.items()
        if value is not None
    }
    return model.checked(given).model_dump_json(by_alias=True).encode()


def get(path: str, answer: type[M], patience_s: float = QUICK_S) -> Call[M]:
    """Return the call that reads something."""
    return Call("GET", path, answer.model_validate_json, patience_s=patience_s)


def post(
    path: str,
    answer: type[M],
    body: bytes | None = None,
    *,
    patience_s: float = QUICK_S,
    headers: Mapping[str, str] | None = None,
) -> Call[M]:
    """Return the call that asks for something to be done or computed."""
    return Call("POST", path, answer.model_validate_json, body, headers=headers or {}, patience_s=patience_s)


class Blocking(ABC):
    """A client whose methods wait."""

    @abstractmethod
    def send(self, call: Call[A]) -> A:
        """Send a call; return what it is answered."""

    @abstractmethod
    def play(self, script: Script[A]) -> A:
        """Send the calls of a script, and return what came of them."""


class Awaiting(ABC):
    """A client whose methods are awaited."""

    @abstractmethod
    async def send(self, call: Call[A]) -> A:
        """Send a call; return what it is answered."""

    @abstractmethod
    async def play(self, script: Script[A]) -> A:
        """Send the calls of a script, and return what came of them."""


class Asked(Generic[P, A]):
    """A method of both clients that sends what a function makes."""

    def __init__(self, make: Callable[P, Call[A]]) -> None:
        self._make = make
        self.__doc__ = make.__doc__

    @overload
    def __get__(self, client: None, owner: type) -> "Asked[P, A]": ...
    @overload
    def __get__(self, client: Blocking, owner: type) -> Callable[P, A]: ...
    @overload
    def __get__(self, client: Awaiting, owner: type) -> Callable[P, Awaitable[A]]: ...
    def __get__(self, client: Blocking | Awaiting | None, owner: type) -> Any:
        """Return the method of a client."""
        return self if client is None else _method(client, self._make, client.send)


class Scripted(Generic[P, A]):
    """A method of both clients that plays what a function makes."""

    def __init__(self, make: Callable[P, Script[A]]) -> None:
        self._make = make
        self.__doc__ = make.__doc__

    @overload
    def __get__(self, client: None, owner: type) -> "Scripted[P, A]": ...
    @overload
    def __get__(self, client: Blocking, owner: type) -> Callable[P, A]: ...
    @overload
    def __get__(self, client: Awaiting, owner: type) -> Callable[P, Awaitable[A]]: ...
    def __get__(self, client: Blocking | Awaiting | None, owner: type) -> Any:
        """Return the method of a client."""
        return self if client is None else _method(client, self._make, client.play)


def _method(client: Blocking | Awaiting, make: Callable[P, Any], carry_out: Callable[[Any], Any]) -> Callable[P, Any]:
    """Return a method of a client that carries out what a function makes."""
    if isinstance(client, Blocking):

        def blocking(*arguments: P.args, **options: P.kwargs) -> Any:
            return carry_out(make(*arguments, **options))

        return update_wrapper(blocking, make)

    # What can't be sent is refused as it is awaited, too: several may be gathered.
    async def awaited(*arguments: P.args, **options: P.kwargs) -> Any:
        return await carry_out(make(*arguments, **options))

    return update_wrapper(awaited, make)
