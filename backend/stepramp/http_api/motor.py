"""Routes about what a motor does with a design. They keep nothing, and move nothing."""

import numpy as np
from fastapi import APIRouter

from stepramp.http_api.bodies import JsonRoute
from stepramp.http_api.lanes import LONG_PLANNING, PLANNING, planning_lane
from stepramp.http_api.motor_models import (
    GaugeTableAnswer,
    GaugeTablePayload,
    SimulateAnswer,
    SimulatePayload,
    TorqueAnswer,
    TorquePayload,
)
from stepramp.http_api.planned import Planned, Wanted
from stepramp.motor.gauge_rows import gauge_rows_of
from stepramp.motor.proposals import proposals_of
from stepramp.motor.torque import torques_at
from stepramp.motor.verdict import cause_of, outcome_of

router = APIRouter(prefix="/motor", tags=["motor"], route_class=JsonRoute)


@router.post("/torque")
async def torque(request: TorquePayload) -> Planned[TorqueAnswer]:
    """Tell which torque the motor has at speeds, and which the design's ramp asks for there."""
    lane = planning_lane([request.design], points=len(request.speeds_rpm))
    return Planned(lane, lambda: TorqueAnswer.of(torques_at(request.design, np.array(request.speeds_rpm))))


@router.post("/simulate")
async def simulate(request: SimulatePayload) -> Planned[SimulateAnswer]:
    """Play the design's move, tick by tick, through a model of its motor: whether steps are lost, and why."""
    design, wanted = request.design, Wanted()

    def answer() -> SimulateAnswer:
        outcome = outcome_of(design, wanted.is_so)
        cause = cause_of(outcome) if request.with_proposals else None
        proposals = proposals_of(design, outcome, cause, wanted.is_so)
        return SimulateAnswer.of(design, outcome, proposals, request.max_points)

    return Planned(LONG_PLANNING, answer, wanted=wanted)


@router.post("/gauge_table")
async def gauge_table(request: GaugeTablePayload) -> Planned[GaugeTableAnswer]:
    """Make a gauge's lookup table from its motor by the makers' rule: a row for each full step, up to the slew speed.

    `changes` put it into the design, as those of proposals do.
    """
    design, share = request.design, request.share
    return Planned(PLANNING, lambda: GaugeTableAnswer.of(design, share, gauge_rows_of(design, share)))
