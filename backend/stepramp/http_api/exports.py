"""The route that exports a design as a file. It keeps nothing."""

from typing import Annotated, Any, Self

from fastapi import APIRouter
from pydantic import Field, model_validator
from starlette.responses import Response

from stepramp.design import MOST_NAMES, Design, MethodName
from stepramp.exports.export import MEDIA_TYPES, FormatName, Options, export
from stepramp.exports.names import NAME_RULE, is_identifier
from stepramp.http_api.bodies import JsonRoute
from stepramp.http_api.lanes import LONG_PLANNING
from stepramp.numerics.numbers import Arithmetic
from stepramp.validation import Document, ListOf, OneOf, Within, refuse

router = APIRouter(tags=["exports"], route_class=JsonRoute)

MOST_BOUND_TICKS = 10_000


class ExportRequest(Document):
    """A design, and what its file should be like."""

    design: Design
    name: str | None = Field(
        None, description="Begin of the file's name and of the names in C; null: made of the design's name"
    )
    methods: Annotated[list[MethodName], ListOf("method names", most=MOST_NAMES)] = Field(
        default=[], description="html, svg, png: methods that the design's own is compared with"
    )
    arithmetic: Annotated[Arithmetic, OneOf()] | None = Field(
        None,
        description="C code of a formula: its numbers; null: the design's own when the formula is its method, else the "
        "ones usual for it",
    )
    segment_bound_ticks: Annotated[int, Within(0, MOST_BOUND_TICKS, "ticks")] = Field(
        0, description="c_segments: how far an interval may be from the planned one, for fewer segments [ticks]"
    )

    @model_validator(mode="after")
    def _name_fits_in_c(self) -> Self:
        if self.name is not None and not is_identifier(self.name):
            refuse("name", self.name, NAME_RULE)
        return self


FILE: dict[str, Any] = {kind: {"schema": {"type": "string", "format": "binary"}} for kind in MEDIA_TYPES}
FILE["application/json"] = {"schema": {"type": "object", "description": "The design's document"}}


@router.post("/export/{format}", response_class=Response, responses={200: {"description": "The file", "content": FILE}})
@LONG_PLANNING.serves
def export_design(format: FormatName, request: ExportRequest) -> Response:
    """Export a design: a C header of its table, its segments or a formula, a list of steps, a report or a picture."""
    options = Options(request.name, tuple(request.methods), request.arithmetic, request.segment_bound_ticks)
    made = export(request.design, format, options)
    headers = {"content-disposition": f'attachment; filename="{made.file_name}"'}
    return Response(made.content, headers=headers, media_type=made.media_type)
