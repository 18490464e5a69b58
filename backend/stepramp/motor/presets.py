"""Motors that many people have, with what their makers say of them, and what had to be assumed."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

from stepramp.design import AxisScale
from stepramp.drive_train import Drive, Load, Motor
from stepramp.mechanism import Mechanism
from stepramp.units import rpm_from_deg_per_s

Source = Literal["datasheet", "assumed"]

GAUGE_V = 5.0
GAUGE_STATIC_NM = 4e-3
GAUGE_DYNAMIC_AT_DEG_PER_S = 200.0
"""Where makers tell the dynamic torque of a gauge's motor."""
GAUGE_CURVE_END_DEG_PER_S = 791.5
"""M_d is drawn as a parabola, level at rest, that would end here: so the makers' rows for the X27 have it."""
GAUGE_SPEEDS_DEG_PER_S = (0, 100, 200, 300, 400, 500, 600)
GAUGE_POINTER_G_CM2 = 2.0
"""The pointer that makers tell the start-stop speeds with."""

GEARED_RATIO = 63.684
GEARED_NM = 34.3e-3 / GEARED_RATIO
"""The 28BYJ-48's pull-in torque at 120 Hz, at its rotor."""
HALF_STEPS_PER_ROTOR_REV = 64


@dataclass(frozen=True)
class Preset:
    """A motor, and of what drives it and what it moves that which its maker fixes."""

    name: str
    help: str
    motor: Motor
    assumed: frozenset[str]
    """Paths of the fields given here that no data sheet has."""
    drive: Drive | None = None
    load: Load | None = None
    axis: AxisScale | None = None
    """What one turn is, where it isn't 200 full steps."""

    @property
    def sources(self) -> dict[str, Source]:
        """Where each field comes from that is given here, by its path in a design."""
        return {path: "assumed" if path in self.assumed else "datasheet" for path in self._given()}

    def _given(self) -> Iterator[str]:
        for place in ("motor", "drive", "load"):
            part = getattr(self, place)
            if part is not None:
                yield from (f"{place}.{field}" for field in part.model_fields_set)


def _hybrid(
    name: str, data: tuple[float, float, float, float, float], help_: str, *assumed: str, detent_nm: float | None = None
) -> Preset:
    """Return a motor by R [Ω], L [mH], holding torque [Nm], rated current [A] and inertia [g·cm²]."""
    names = (
        "resistance_ohm", "inductance_mh", "holding_torque_nm", "rated_current_a", "rotor_inertia_g_cm2",
    )  # fmt: skip
    document = dict(zip(names, data, strict=True)) | ({} if detent_nm is None else {"detent_torque_nm": detent_nm})
    return Preset(name, help_, Motor.checked(document), frozenset(f"motor.{field}" for field in assumed))


def _gauge(
    name: str, resistance_ohm: float, inductance_mh: float, inertia_g_cm2: float, dynamic_nm: float, start_stop: str
) -> Preset:
    current_a = round(GAUGE_V / resistance_ohm, 5)
    return Preset(
        name,
        f"A gauge's motor, told at its pointer: {GAUGE_STATIC_NM * 1000:g} mNm at rest, {dynamic_nm * 1000:g} mNm at "
        f"{GAUGE_DYNAMIC_AT_DEG_PER_S:g} °/s; starts at {start_stop} °/s at once with a pointer of "
        f"{GAUGE_POINTER_G_CM2:g} g·cm², at most 600 °/s and 1000 rad/s². The torque at other speeds and the "
        "inductance are assumed.",
        Motor(
            kind="gauge", resistance_ohm=resistance_ohm, inductance_mh=inductance_mh,
            holding_torque_nm=GAUGE_STATIC_NM, rated_current_a=current_a, full_steps_per_rev=360,
            rotor_inertia_g_cm2=inertia_g_cm2, torque_curve=_dynamic_curve(dynamic_nm),
        ),
        frozenset({
            "motor.inductance_mh", "motor.torque_curve", "drive.current_is", "load.friction_nm", "load.mechanism",
        }),
        Drive(supply_v=GAUGE_V, current_a=current_a, current_is="peak"),
        # M_d is what is left at the pointer, behind the gears and their friction.
        Load(friction_nm=0.0, mechanism=Mechanism(name="pointer", inertia_g_cm2=GAUGE_POINTER_G_CM2)),
        AxisScale(full_steps_per_rev=360, microsteps=3),
    )  # fmt: skip


