"""The route for what a logic analyser captured: a file in, its steps next to a design's out. It keeps nothing."""

import math
import re
from functools import partial
from typing import Any

from fastapi import APIRouter, Request
from starlette.datastructures import QueryParams

from stepramp.capture.analysis import analysed
from stepramp.capture.formats.files import read_file
from stepramp.errors import Rejected, Rejection
from stepramp.http_api.bodies import FILE_TYPE, MOST_FILE_BYTES, FileRoute, of_files, read_file_body, refuse_repeated
from stepramp.http_api.capture_models import PARAMETERS, CaptureAnswer, CapturePayload
from stepramp.http_api.lanes import CAPTURING
from stepramp.http_api.planned import Planned, Wanted
from stepramp.json_text import parsed_json, why_unreadable
from stepramp.motor.train import NotWanted
from stepramp.ramp.profile import profile_of

_NUMBER = re.compile(r"-?[0-9]+(\.[0-9]+)?([eE][+-]?[0-9]+)?")

router = APIRouter(tags=["captures"], route_class=FileRoute)

_FILE: dict[str, Any] = {
    "required": True,
    "description": f"The file, of up to {MOST_FILE_BYTES:,} bytes: what kind it is, its content says",
    "content": {FILE_TYPE: {"schema": {"type": "string", "format": "binary"}}},
}


@router.post(
    "/capture", responses=of_files(MOST_FILE_BYTES), openapi_extra={"requestBody": _FILE, "parameters": PARAMETERS}
)
async def capture(request: Request) -> Planned[CaptureAnswer]:
    """Show the steps that a logic analyser captured, and how far they are from those of a design.

    Files are digital data as CSV of Saleae Logic 2, CSV of sigrok, VCD, and `.sr` of sigrok where sigrok-cli is
    installed. The body is the file; what is wanted of it, also the design, are parameters.
    """
    parts = await read_file_body(request)
    # Only now: a browser shows no refusal that comes before it has sent its file.
    payload = _asked(request.query_params)
    wanted = Wanted()
    return Planned(CAPTURING, partial(_answer, parts, payload, wanted), wanted=wanted)


def _asked(parameters: QueryParams) -> CapturePayload:
    """Return what the parameters of a request say; Rejected for what can't be used."""
    refuse_repeated(parameters, CapturePayload.model_fields)
    return CapturePayload.checked({name: _value(name, text) for name, text in parameters.items()})


def _value(name: str, text: str) -> object:
    """Return a parameter's text as what it stands for."""
    if name == "design":
        try:
            return parsed_json(text)
        except Rejected as error:
            raise Rejected([each.within("design.") for each in error.rejections]) from None
        except ValueError as error:
            raise Rejected(
                [Rejection("design", text, f"a design document as JSON ({why_unreadable(error)})")]
            ) from None
    if name not in ("move_number", "shortest_pulse_us", "longest_wait_us", "max_points"):
        return text
    if name == "max_points" and text == "null":
        return None
    if not _NUMBER.fullmatch(text) or not math.isfinite(number := float(text)):
        return text
    return int(text) if text.lstrip("-").isdecimal() else number


def _answer(parts: list[bytes], payload: CapturePayload, wanted: Wanted) -> CaptureAnswer:
    if not wanted.is_so():
        raise NotWanted
    content = b"".join(parts)
    parts.clear()
    profile = None if payload.design is None else profile_of(payload.design)
    return CaptureAnswer.of(analysed(read_file(content), payload.wanted, profile), payload)
