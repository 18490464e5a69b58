"""What the page knows of motors: presets, mechanisms, torque curves as text, and where the numbers come from."""

from copy import deepcopy
from typing import Any

import pytest

from designs import document
from frontend.modules import Modules
from motor.trains import AT_24_V, NEMA_17
from stepramp import drive_train, mechanism
from stepramp.design import Design
from stepramp.motor.origins import origins_of


def with_motor(**parts: Any) -> dict[str, Any]:
    return document(schema="stepramp/2", **deepcopy({"motor": NEMA_17, **parts}))


def test_what_stands_for_a_field_that_is_left_open_is_what_the_server_takes(modules: Modules) -> None:
    script = """async (design) => { const {GROUPS} = await import('/model/fields.js');
        const fields = GROUPS.find(({title}) => title === 'Motor').fields.filter(({usual}) => usual);
        return Object.fromEntries(fields.map(({path, usual}) => [path, usual(design)])); }"""
    design = with_motor()
    usual = modules.evaluate(script, design)
    train = drive_train.drive_train_of(Design.checked(design).motor, None, None, 200)  # type: ignore[arg-type]
    assert usual.pop("motor.detent_torque_nm") == pytest.approx(train.detent_nm, rel=5e-3)
    assert usual.pop("load.friction_nm") == pytest.approx(train.friction_nm, rel=5e-3)
    assert usual.pop("motor.pull_out_factor") == train.pull_out_factor
    assert usual.pop("drive.supply_v") == train.supply_v
    assert usual.pop("drive.current_a") * 2**0.5 == pytest.approx(train.peak_current_a)
    assert usual.pop("motor.full_steps_per_rev") == train.periods_per_rev * 4
    assert [usual.pop(f"motor.measured_with.{name}") for name in ("supply_v", "current_a")] == [24, 2]
    assert usual.pop("load.mechanism.efficiency") == mechanism.EFFICIENCY
    assert set(usual.values()) == {0}, "nothing at all"
    # What the mass is known to rub by needs no guess beside it.
    told = with_motor(load={"mechanism": {"name": "screw", "lead_mm": 8, "mass_kg": 1, "friction_n": 3}})
    assert modules.evaluate(script, told)["load.friction_nm"] == 0


@pytest.mark.parametrize("name", mechanism.NEEDED)
def test_a_mechanism_begins_with_what_the_server_takes(modules: Modules, name: mechanism.MechanismName) -> None:
    design = with_motor(load={"inertia_g_cm2": 3.0}, axis={"travel_per_rev": 5, "travel_unit": "mm"})
    made = modules.call("model/mechanisms.js", "withMechanism", design, name)
    checked = Design.checked(made)
    assert checked.load
    assert checked.load.mechanism
    assert (checked.load.mechanism.name, checked.load.inertia_g_cm2) == (name, 3)
    # Five millimetres a turn: a screw's lead, or a belt on a pulley of that round it.
    reach = {"screw": ("lead_mm", 5), "belt": ("pulley_mm", 5 / 3.14159265), "pointer": ("inertia_g_cm2", 2)}[name]
    assert getattr(checked.load.mechanism, reach[0]) == pytest.approx(reach[1], rel=1e-3)
    own = {*mechanism.NEEDED[name], *mechanism.USUAL[name]}
    assert set(modules.call("model/mechanisms.js", "fieldsOfMechanism", name)) == own
    # Read as a file it is the same; and gone again it leaves nothing.
    script = """async (text) => (await import('/documents/documents.js')).readDocument(text)"""
    text = modules.evaluate("async (design) => JSON.stringify(design)", made)
    assert modules.evaluate(script, text)["document"]["axes"][0]["load"] == made["load"]
    assert modules.call("model/mechanisms.js", "withMechanism", made, "") == {**design, "load": {"inertia_g_cm2": 3.0}}


def test_another_mechanism_keeps_what_both_have(modules: Modules) -> None:
    screw = {"name": "screw", "lead_mm": 8, "mass_kg": 2.5, "efficiency": 0.9, "incline_deg": 90}
    belt = modules.call("model/mechanisms.js", "withMechanism", with_motor(load={"mechanism": screw}), "belt")
    assert belt["load"]["mechanism"] | {"pulley_mm": 1} == {
        "name": "belt", "pulley_mm": 1, "mass_kg": 2.5, "incline_deg": 90,
    }  # fmt: skip


