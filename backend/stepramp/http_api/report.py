"""The route that makes a report to be sent to others. It keeps nothing."""

from datetime import date
from functools import partial
from typing import Any

from fastapi import APIRouter
from starlette.requests import Request
from starlette.responses import Response

from stepramp.exports.printed.file import MEDIA_TYPES, ReportFormat, report_file
from stepramp.http_api.bodies import JsonRoute
from stepramp.http_api.lanes import LONG_PLANNING
from stepramp.http_api.planned import Wanted, while_wanted
from stepramp.http_api.report_models import ReportPayload

router = APIRouter(tags=["exports"], route_class=JsonRoute)

FILE: dict[str, Any] = {
    kind.partition(";")[0]: {"schema": {"type": "string", "format": "binary"}} for kind in MEDIA_TYPES.values()
}


@router.post("/report", response_class=Response, responses={200: {"description": "The file", "content": FILE}})
async def report(format: ReportFormat, request: ReportPayload, connection: Request) -> Response:
    """Make a report of a design in the chosen units, to be sent or printed: HTML without scripts, or PDF."""
    asked, wanted = request.asked, Wanted()
    make = partial(report_file, asked, format, date.today(), wanted.is_so)
    made = await while_wanted(LONG_PLANNING, make, wanted, connection.receive)
    if made is None:
        return Response()
    headers = {"content-disposition": f'attachment; filename="{made.file_name}"'}
    return Response(made.content, headers=headers, media_type=made.media_type)
