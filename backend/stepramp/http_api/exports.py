"""The route that exports a design as a file. It keeps nothing."""

from typing import Any

from fastapi import APIRouter
from starlette.responses import Response

from stepramp.exports.export import MEDIA_TYPES, FormatName, Options, export
from stepramp.http_api.bodies import JsonRoute
from stepramp.http_api.exports_models import ExportPayload
from stepramp.http_api.lanes import LONG_PLANNING

router = APIRouter(tags=["exports"], route_class=JsonRoute)

FILE: dict[str, Any] = {kind: {"schema": {"type": "string", "format": "binary"}} for kind in MEDIA_TYPES}
FILE["application/json"] = {"schema": {"type": "object", "description": "The design's document"}}


@router.post("/export/{format}", response_class=Response, responses={200: {"description": "The file", "content": FILE}})
@LONG_PLANNING.serves
def export_design(format: FormatName, request: ExportPayload) -> Response:
    """Export a design: C of its table, segments or a formula, a list of steps, a page of plots to zoom or a picture."""
    options = Options(request.name, tuple(request.methods), request.arithmetic, request.segment_bound_ticks)
    made = export(request.design, format, options)
    headers = {"content-disposition": f'attachment; filename="{made.file_name}"'}
    return Response(made.content, headers=headers, media_type=made.media_type)
