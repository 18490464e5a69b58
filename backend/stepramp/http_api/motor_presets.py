"""The route that tells motors that many people have: the page's list, and that of any other program."""

from fastapi import APIRouter

from stepramp.http_api.bodies import JsonRoute
from stepramp.http_api.motor_presets_models import MotorPresetsAnswer

router = APIRouter(prefix="/motor", tags=["motor"], route_class=JsonRoute)


@router.get("/presets", response_model_exclude_unset=True)
async def presets() -> MotorPresetsAnswer:
    """List motors, by their data sheets, and what of their drive, their load and their axis that fixes.

    `{"presets": [{"name", "help", "motor": {…}, "drive": {…} or null, "load": {…} or null, "axis": {…} or null,
    "sources": {"motor.resistance_ohm": "datasheet", "motor.torque_curve": "assumed", …}}]}`: motor, drive, load and
    axis are parts of a design with only those fields that are given, and sources has a path for each field of motor,
    drive and load. null: the maker fixes nothing of it; what the design has stays.
    """
    return MotorPresetsAnswer.of_all()
