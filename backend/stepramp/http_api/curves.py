"""The routes for plots: a design in, everything that is drawn of it out, in one answer. They keep nothing."""

import asyncio
from contextlib import suppress
from typing import Annotated

from fastapi import APIRouter, WebSocket, WebSocketDisconnect
from pydantic import Field
from starlette.responses import Response

from stepramp.design import MOST_STEPS, Design, MethodName
from stepramp.errors import Rejected
from stepramp.http_api.curves_models import CurvesAnswer, curves_content
from stepramp.http_api.errors import error_items, in_body
from stepramp.http_api.json_response import json_bytes, json_response
from stepramp.http_api.sockets import parsed
from stepramp.ramp.drawing import Drawing
from stepramp.validation import Document, ListOf, OneOf, Within

router = APIRouter(tags=["planning"])

StepOfMove = Annotated[int, Within(1, MOST_STEPS, "steps, or null")] | None


class CurvesRequest(Document):
    """A design, and what is to be drawn of it."""

    design: Design
    methods: Annotated[list[Annotated[MethodName, OneOf()]], ListOf("method names")] = Field(
        description="Methods to draw, each with the design's arithmetic or else the one usual for it"
    )
    reference: Annotated[MethodName, OneOf()] = Field("exact", description="Method that they are compared with")
    max_points: Annotated[int, Within(10, 100_000, "points")] = Field(
        2000, description="Thin each method's arrays to about so many steps that keep the curves' shapes"
    )
    first_step: StepOfMove = Field(
        None,
        description="First step of a part that gets the points; the rest is thinned to about a quarter as many. "
        "Null: the move's first [steps]",
    )
    last_step: StepOfMove = Field(None, description="Last step of that part; null: the move's last [steps]")
    acceleration: bool = Field(False, description="Whether the implied acceleration is wanted")
    parts: bool = Field(False, description="Whether the parts of the error are wanted")
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
def curves(request: CurvesRequest) -> Response:
    """Plan a design's move by several methods, thinned for plots, with their errors and figures."""
    return json_response(curves_content(request.drawing))


@router.websocket("/curves/socket")
async def curves_socket(socket: WebSocket) -> None:
    """Answer the requests of POST /curves, one after the other, each with its answer or an object with `errors`.

    For sliders: in a browser a request of its own takes longer than the curves of a usual move.
    """
    await socket.accept()
    # Starlette raises one or the other when the page has gone: which one depends on who noticed first.
    with suppress(WebSocketDisconnect, RuntimeError):
        while True:
            text = await socket.receive_text()
            await socket.send_text(await asyncio.to_thread(_answer, text))


def _answer(text: str) -> str:
    try:
        request = CurvesRequest.checked(parsed(text, "a JSON object with a design and methods"))
        content = curves_content(request.drawing)
    except Rejected as error:
        content = {"errors": error_items(in_body(error))}
    return json_bytes(content).decode()
