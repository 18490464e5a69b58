"""What lies between a motor's shaft and what it moves, as part of a design document, and what of that the shaft feels.

Screw with the lead l and the efficiency η, incline α: J = m (l/2π)², T_L = m g sin α · l/2π, T_c = F l/(2πη) and, of
what the weight presses on the thread, |T_L| (1/η - 1). Belt with the pulley's radius r: J = m r², T_L = m g r sin α,
T_c = F r. docs/motor.md.
"""

import math
from dataclasses import dataclass
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from stepramp.units import kg_m2_from_g_cm2, m_from_mm, rad_from_deg
from stepramp.validation import Document, Within, is_none, refuse

MechanismName = Literal["screw", "belt", "pointer"]

GRAVITY_M_PER_S2 = 9.80665
EFFICIENCY = 0.4
"""Of a trapezoidal screw in a nut of plastic or bronze; a ball screw has 0.9."""

NEEDED: dict[MechanismName, dict[str, str]] = {
    "screw": {"lead_mm": "the travel of one turn [mm]", "mass_kg": "the mass that it moves [kg]"},
    "belt": {"pulley_mm": "the pulley's pitch diameter [mm]", "mass_kg": "the mass that it moves [kg]"},
    "pointer": {"inertia_g_cm2": "the pointer's inertia about its shaft [g·cm²]"},
}
"""By the mechanism's name the fields that it can't be without, and what they are."""
USUAL: dict[MechanismName, dict[str, float]] = {
    "screw": {"friction_n": 0.0, "efficiency": EFFICIENCY, "incline_deg": 0.0},
    "belt": {"friction_n": 0.0, "incline_deg": 0.0},
    "pointer": {},
}
"""Those that it can be without, and what then stands for them."""


@dataclass(frozen=True)
class AtShaft:
    """What a motor's shaft feels of what it moves."""

    inertia_kg_m2: float = 0.0
    torque_nm: float = 0.0
    """T_L, against forward motion; negative: with it."""
    friction_nm: float = 0.0
    """T_c, against any motion."""


class Mechanism(Document):
    """What the motor moves something with; its name says which fields it has."""

    name: MechanismName = Field(
        description="screw: a mass on a lead screw. belt: a mass on a belt, or on a rack. pointer: a gauge's"
    )
    lead_mm: Annotated[float, Within(0.01, 10_000, "mm")] | None = Field(
        None, description="l, of screw: how far one turn of the motor moves the mass [mm]", exclude_if=is_none
    )
    pulley_mm: Annotated[float, Within(0.1, 10_000, "mm")] | None = Field(
        None, description="Of belt: the pitch diameter of the motor's pulley [mm]", exclude_if=is_none
    )
    mass_kg: Annotated[float, Within(0, 10_000, "kg")] | None = Field(
        None, description="m, of screw and belt: all that moves along [kg]", exclude_if=is_none
    )
    friction_n: Annotated[float, Within(0, 100_000, "N")] | None = Field(
        None,
        description="F, of screw and belt: force against any motion of the mass [N]; null: none but load.friction_nm",
        exclude_if=is_none,
    )
    efficiency: Annotated[float, Within(0.05, 1, "of the work")] | None = Field(
        None,
        description=f"η, of screw: what its thread passes on; null: {EFFICIENCY:g}, usual for a trapezoidal screw; "
        "a ball screw has 0.9",
        exclude_if=is_none,
    )
    incline_deg: Annotated[float, Within(-90, 90, "°")] | None = Field(
        None,
        description="α, of screw and belt: 90: forward is straight up, -90 straight down [°]; null: 0, level",
        exclude_if=is_none,
    )
    inertia_g_cm2: Annotated[float, Within(0, 1e8, "g·cm²")] | None = Field(
        None, description="Of pointer: its moment of inertia about its shaft [g·cm²]", exclude_if=is_none
    )

    @model_validator(mode="after")
    def _own_fields(self) -> Self:
        needed, own = NEEDED[self.name], NEEDED[self.name] | USUAL[self.name]
        for field in type(self).model_fields.keys() - {"name"}:
            if field not in own and getattr(self, field) is not None:
                owners = " or ".join(repr(name) for name in NEEDED if field in NEEDED[name] | USUAL[name])
                refuse(field, getattr(self, field), f"none with the name '{self.name}', it is of {owners}")
        for field, what in needed.items():
            if getattr(self, field) is None:
                refuse(field, None, f"{what}, since the name is '{self.name}'")
        return self

    @property
    def assumed(self) -> list[str]:
        """The fields that are left open, and count: a usual value stands for them."""
        # No friction is as much a figure as any other; where none is told, load.friction_nm has a usual one.
        return [name for name in USUAL[self.name] if name != "friction_n" and getattr(self, name) is None]

    @property
    def counted(self) -> dict[str, float]:
        """What counts of each of its fields, told or usual."""
        return {field: self._value(field) for field in NEEDED[self.name] | USUAL[self.name]}

    @property
    def at_shaft(self) -> AtShaft:
        """What the motor's shaft feels of it."""
        if self.inertia_g_cm2 is not None:
            return AtShaft(inertia_kg_m2=kg_m2_from_g_cm2(self.inertia_g_cm2))
        m_per_rad, incline = self._m_per_rad, rad_from_deg(self._value("incline_deg"))
        efficiency = self._value("efficiency") if self.name == "screw" else 1.0
        weight_nm = self._value("mass_kg") * GRAVITY_M_PER_S2 * math.sin(incline) * m_per_rad
        return AtShaft(
            inertia_kg_m2=self._value("mass_kg") * m_per_rad**2,
            torque_nm=weight_nm,
            # Up that makes |weight| / η of it, and down (2 - 1/η): below ½ the screw holds the weight by itself.
            friction_nm=self._value("friction_n") * m_per_rad / efficiency + abs(weight_nm) * (1 / efficiency - 1),
        )

    @property
    def _m_per_rad(self) -> float:
        """How far the mass moves while the shaft turns by one radian: l/2π, or the pulley's radius [m]."""
        if self.name == "screw":
            return m_from_mm(self._value("lead_mm")) / (2 * math.pi)
        return m_from_mm(self._value("pulley_mm")) / 2

    def _value(self, field: str) -> float:
        given: float | None = getattr(self, field)
        return USUAL[self.name][field] if given is None else given
