"""The routes that export a design as a file. They keep nothing."""

from typing import Any

from fastapi import APIRouter
from starlette.responses import Response

from stepramp.controllers.own_ramp import Beside
from stepramp.errors import Refused
from stepramp.exports.export import MEDIA_TYPES, FormatName, MachineName, Options, export, sheet_of
from stepramp.exports.machines.machines import MACHINES
from stepramp.http_api.bodies import JsonRoute
from stepramp.http_api.error_items import ToldAnswer
from stepramp.http_api.exports_models import ExportPayload, MachineAnswer, SettingAnswer
from stepramp.http_api.lanes import LONG_PLANNING, planning_lane
from stepramp.http_api.own_ramps_models import UNPLAYED, OwnRampAnswer, OwnRampPayload
from stepramp.http_api.planned import Planned

router = APIRouter(tags=["exports"], route_class=JsonRoute)

FILE: dict[str, Any] = {kind: {"schema": {"type": "string", "format": "binary"}} for kind in MEDIA_TYPES}
FILE["application/json"] = {"schema": {"type": "object", "description": "The design's document"}}


@router.post("/export/{format}", response_class=Response, responses={200: {"description": "The file", "content": FILE}})
@LONG_PLANNING.serves
def export_design(format: FormatName, request: ExportPayload) -> Response:
    """Export a design: code, settings of a machine, a list of steps, a page of plots to zoom or a picture."""
    made = export(request.design, format, _options(request))
    headers = {"content-disposition": f'attachment; filename="{made.file_name}"'}
    return Response(made.content, headers=headers, media_type=made.media_type)


@router.post("/machine/{machine}")
@LONG_PLANNING.serves
def settings_of_machine(machine: MachineName, request: ExportPayload) -> MachineAnswer:
    """Say what a machine or a library that ramps by itself is given for a design, and what is lost.

    Speed and acceleration are rounded down. The text is the file of `/export` with the same name.
    """
    file_name, sheet = sheet_of(request.design, machine, _options(request))
    return MachineAnswer(
        file_name=file_name,
        text=sheet.text,
        settings=[SettingAnswer.model_validate(each) for each in sheet.settings],
        remarks=list(sheet.remarks),
        remarks_told=[[ToldAnswer.model_validate(each) for each in one] for one in sheet.remarks_told],
        unplayed=MACHINES[machine].unplayed if MACHINES[machine].play_own is None else None,
    )


@router.post("/machine/{machine}/ramp", responses=UNPLAYED)
async def ramp_of_machine(machine: MachineName, request: OwnRampPayload) -> Planned[OwnRampAnswer]:
    """Work out what such a machine or library really plays of a design's move, beside what is planned."""
    known = MACHINES[machine]
    play = known.play_own
    if play is None:
        raise Refused(known.unplayed)
    return Planned(
        planning_lane([request.design], 2, request.max_points),
        lambda: OwnRampAnswer.of(Beside.of(request.design, play, request.steps_per_mm), request.max_points),
    )


def _options(request: ExportPayload) -> Options:
    return Options(
        request.name, tuple(request.methods), request.arithmetic, request.segment_bound_ticks, request.axis_letter
    )