@pytest.mark.parametrize(
    ("text", "points"),
    [
        ("100,0.35\n600,0.31", [[100, 0.35], [600, 0.31]]),
        ("rpm;Nm\r\n100;0.35\r\n\r\n600;0.31\r\n", [[100, 0.35], [600, 0.31]]),
        ("Speed [rpm]\tTorque [Nm]\n0\t0.4\n1,200\t0.2", [[0, 0.4], [1200, 0.2]]),
        ("100 0.35", [[100, 0.35]]),
        ("  ", []),
    ],
)
def test_a_torque_curve_is_read_as_it_is_pasted(modules: Modules, text: str, points: list[list[float]]) -> None:
    read = modules.call("model/torque_points.js", "torquePointsOf", text)
    assert read == {"points": points, "problems": []}
    again = modules.call("model/torque_points.js", "torquePointsText", points)
    assert modules.call("model/torque_points.js", "torquePointsOf", again)["points"] == points


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("100,0.35\n200,abc", "Line 2 is “200,abc”; allowed: two numbers"),
        ("rpm,Nm\n100,0.35,7", "Line 2 is “100,0.35,7”; allowed: two numbers"),
        ("rpm,Nm\nmore,words", "Line 2 is “more,words”"),
        ("100,0.35\n\n100,0.3", "Line 3: the speed is 100 rpm; allowed: more than 100 rpm"),
        ("\n".join(f"{rpm},0.1" for rpm in range(201)), "These are 201 points; allowed: 2 to 200"),
    ],
)
def test_a_line_that_is_no_point_is_named(modules: Modules, text: str, problem: str) -> None:
    [told] = modules.call("model/torque_points.js", "torquePointsOf", text)["problems"]
    assert told.startswith(problem)


@pytest.mark.parametrize(
    ("text", "hint"),
    [
        ("100;0,35\n200;0,31", "0.35"),
        ("100\t0,35", "0.35"),
        ("100, 0,35", "0.35"),
        ("100 0,35", "0.35"),
        ("100,0.35,7", None),
    ],
)
def test_a_decimal_comma_in_a_torque_curve_is_told_as_one(modules: Modules, text: str, hint: str | None) -> None:
    first = modules.call("model/torque_points.js", "torquePointsOf", text)["problems"][0]
    assert first.endswith(f" A point is expected for the comma: {hint}.") == (hint is not None)


@pytest.mark.parametrize("line", ["7,0.1", "0.1;7", "words"])
def test_of_far_too_many_lines_none_is_read(modules: Modules, line: str) -> None:
    read = modules.call("model/torque_points.js", "torquePointsOf", "\n".join([line] * 100_000))
    assert read == {"points": [], "problems": ["These are 100,000 points; allowed: 2 to 200."]}


def test_where_each_number_comes_from_is_told_as_the_server_says_it(modules: Modules) -> None:
    def origins(**parts: Any) -> dict[str, str]:
        told = modules.call("model/motor_origins.js", "originsOf", origins_of(Design.checked(with_motor(**parts))))
        return {one["word"]: one["text"] for one in told}

    assert origins() == {
        "By a data sheet": "holding torque, rated current, resistance, inductance, rotor inertia",
        "Guessed": "supply, current, friction, detent torque, pull-out factor, damping",
    }
    edited = {**NEMA_17, "inductance_mh": 3.5, "stalled": {"rpm": 1180, "torque_nm": 0.2}, "pull_out_factor": 0.8}
    told = origins(motor=edited, drive={"supply_v": 36}, load={"friction_nm": 0.02})
    assert told == {
        "Measured": "stall point",
        "By a data sheet": "holding torque, rated current, resistance, rotor inertia",
        "Your own": "supply, friction, inductance",
        "Guessed": "current, detent torque, damping",
        "Doesn’t count": "pull-out factor",
    }
    screw = {"name": "screw", "lead_mm": 8, "mass_kg": 1}
    assert "efficiency, incline" in origins(load={"mechanism": screw})["Guessed"]
    # A preset whose inertia its maker doesn't tell says so, and a curve was measured.
    script = """async () => (await import('/model/motors.js')).MOTORS"""
    presets = {one["name"]: one for one in modules.evaluate(script)}
    assert "rotor inertia" in origins(motor=presets["NEMA 11 · SY28STH45"]["motor"])["Guessed"]
    gauge = presets["Gauge · X27"]
    told = origins(**{part: gauge[part] for part in ("motor", "drive", "load")})
    assert told["By a data sheet"].startswith("supply, current, holding torque")
    assert told["Guessed"] == "torque curve, pointer inertia, friction, inductance, detent torque, RMS or peak, damping"
    assert origins(motor=gauge["motor"] | {"torque_curve": [[0, 1e-3], [9, 1e-4]]})["Measured"] == "torque curve"
    # Every path that the server tells has a name here.
    script = """async (paths) => { const {originsOf} = await import('/model/motor_origins.js');
        const told = originsOf(Object.fromEntries(paths.map((path) => [path, 'given'])));
        return told.find(({word}) => word === 'Your own').text.split(', '); }"""
    full = with_motor(
        motor={**NEMA_17, "full_steps_per_rev": 200, "detent_torque_nm": 0.02, "pull_out_factor": 0.8,
               "torque_curve": [[100, 0.3], [200, 0.2]], "stalled": {"rpm": 600, "torque_nm": 0.3},
               "measured_with": AT_24_V},
        drive=AT_24_V, load={"inertia_g_cm2": 3, "torque_nm": 0.1, "friction_nm": 0.02, "mechanism": screw},
    )  # fmt: skip
    paths = list(origins_of(Design.checked(full)))
    assert len(modules.evaluate(script, paths)) == len(paths)


