"""Where the numbers of a motor come from: what is measured, told, of a data sheet, or assumed."""

from typing import Any

import pytest

from motor.trains import AT_24_V, NEMA_17, with_motor
from stepramp import MOTORS
from stepramp.motor.changes import with_changes
from stepramp.motor.origins import assumed_of, origins_of
from stepramp.ramp.profile import profile_of

OWN: dict[str, Any] = NEMA_17 | {"resistance_ohm": 1.9, "inductance_mh": 3.7, "holding_torque_nm": 0.5}
"""Of no preset."""
CURVE = [[100.0, 0.3], [1000.0, 0.2]]
STALLED = {"rpm": 1180.0, "torque_nm": 0.16}


def origins(**changes: Any) -> dict[str, str]:
    return dict(origins_of(with_motor(**changes)))


@pytest.mark.parametrize(
    ("changes", "assumed"),
    [
        ({"drive": {}}, {"drive.supply_v", "drive.current_a"}),
        ({"drive": {"current_a": 1.0, "current_is": "rms"}}, {"drive.supply_v"}),
        ({"drive": {"supply_v": 24.0}}, {"drive.current_a"}),
        ({"motor": OWN | {"pull_out_factor": 0.85}}, set()),
        ({"motor": OWN}, {"motor.pull_out_factor"}),
        ({"motor": OWN | {"stalled": STALLED}}, set()),
    ],
)
def test_what_is_left_open_is_assumed_and_what_is_told_is_not(changes: dict[str, Any], assumed: set[str]) -> None:
    always = {"motor.detent_torque_nm", "load.friction_nm"}
    usual = {"motor.pull_out_factor"} if "motor" not in changes else set()
    given = with_motor(**changes)
    assert set(assumed_of(given)) == always | usual | assumed
    # It stays so when something else is changed.
    assert list(assumed_of(with_changes(given, []))) == list(assumed_of(given))


def test_each_number_says_where_it_comes_from() -> None:
    told = origins(motor=OWN | {"inductance_mh": 3.0, "detent_torque_nm": 0.01}, load={"torque_nm": 0.1})
    # Three figures are those of a preset, the rotor's inertia, the current and the inductance: it began with that one.
    assert told == {
        "motor.resistance_ohm": "given", "motor.inductance_mh": "datasheet", "motor.holding_torque_nm": "given",
        "motor.rated_current_a": "datasheet", "motor.rotor_inertia_g_cm2": "datasheet",
        "motor.detent_torque_nm": "given", "motor.pull_out_factor": "assumed", "drive.supply_v": "given",
        "drive.current_a": "given", "drive.current_is": "given", "load.torque_nm": "given",
        "load.friction_nm": "assumed",
    }  # fmt: skip
    assert origins(motor=OWN)["motor.inductance_mh"] == "given"


def test_what_does_not_fit_together_is_warned_of_by_name() -> None:
    def warned(**changes: Any) -> dict[str | None, str]:
        return {warning.field: warning.message for warning in profile_of(with_motor(**changes)).warnings}

    assert warned() == {}
    assert warned(axis__full_steps_per_rev=400) == {}
    said = warned(motor=NEMA_17 | {"full_steps_per_rev": 400})["motor.full_steps_per_rev"]
    assert said.startswith("The motor has 400 full steps of a turn, and the axis 200 (axis.full_steps_per_rev)")
    # .59 / (√2 · 2) Nm/A hold .4172 Nm at 2 A; with √2 times that .59 Nm.
    curve = NEMA_17 | {"torque_curve": [[100.0, 0.5], [1000.0, 0.2]]}
    assert "hold the rotor with 0.4172 Nm" in warned(motor=curve)["motor.torque_curve"]
    assert warned(motor=curve | {"measured_with": AT_24_V | {"current_is": "rms"}}) == {}


def test_what_something_else_counts_in_place_of_is_said_not_to() -> None:
    told = origins(motor=OWN | {"pull_out_factor": 0.8, "stalled": STALLED, "measured_with": AT_24_V})
    assert (told["motor.stalled"], told["motor.measured_with"]) == ("measured", "measured")
    assert told["motor.pull_out_factor"] == "unused"
    told = origins(motor=OWN | {"pull_out_factor": 0.8, "stalled": STALLED, "torque_curve": CURVE})
    assert [told[f"motor.{name}"] for name in ("torque_curve", "stalled", "pull_out_factor")] == [
        "measured", "unused", "unused",
    ]  # fmt: skip
    assert origins(motor=OWN | {"measured_with": AT_24_V})["motor.measured_with"] == "unused"
    assert origins(drive={"current_is": "peak"})["drive.current_is"] == "unused"


def test_a_presets_figures_are_as_its_maker_tells_them() -> None:
    gauge = MOTORS["Gauge · X27"]
    told = origins(motor=gauge.motor, drive=gauge.drive, load=gauge.load)
    numbers = {path: source for path, source in gauge.sources.items() if path not in ("motor.kind", "load.mechanism")}
    assert numbers.items() <= told.items()
    assert told["load.mechanism.inertia_g_cm2"] == "assumed"
    assert origins(motor=None, drive=None, load=None) == {}
