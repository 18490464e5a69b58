"""The routes for plots: a design in, everything that is drawn of it out, in one answer. They keep nothing."""

from functools import partial

from fastapi import APIRouter, WebSocket

from stepramp.errors import Rejected, Rejection
from stepramp.http_api.bodies import LARGE_BYTES, JsonRoute
from stepramp.http_api.curves_models import CurvesAnswer, CurvesPayload
from stepramp.http_api.error_items import ErrorList, error_items, in_body
from stepramp.http_api.json_response import json_bytes, json_pieces
from stepramp.http_api.lanes import CHECKING, PlanningTurns, planning_lane
from stepramp.http_api.planned import Planned
from stepramp.http_api.sockets import accept, parsed, received, send, served

router = APIRouter(tags=["planning"], route_class=JsonRoute)

LARGEST_ID = 2**53 - 1
"""A number that every language of the web can hold."""
LONGEST_MESSAGE_BYTES = 2**22
"""A message is sent in one go, for which a stop may have to wait."""


@router.post("/curves")
async def curves(request: CurvesPayload) -> Planned[CurvesAnswer]:
    """Plan a design's move by several methods, thinned for plots, with their errors and figures."""
    return Planned(_lane(request), lambda: CurvesAnswer.of(request.drawing))


@router.websocket("/curves/socket")
async def curves_socket(socket: WebSocket) -> None:
    """Answer the requests of POST /curves, one after the other, each with its answer or an object with `errors`.

    For sliders: in a browser a request of its own takes longer than the curves of a usual move. A request may carry an
    `id`, which its answer then carries too.
    """
    async with served(socket):
        await accept(socket)
        while True:
            message = await received(socket)
            await send(socket, await _answer(message))


async def _answer(message: str | bytes) -> str:
    checked = partial(_checked, message)
    number, request = await CHECKING.run(checked) if len(message) > LARGE_BYTES else checked()
    try:
        if isinstance(request, Rejected):
            raise request
        text = await _lane(request).run(lambda: _message(CurvesAnswer.of(request.drawing), request.max_points))
    except Rejected as error:
        text = json_bytes(ErrorList(errors=error_items(in_body(error)))).decode()
    return text if number is None else f'{{"id":{number},{text[1:]}'


def _checked(message: str | bytes) -> tuple[int | None, CurvesPayload | Rejected]:
    """Return what is asked, or why it can't be, with the id that its answer carries."""
    number: int | None = None
    try:
        document = parsed(message, "a JSON object with a design and methods")
        if isinstance(document, dict):
            number = _number(document.pop("id", None))
        return number, CurvesPayload.checked(document)
    except Rejected as error:
        return number, error


def _number(given: object) -> int | None:
    if given is None or (type(given) is int and 0 <= given <= LARGEST_ID):
        return given
    raise Rejected([Rejection("id", given, f"a whole number from 0 to {LARGEST_ID:,}, or null")])


def _lane(request: CurvesPayload) -> PlanningTurns:
    return planning_lane([request.design], len(request.methods), request.max_points)


def _message(answer: CurvesAnswer, max_points: int) -> str:
    pieces: list[bytes] = []
    left = LONGEST_MESSAGE_BYTES
    for piece in json_pieces(answer):
        pieces.append(piece)
        left -= len(piece)
        if left < 0:
            allowed = f"fewer, for an answer of at most {LONGEST_MESSAGE_BYTES:,} bytes; POST /curves sends more"
            raise Rejected([Rejection("max_points", max_points, allowed)])
    return b"".join(pieces).decode()