def test_what_is_measured_is_told_with_what_drives_the_motor_then(modules: Modules) -> None:
    point = {"rpm": 600, "torque_nm": 0.3}
    noted = modules.call("model/measured.js", "withMeasured", with_motor(), "stalled", point)
    # What is left open is what stands for it: 24 V, and the rated 2 A as RMS.
    then = {"supply_v": 24, "current_a": 2, "current_is": "rms"}
    assert (noted["motor"]["stalled"], noted["motor"]["measured_with"]) == (point, then)
    checked = Design.checked(noted)
    # It stays with another drive, and with a curve besides.
    other = {**noted, "drive": {"supply_v": 48, "current_a": 1, "current_is": "peak"}}
    curve = [[100, 0.4], [600, 0.3]]
    both = modules.call("model/measured.js", "withMeasured", other, "torque_curve", curve)
    assert both["motor"]["measured_with"] == then
    script = """async (design) => { const {withMeasured} = await import('/model/measured.js');
        return withMeasured(withMeasured(design, 'stalled'), 'torque_curve'); }"""
    assert modules.evaluate(script, both) == {**other, "motor": NEMA_17}
    # A place on a map over the supply, of a design that doesn't tell it yet, tells it; the map stays its own.
    old = {**noted, "motor": {**NEMA_17, "stalled": point}}
    changes = stall_map(modules, "changesTo", old, "supply_voltage", {"acceleration": 4000, "value": 48})
    moved = modules.call("model/design.js", "withChanges", old, changes)
    assert (moved["motor"]["measured_with"], moved["drive"]["supply_v"]) == (then, 48)
    keys = [stall_map(modules, "mapKey", each, "supply_voltage") for each in (old, moved)]
    assert keys[0] == keys[1]
    trains = [Design.checked(each).drive_train for each in (old, moved)]
    assert trains[0]
    assert trains[1]
    assert trains[0].pull_out_factor == trains[1].pull_out_factor
    assert checked.drive_train == trains[0]
    # As a file it is the same.
    script = """async (text) => (await import('/documents/documents.js')).readDocument(text)"""
    text = modules.evaluate("async (design) => JSON.stringify(design)", moved)
    assert modules.evaluate(script, text)["document"]["axes"][0]["motor"] == moved["motor"]


def test_a_motor_brings_what_its_maker_fixes_and_takes_it_with_it(modules: Modules) -> None:
    script = """async ([design, ...names]) => { const {MOTORS, withMotor} = await import('/model/motors.js');
        return names.reduce((made, name) => withMotor(made, MOTORS.find((one) => one.name === name)), design); }"""
    design = document(load={"friction_nm": 0.01})
    gauge = modules.evaluate(script, [design, "Gauge · X27"])
    checked = Design.checked(gauge)
    assert checked.motor
    assert (checked.motor.kind, checked.axis.full_steps_per_rev, gauge["drive"]["supply_v"]) == ("gauge", 360, 5)
    back = modules.evaluate(script, [gauge, "NEMA 17 · 17HS4401"])
    assert not back.keys() & {"drive", "load"}
    assert back["axis"]["full_steps_per_rev"] == 200
    # What somebody typed stays.
    typed = {**gauge, "drive": gauge["drive"] | {"supply_v": 12}}
    assert modules.evaluate(script, [typed, "NEMA 17 · 17HS4401"])["drive"]["supply_v"] == 12
    one, other = (modules.evaluate(script, [design, name]) for name in ("NEMA 17 · 17HS4401", "Sanyo SS2421"))
    assert one["load"] == other["load"] == {"friction_nm": 0.01}
    Design.checked(one)


