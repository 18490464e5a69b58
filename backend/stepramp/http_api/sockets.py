"""What the routes share that talk over WebSockets."""

import logging
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager, suppress

from starlette.types import Message
from starlette.websockets import WebSocket, WebSocketDisconnect

from stepramp.errors import Rejected, Rejection, StepRampError
from stepramp.http_api.answered import AT_LAST
from stepramp.http_api.bodies import refuse_repeated
from stepramp.http_api.error_items import ErrorList, error_items
from stepramp.http_api.json_response import json_bytes
from stepramp.json_text import parsed_json

REFUSED = 1008
"""What a socket is closed with that isn't served, after it was told why."""
MISTAKE = 1011
"""What a socket is closed with after a mistake of ours."""

log = logging.getLogger(__name__)


@asynccontextmanager
async def served(socket: WebSocket) -> AsyncIterator[None]:
    """Serve a socket until the other end has gone.

    What is refused is told as an object with `errors`, and the socket is closed with 1008; a mistake of ours is logged,
    and it is closed with 1011.
    """
    try:
        try:
            yield
        except StepRampError as error:
            await tell_error(socket, error)
            await socket.close(REFUSED)
    except WebSocketDisconnect:
        log.debug("The other end of %s has gone.", socket.url.path)
    except Exception:
        log.exception("A mistake ends the WebSocket %s.", socket.url.path)
        with suppress(WebSocketDisconnect, RuntimeError):  # It has gone, too.
            await socket.close(MISTAKE, "StepRamp made a mistake. It is logged.")


async def accept(socket: WebSocket) -> None:
    """Accept a socket.

    Raises WebSocketDisconnect when the other end has gone before, Rejected when its parameter is given more than once.
    """
    try:
        await socket.accept()
    except OSError as error:
        # So the server calls it. Of a socket that is accepted Starlette says it in its own way.
        raise WebSocketDisconnect(1006, str(error)) from error
    # Only now: of a socket that isn't accepted a browser shows no refusal.
    refuse_repeated(socket.query_params, ["page"])


async def received(socket: WebSocket) -> str | bytes:
    """Return the next message, text or binary; WebSocketDisconnect when the other end has gone."""
    message = await socket.receive()
    if message["type"] == "websocket.disconnect":
        raise WebSocketDisconnect(message.get("code", 1005), message.get("reason"))
    text: str | None = message.get("text")
    return message["bytes"] if text is None else text


async def tell_error(socket: WebSocket, error: StepRampError) -> None:
    """Send what was refused, as routes answer it."""
    await send(socket, json_bytes(ErrorList(errors=error_items(error))).decode())


async def send(socket: WebSocket, text: str) -> None:
    """Send a text; WebSocketDisconnect when the other end has gone."""
    await _sent(socket, {"type": "websocket.send", "text": text})


async def send_at_last(socket: WebSocket, made: Callable[[], str]) -> None:
    """Send a text that is made in the server's loop in the instant at which it is written; else as send."""
    await _sent(socket, {"type": "websocket.send", AT_LAST: made})


async def _sent(socket: WebSocket, message: Message) -> None:
    try:
        await socket.send(message)
    except RuntimeError as error:
        # So Starlette and the server call it when the socket is closed already: which of them depends on who noticed
        # first. Nothing else happens in this call.
        raise WebSocketDisconnect(1006, str(error)) from error


def parsed(message: str | bytes, allowed: str) -> object:
    """Return a message's JSON.

    Raises Rejected when it is none.
    """
    if isinstance(message, bytes):
        raise Rejected([Rejection("message", f"{len(message):,} bytes", f"{allowed}, as text")])
    try:
        return parsed_json(message)
    except Rejected:
        raise
    except ValueError:
        raise Rejected([Rejection("message", message, allowed)]) from None
