"""The route that makes a report to be sent to others. It keeps nothing."""

from datetime import date
from typing import Any

from fastapi import APIRouter
from starlette.responses import Response

from stepramp.exports.printed.file import MEDIA_TYPES, ReportFormat, report_file
from stepramp.http_api.bodies import JsonRoute
from stepramp.http_api.lanes import LONG_PLANNING
from stepramp.http_api.report_models import ReportPayload

router = APIRouter(tags=["exports"], route_class=JsonRoute)

FILE: dict[str, Any] = {
    kind.partition(";")[0]: {"schema": {"type": "string", "format": "binary"}} for kind in MEDIA_TYPES.values()
}


@router.post("/report", response_class=Response, responses={200: {"description": "The file", "content": FILE}})
@LONG_PLANNING.serves
def report(format: ReportFormat, request: ReportPayload) -> Response:
    """Make a report of a design in the chosen units, to be sent or printed: HTML without scripts, or PDF."""
    made = report_file(request.asked, format, date.today())
    headers = {"content-disposition": f'attachment; filename="{made.file_name}"'}
    return Response(made.content, headers=headers, media_type=made.media_type)