TORQUE = {
    "speed_steps_per_s": [0, 1000, 2000, 3000],
    "pull_out_nm": [0.5, 0.4, 0.25, 0.1],
    "required_nm": [0.3, 0.3, 0.12, 0.12],
}
ANSWER = {
    "torque": TORQUE,
    "resonances_steps_per_s": [[170, 230], [340, 460]],
    "greatest_start_speed_steps_per_s": 800,
    "greatest_sudden_acceleration_steps_per_s2": 5000,
    "first_lost_step": 3,
}
MARKS = """async ([answer, third, acceleration, units, low]) => {
    const { motorMarksOf } = await import('/plotting/motor_marks.js');
    const design = { axis: { full_steps_per_rev: 200, microsteps: 1, travel_per_rev: 8, travel_unit: 'mm' },
        method: { name: 'exact' } };
    const plot = (name, top, range) => ({ name, top, height: 100, range: { isLog: false, ...range }, isVisible: true });
    const frame = { left: 50, width: 200, x: { low, high: 10, isLog: false },
        plots: [plot('velocity', 0, { low: 0, high: 2000 }), plot('error', 200, { low: -10000, high: 10000 })],
        acceleration: acceleration ? { low: 0, high: 10000, isLog: false } : null };
    const curve = { step: [1, 5, 9], x: [1, 5, 9], shownSpeed: [0, 1000, 1000] };
    return motorMarksOf(answer, frame, { answer: { design, units }, curves: { exact: curve }, third }); }"""


def marks(modules: Modules, third: str = "error", *, acceleration: bool = False, low: float = 0, **changes: Any) -> Any:
    units = {"length": "steps", "time": "s"}
    return modules.evaluate(MARKS, [{**ANSWER, **changes}, third, acceleration, units, low])


def test_what_a_motor_can_do_lies_in_the_plots_where_its_speeds_are(modules: Modules) -> None:
    found = marks(modules)
    by_name: dict[str, list[Any]] = {}
    for mark in found["marks"]:
        by_name.setdefault(mark["name"], []).append(mark)
    # 2,000 steps/s at the top of 100 px.
    assert [(band["y"], band["height"]) for band in by_name["band"]] == [(88.5, 3), (77, 6)]
    assert [(mark["y"], mark["height"], mark["text"]) for mark in by_name["start"]] == [
        (60, 0, "starts at once up to 800 steps/s")
    ]
    # Load and friction ask for .12 Nm; .6 of what it has is .15 at 2,000 steps/s, and .06 at 3,000.
    assert [(mark["y"], mark["text"]) for mark in by_name["top"]] == [(0, "enough torque up to 2,000 steps/s")]
    assert "resonance 340 to 460 steps/s" in [band["text"] for band in by_name["band"]]
    assert "sudden" not in by_name
    # Step 3 is half way to 1,000 steps/s.
    assert found["lost"] == {"x": 110, "y": 75, "text": "step 3 is lost"}


def test_the_greatest_sudden_acceleration_is_drawn_where_accelerations_are(modules: Modules) -> None:
    def sudden(**shown: Any) -> list[tuple[float, str]]:
        return [(one["y"], one["text"]) for one in marks(modules, **shown)["marks"] if one["name"] == "sudden"]

    assert sudden(third="acceleration") == [(225, "may come at once up to 5,000"), (275, "")]
    assert sudden(acceleration=True) == [(50, "may come at once up to 5,000, at the right")]
    assert sudden(third="acceleration", greatest_sudden_acceleration_steps_per_s2=0) == []


@pytest.mark.parametrize(
    ("value", "told"),
    [(1049.7, "1,049"), (1050.0, "1,050"), (99.96, "99.9"), (0.29, "0.290"), (0, "0.00"), (123456.9, "123,456")],
)
def test_what_may_be_at_most_is_never_told_as_more(modules: Modules, value: float, told: str) -> None:
    shown = modules.evaluate("async (value) => (await import('/model/numbers.js')).formatHighest(value, 3)", value)
    assert shown == told
    start = marks(modules, greatest_start_speed_steps_per_s=800.9)["marks"]
    assert "starts at once up to 800 steps/s" in [one["text"] for one in start]