def _dynamic_curve(dynamic_nm: float) -> list[tuple[float, float]]:
    """Return M_d over the speed, through the point that makers tell: [rpm, Nm]."""
    at_rest = dynamic_nm / (1 - (GAUGE_DYNAMIC_AT_DEG_PER_S / GAUGE_CURVE_END_DEG_PER_S) ** 2)
    return [
        (
            round(rpm_from_deg_per_s(speed), 4),
            float(f"{at_rest * (1 - (speed / GAUGE_CURVE_END_DEG_PER_S) ** 2):.4g}"),
        )
        for speed in GAUGE_SPEEDS_DEG_PER_S
    ]


def _geared() -> Preset:
    """Return the 28BYJ-48 at its rotor: what is told at its shaft is GEARED_RATIO times slower and stronger."""
    rpm = [60 * hertz / HALF_STEPS_PER_ROTOR_REV for hertz in (0, 120, 1000)]
    friction_nm = round(0.05 * GEARED_NM, 7)
    return Preset(
        "28BYJ-48 · 5 V",
        f"Told at its rotor, which turns {GEARED_RATIO} times faster than its shaft: a turn are 32 full steps. 50 Ω at "
        "5 V; 34.3 mNm at the shaft at 120 Hz; unloaded it starts at 600 Hz and follows to 1000 Hz (half steps). Its "
        "inductance and its inertia are assumed, and torque falls evenly between those points.",
        Motor(
            resistance_ohm=50.0, inductance_mh=20.0, holding_torque_nm=float(f"{GEARED_NM * 2**0.5:.4g}"),
            rated_current_a=0.1, full_steps_per_rev=32, rotor_inertia_g_cm2=0.3,
            torque_curve=[
                (rpm[0], float(f"{GEARED_NM:.4g}")), (rpm[1], float(f"{GEARED_NM:.4g}")), (rpm[2], friction_nm),
            ],
        ),
        frozenset({
            "motor.inductance_mh", "motor.holding_torque_nm", "motor.rotor_inertia_g_cm2", "motor.torque_curve",
            "drive.current_is", "load.friction_nm",
        }),
        Drive(supply_v=5.0, current_a=0.1, current_is="peak"),
        Load(friction_nm=friction_nm),
        AxisScale(full_steps_per_rev=32, microsteps=2, travel_per_rev=round(360 / GEARED_RATIO, 6)),
    )  # fmt: skip


INERTIA = "rotor_inertia_g_cm2"
PRESETS: tuple[Preset, ...] = (
    _hybrid("NEMA 11 · SY28STH45", (6.8, 4.9, 0.095, 0.67, 18.0), "28 mm, 0.095 Nm at 0.67 A. Its inertia is a usual "
            "one: the data sheet was not at hand.", INERTIA),
    _hybrid("NEMA 17 · 17HS4401", (1.5, 2.8, 0.4, 1.7, 54.0), "42 mm, 0.40 Nm at 1.7 A: what most 3D printers have.",
            detent_nm=0.022),
    _hybrid("NEMA 17 · 17HS19-2004S1", (1.4, 3.0, 0.59, 2.0, 82.0), "42 mm, 0.59 Nm at 2.0 A."),
    _hybrid("NEMA 17 · Beckhoff AS1010", (4.1, 9.5, 0.38, 1.0, 56.0), "42 mm, 0.38 Nm at 1.0 A.", detent_nm=0.015),
    _hybrid("NEMA 23 · 23HS30-2804S", (1.13, 5.4, 1.89, 2.8, 480.0), "57 mm, 1.89 Nm at 2.8 A. Its inertia is an "
            "assumed one.", INERTIA),
    _hybrid("NEMA 34 · Beckhoff AS1060", (0.36, 2.8, 5.0, 5.0, 3000.0), "86 mm, 5.0 Nm at 5 A. Such large motors have "
            "about 0.6 of the model’s torque: measure a point.", detent_nm=0.18),
    _hybrid("Sanyo SS2421", (3.5, 1.2, 0.083, 1.0, 15.0), "42 mm, flat, 0.083 Nm at 1.0 A."),
    _gauge("Gauge · X27", 260.0, 490.0, 6.1, 1.45e-3, "250"),
    _gauge("Gauge · X25", 290.0, 650.0, 4.8, 1.3e-3, "200"),
    _gauge("Gauge · VID29", 280.0, 715.0, 4.225, 1.2e-3, "125"),
    _geared(),
)  # fmt: skip


def preset_of(motor: Motor) -> Preset | None:
    """Return the preset that a motor is of; None: it has figures of its own."""
    return next((preset for preset in PRESETS if preset.motor == motor), None)
