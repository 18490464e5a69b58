"""StepRamp's API from Python: `Client` waits for its answers, those of `AsyncClient` are awaited."""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from stepramp.client.clients import AsyncClient, Client

__all__ = ["AsyncClient", "Client"]


def __getattr__(name: str) -> Any:
    """Load the clients when they are first asked for: a stop does without them."""
    if name in __all__:
        from stepramp.client import clients  # noqa: PLC0415  # loading it here is the purpose

        return getattr(clients, name)
    raise AttributeError(f"module 'stepramp.client' has no attribute {name!r}")