def test_nothing_is_marked_that_lies_elsewhere_or_does_not_happen(modules: Modules) -> None:
    assert marks(modules, first_lost_step=None)["lost"] is None
    assert marks(modules, low=4)["lost"] is None
    enough = {**TORQUE, "pull_out_nm": [0.5, 0.5, 0.5, 0.5]}
    names = {one["name"] for one in marks(modules, torque=enough, greatest_start_speed_steps_per_s=9000)["marks"]}
    assert names == {"band"}


def test_texts_that_would_lie_on_each_other_are_left_out(modules: Modules) -> None:
    found = marks(modules, greatest_start_speed_steps_per_s=420, resonances_steps_per_s=[[380, 420]])["marks"]
    assert [one["text"] for one in found] == [
        "",
        "starts at once up to 420 steps/s",
        "enough torque up to 2,000 steps/s",
    ]


def test_what_the_rotor_does_is_told_for_each_damping(modules: Modules) -> None:
    run = {
        "lost_full_steps": 0, "first_lost_step": None, "largest_load_angle_deg": 45.2, "speed_ripple": 0.0123,
        "overshoot_deg": 9.0, "settled_after_s": 0.0254,
    }  # fmt: skip
    lost = run | {"lost_full_steps": -8, "first_lost_step": 1200, "speed_ripple": None, "settled_after_s": 0.12}
    rows = modules.call("model/rotor_runs.js", "runRows", {"runs": [lost, run], "natural_frequency_hz": 100})
    assert [row["texts"] for row in rows] == [
        ["8", "0"], ["1,200", "none"], ["45°", "45°"], ["no slew", "± 1.2 %"],
        ["0.10 full steps", "0.10 full steps"], ["not within 120 ms", "25 ms"],
    ]  # fmt: skip


def test_a_ramp_that_is_in_use_is_known_by_what_it_changes(modules: Modules) -> None:
    def is_in_use(design: dict[str, Any], *changes: tuple[str, object]) -> bool:
        made = [{"field": field, "value": value} for field, value in changes]
        return bool(modules.call("model/fastest_ramps.js", "isInUse", design, made))

    steep, constant = ("ramp.acceleration_steps_per_s2", 4000.0), ("ramp.shape", {"name": "constant"})
    shaped = ("ramp.shape", {"name": "torque", "margin": 0.5})
    design = document(ramp__acceleration_steps_per_s2=4000.0)
    assert is_in_use(design, steep, constant)
    assert not is_in_use(design, steep, shaped)
    assert not is_in_use(document(ramp__acceleration_steps_per_s2=4100.0), steep, constant)
    changes = [{"field": field, "value": value} for field, value in (steep, shaped)]
    assert is_in_use(modules.call("model/design.js", "withChanges", design, changes), steep, shaped)


VALUES = [1000.0 * 2**power for power in range(5)]
MAP = {
    "over": "slew_speed",
    "over_values": VALUES,
    "over_spacing": "ratios",
    "accelerations_steps_per_s2": [100.0, 1000.0, 10000.0],
    "verdicts": [[0, 0, 0, 1, 2], [0, 0, 1, 2, 2], [-1, 1, 2, 2, 3]],
}


def stall_map(modules: Modules, function: str, *arguments: object) -> Any:
    return modules.call("model/stall_map.js", function, *arguments)


def test_a_map_is_read_at_its_nearest_point_along_its_axes(modules: Modules) -> None:
    axis = stall_map(modules, "axesOf", MAP)["over"]
    assert [stall_map(modules, "shareOf", axis, value) for value in (1000, 4000, 16000, 500)] == [0, 0.5, 1, -0.25]
    # A load may be none or less: it goes evenly. So it does where its few values might be in ratios as well.
    assert stall_map(modules, "shareOf", {"values": [-1, 0, 1], "spacing": "even"}, 0) == 0.5
    assert stall_map(modules, "shareOf", {"values": [9, 9.01, 9.02], "spacing": "even"}, 9.005) == pytest.approx(0.25)
    assert stall_map(modules, "shareOf", {"values": [1, 4], "spacing": "ratios"}, 2) == pytest.approx(0.5)
    for share in (0, 0.3, 1):
        value = stall_map(modules, "valueAtShare", axis, share)
        assert stall_map(modules, "shareOf", axis, value) == pytest.approx(share)
    read = {
        (acceleration, value): stall_map(modules, "verdictAt", MAP, {"acceleration": acceleration, "value": value})
        for acceleration, value in ((100, 1000), (150, 15000), (2000, 4100), (9000, 1000), (100, 90000), (1, 2000))
    }
    assert list(read.values()) == [0, 2, 1, -1, None, None]
    assert stall_map(modules, "partsOf", MAP["verdicts"]) == [5 / 14, 3 / 14, 5 / 14, 1 / 14]


