"""The route for what a logic analyser captured: a file in, its steps next to a design's out. It keeps nothing."""

from functools import partial
from typing import Any

from fastapi import APIRouter, Request

from stepramp.capture.analysis import analysed
from stepramp.capture.formats.files import read_file
from stepramp.http_api.bodies import FILE_TYPE, MOST_FILE_BYTES, OF_FILES, FileRoute, read_file_body
from stepramp.http_api.capture_models import PARAMETERS, CaptureAnswer, CapturePayload
from stepramp.http_api.lanes import CAPTURING
from stepramp.http_api.planned import Planned, Wanted
from stepramp.motor.train import NotWanted
from stepramp.ramp.profile import profile_of

router = APIRouter(tags=["captures"], route_class=FileRoute)

_FILE: dict[str, Any] = {
    "required": True,
    "description": f"The file, of up to {MOST_FILE_BYTES:,} bytes: what kind it is, its content says",
    "content": {FILE_TYPE: {"schema": {"type": "string", "format": "binary"}}},
}


@router.post("/capture", responses=OF_FILES, openapi_extra={"requestBody": _FILE, "parameters": PARAMETERS})
async def capture(request: Request) -> Planned[CaptureAnswer]:
    """Show the steps that a logic analyser captured, and how far they are from those of a design.

    Files are digital data as CSV of Saleae Logic 2, CSV of sigrok, VCD, and `.sr` of sigrok where sigrok-cli is
    installed. The body is the file; what is wanted of it, also the design, are parameters.
    """
    parts = await read_file_body(request)
    # Only now: a browser shows no refusal that comes before it has sent its file.
    payload = CapturePayload.of_parameters(request.query_params)
    wanted = Wanted()
    return Planned(CAPTURING, partial(_answer, parts, payload, wanted), wanted=wanted)


def _answer(parts: list[bytes], payload: CapturePayload, wanted: Wanted) -> CaptureAnswer:
    if not wanted.is_so():
        raise NotWanted
    content = b"".join(parts)
    parts.clear()
    profile = None if payload.design is None else profile_of(payload.design)
    return CaptureAnswer.of(analysed(read_file(content), payload.wanted, profile), payload)
