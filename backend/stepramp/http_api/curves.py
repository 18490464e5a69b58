"""The routes for plots: a design in, everything that is drawn of it out, in one answer. They keep nothing."""

from functools import partial
from typing import Annotated

from fastapi import APIRouter, WebSocket
from pydantic import Field
from starlette.responses import Response

from stepramp.design import MOST_NAMES, MOST_STEPS, Design, MethodName
from stepramp.errors import Rejected, Rejection
from stepramp.http_api.bodies import LARGE_BYTES, JsonRoute
from stepramp.http_api.curves_models import CurvesAnswer, curves_content
from stepramp.http_api.errors import error_items, in_body
from stepramp.http_api.json_response import json_bytes, json_pieces
from stepramp.http_api.lanes import CHECKING, Lane, planning_lane
from stepramp.http_api.planned import Planned
from stepramp.http_api.sockets import accept, parsed, received, send, served
from stepramp.methods import REFERENCE
from stepramp.ramp.drawing import Drawing
from stepramp.validation import Document, ListOf, TrueOrFalse, Within

router = APIRouter(tags=["planning"], route_class=JsonRoute)

LONGEST_MESSAGE_BYTES = 2**22
"""A message is sent in one go, for which a stop may have to wait."""

StepOfMove = Annotated[int, Within(1, MOST_STEPS, "steps, or null")] | None


class CurvesRequest(Document):
    """A design, and what is to be drawn of it."""

    design: Design
    methods: Annotated[list[MethodName], ListOf("method names", most=MOST_NAMES)] = Field(
        description="Methods to draw, each with the design's arithmetic or else the one usual for it"
    )
    reference: MethodName = Field(REFERENCE, description="Method that they are compared with")
    max_points: Annotated[int, Within(10, 100_000, "points")] = Field(
        2000, description="Thin each method's arrays to about so many steps that keep the curves' shapes"
    )
    first_step: StepOfMove = Field(
        None,
        description="First step of a part that gets the points; the rest is thinned to about a quarter as many. "
        "Null: the move's first [steps]",
    )
    last_step: StepOfMove = Field(None, description="Last step of that part; null: the move's last [steps]")
    acceleration: Annotated[bool, TrueOrFalse()] = Field(
        False, description="Whether the implied acceleration is wanted"
    )
    parts: Annotated[bool, TrueOrFalse()] = Field(False, description="Whether the parts of the error are wanted")
    segment_bound_ticks: Annotated[int, Within(0, 10_000, "ticks, or null for no segments")] | None = Field(
        None,
        description="Bound of the segments whose part of the error is given among the parts [ticks]; null: no segments",
    )

    @property
    def drawing(self) -> Drawing:
        """What is to be drawn."""
        span = (self.first_step or 1, self.last_step or abs(self.design.move.steps))
        return Drawing(
            design=self.design,
            wanted=tuple(dict.fromkeys(self.methods)),
            reference=self.reference,
            most_points=self.max_points,
            span=None if self.first_step is self.last_step is None else span,
            with_acceleration=self.acceleration,
            with_parts=self.parts,
            segment_bound_ticks=self.segment_bound_ticks,
        )


@router.post("/curves", response_model=CurvesAnswer)
async def curves(request: CurvesRequest) -> Response:
    """Plan a design's move by several methods, thinned for plots, with their errors and figures."""
    return Planned(_lane(request), lambda: curves_content(request.drawing))


@router.websocket("/curves/socket")
async def curves_socket(socket: WebSocket) -> None:
    """Answer the requests of POST /curves, one after the other, each with its answer or an object with `errors`.

    For sliders: in a browser a request of its own takes longer than the curves of a usual move.
    """
    async with served(socket):
        await accept(socket)
        while True:
            message = await received(socket)
            await send(socket, await _answer(message))


async def _answer(message: str | bytes) -> str:
    checked = partial(_checked, message)
    try:
        request = await CHECKING.run(checked) if len(message) > LARGE_BYTES else checked()
        return await _lane(request).run(lambda: _message(curves_content(request.drawing), request.max_points))
    except Rejected as error:
        return json_bytes({"errors": error_items(in_body(error))}).decode()


def _checked(message: str | bytes) -> CurvesRequest:
    return CurvesRequest.checked(parsed(message, "a JSON object with a design and methods"))


def _lane(request: CurvesRequest) -> Lane:
    return planning_lane([request.design], len(request.methods), request.max_points)


def _message(content: object, max_points: int) -> str:
    pieces: list[bytes] = []
    left = LONGEST_MESSAGE_BYTES
    for piece in json_pieces(content):
        pieces.append(piece)
        left -= len(piece)
        if left < 0:
            allowed = f"fewer, for an answer of at most {LONGEST_MESSAGE_BYTES:,} bytes; POST /curves sends more"
            raise Rejected([Rejection("max_points", max_points, allowed)])
    return b"".join(pieces).decode()