def test_what_a_map_has_is_told_with_how_much_of_it_is_known(modules: Modules) -> None:
    def text(verdicts: list[list[int]], *, old: bool = False) -> str:
        return str(stall_map(modules, "mapText", verdicts, old))

    assert text([[0, 0], [1, 2]]) == "Of the map: safe 50 %, marginal 25 %, stalls 25 %."
    assert text([[2, 2]], old=True) == "Of the earlier map: stalls 100 %."
    assert text([[2, -1], [-1, 0]]) == "Of what is known of the map, 50 % of it: safe 50 %, stalls 50 %."
    assert text([[2, *[-1] * 999]]) == "Of what is known of the map, under 1 % of it: stalls 100 %."
    assert text([[-1], *[[0]] * 999]) == "Of what is known of the map, 99 % of it: safe 100 %.", "never all of it"
    assert text([[-1, -1]]) == ""


def test_the_stretches_of_a_map_cover_it_once(modules: Modules) -> None:
    stretches = stall_map(modules, "stretchesOf", MAP["verdicts"])
    covered = [(one["row"], column, one["verdict"]) for one in stretches for column in range(one["from"], one["to"])]
    assert sorted(covered) == [
        (row, column, verdict) for row, line in enumerate(MAP["verdicts"]) for column, verdict in enumerate(line)
    ]
    assert len(stretches) == 10


def test_a_place_on_a_map_is_a_change_of_the_design_that_the_map_stays_of(modules: Modules) -> None:
    ramp = {"ramp__acceleration_steps_per_s2": 4000.0, "ramp__deceleration_steps_per_s2": 2000.0}
    for over, value in (("slew_speed", 900), ("load", 0.25), ("supply_voltage", 36)):
        design = with_motor(**ramp)
        place = {"acceleration": 5000.4, "value": value}
        changes = stall_map(modules, "changesTo", design, over, place)
        moved = modules.call("model/design.js", "withChanges", design, changes)
        Design.checked(moved)
        assert (moved["ramp"]["acceleration_steps_per_s2"], moved["ramp"]["deceleration_steps_per_s2"]) == (5000, 2500)
        assert stall_map(modules, "placeOf", moved, over) == {"acceleration": 5000, "value": value}
        key = stall_map(modules, "mapKey", design, over)
        assert stall_map(modules, "mapKey", {**moved, "name": "Another"}, over) == key
        assert stall_map(modules, "mapKey", {**moved, "motor": {**NEMA_17, "inductance_mh": 5}}, over) != key
        steeper = {**moved, "ramp": {**moved["ramp"], "deceleration_steps_per_s2": 5000}}
        assert stall_map(modules, "mapKey", steeper, over) != key


def test_what_shows_a_verdict_is_told_where_it_isn_t_the_rotor(modules: Modules) -> None:
    found = {"cause": "top_speed", "lost_full_steps": 0, "first_lost_step": None}
    texts = {
        evidence: modules.call("model/motor_words.js", "causeText", found | {"evidence": evidence})
        for evidence in ("torque", "measured_torque", "no_torque")
    }
    little = ": there is too little torque at speed"
    assert texts == {
        "torque": little,
        "measured_torque": f"{little}, by the torque that was measured and not by the model",
        "no_torque": f"{little}, where the motor has no torque at all",
    }
    used = [modules.call("model/motor_words.js", "usedText", share) for share in (0.62, 3.32, None)]
    assert used == ["62 %", "332 %", "more than there is"]
    figures = dict.fromkeys(["duration_s", "ramp_up_s", "peak_speed_steps_per_s", "acceleration_steps_per_s2"], 1.0)
    units = {"length": "steps", "time": "s"}
    rows = modules.call("model/fastest_ramps.js", "figuresOf", figures | {"most_used": None}, units, document())
    assert rows[-1] == ["Torque used", "more than there is"]
