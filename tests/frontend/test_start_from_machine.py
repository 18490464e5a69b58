"""What a machine tells of its ramp and its scale, given to a design."""

from typing import Any

import pytest

from designs import document
from frontend.dialogs import run
from frontend.modules import Modules
from stepramp.controllers.capabilities import MENDING
from stepramp.controllers.klipper.read_settings import read_settings as read_klipper
from stepramp.design import Design

START = """async ([design, found, meanwhile]) => {
    const {FIRST_STATE, createStore} = await import('/app/state.js');
    const {COMMANDS} = await import('/app/commands/commands.js');
    const {createDeviceActions} = await import('/app/effects/device_actions.js');
    const {api} = await import('/server/api.js');
    const {createGestures} = await import('/server/gestures.js');
    const real = api.importDevice;
    const store = createStore(FIRST_STATE, (error) => { throw error; });
    const axes = [design, {...design, name: 'B'}];
    store.dispatch(COMMANDS.work.begin, {axes, together: 'independent', ids: [5, 7], active: 0, kept: null});
    api.importDevice = async () => {
        for (const [verb, ...args] of meanwhile) store.dispatch(COMMANDS.work[verb], ...args);
        return {axes: [{design: found, remarks: [], remarks_told: []}]}; };
    const actions = createDeviceActions(store, createGestures(), new Map(), {outdate: () => {}});
    await actions.startFrom({id: '1', stops: 0}, 0, design, 5);
    api.importDevice = real;
    const {axes: now, ids, active} = store.state().history.present;
    return {designs: Object.fromEntries(ids.map((id, place) => [id, now[place]])), inHand: ids[active],
        notice: store.state().told.notice.text}; }"""
STEPPERS = "\n".join(
    f"[stepper_{axis}]\nmicrosteps: 32\nfull_steps_per_rotation: 400\nrotation_distance: 30" for axis in "xyz"
)
KLIPPER = f"{STEPPERS}\n[printer]\nkinematics: cartesian\nmax_velocity: 200\nmax_accel: 2500\n"


def test_a_design_that_starts_from_a_machine_has_all_that_the_machine_tells(modules: Modules) -> None:
    """Travel and speeds rest on the steps of a turn; a Klipper's ramp has no shape of the design's."""
    own = document(schema="stepramp/2", ramp__shape={"name": "s_curve", "jerk_steps_per_s3": 50_000})
    found, *_ = read_klipper(KLIPPER, Design.checked(own))
    told = found.design.model_dump(mode="json", by_alias=True)
    started = modules.evaluate(START, [own, told, []])["designs"]["5"]
    assert (started["axis"]["microsteps"], started["axis"]["full_steps_per_rev"]) == (32, 400)
    assert (started["axis"], started["ramp"]) == (told["axis"], told["ramp"])
    assert "shape" not in started["ramp"]
    unsaid = modules.evaluate(START, [own, own, []])["designs"]["5"]
    assert unsaid == own, "what an answer leaves as the design has it stays"


def test_an_answer_of_a_machine_goes_to_the_axis_that_was_asked_for(modules: Modules) -> None:
    found = document(ramp__slew_speed_steps_per_s=777, axis__microsteps=32)
    speed = ("ramp", "slew_speed_steps_per_s")

    def speeds(meanwhile: list[list[object]]) -> tuple[dict[str, object], Any]:
        started = modules.evaluate(START, [document(), found, meanwhile])
        return {key: one[speed[0]][speed[1]] for key, one in started["designs"].items()}, started

    assert speeds([])[0] == {"5": 777, "7": 1000}
    changed, started = speeds([["choose", 7]])
    assert changed == {"5": 777, "7": 1000}
    assert started["inHand"] == 5, "what was changed is in view"
    changed, started = speeds([["removeAxis", 5]])
    assert changed == {"7": 1000}
    assert "removed meanwhile" in started["notice"]


PRESSED = """
    const {FIRST_STATE, createStore} = await import('/app/state.js');
    const {COMMANDS} = await import('/app/commands/commands.js');
    const {createDevice} = await import('/panels/device/device.js');
    const store = createStore(FIRST_STATE, (error) => { throw error; });
    const {dispatch} = store, started = [];
    const finer = {...design, name: 'B', axis: {...design.axis, microsteps: 16}};
    dispatch(COMMANDS.work.begin, {axes: [design, finer], together: 'independent', ids: [5, 7], active: 0, kept: null});
    const axes = [100, 400].map((steps_per_mm, axis) => ({axis, state: 'ready', position_steps: 0, target_steps: 0,
        speed_steps_per_s: 0, steps_per_mm, lowest_steps: null, highest_steps: null}));
    dispatch(COMMANDS.device.heard, [{id: '1', port: 'sim://', name: 'Simulated', family: 'grbl', state: 'ready', axes,
        most_axes: MOST, stops: 0, capabilities: ['import'], in_control: null,
        unknown_positions: [], shuttle: null, progress: null, unproven: [], proof: null, ramp: null}], {});
    dispatch(COMMANDS.device.linked, 'there');
    dispatch(COMMANDS.device.chooseAxis, 1);
    const panel = createDevice(body, dispatch, {startFrom: (...told) => started.push(told.slice(1)),
        jog: {end() {}, steer() {}}});
    panel.show(store.state());
    byId('use-scale').onclick();
    const {axes: now, ids, active} = store.state().history.present;
    byId('start-from').onclick();
    return [now.map(({axis}) => axis.travel_per_rev), ids[active],
        started.map(([axis, {name}, axisId]) => [axis, name, axisId])];"""


@pytest.mark.parametrize(
    ("most_axes", "travel_mm", "start"),
    [
        # Axis 1 of the device has the design of axis 7: 200 · 16 steps a turn at 400 steps/mm.
        (4, [8, 8], [1, "B", 7]),
        # Of a device that can't have both, it has that of the axis in hand: 200 · 2 at 400 steps/mm.
        (1, [1, 8], [1, "Test", 5]),
    ],
)
def test_what_a_machine_is_set_to_goes_to_the_axis_that_it_was_computed_for(
    modules: Modules, most_axes: int, travel_mm: list[float], start: list[object]
) -> None:
    travel, in_hand, started = run(modules, PRESSED.replace("MOST", str(most_axes)))
    assert travel == travel_mm
    assert in_hand == start[-1]
    assert started == [start]


LOST = """
    const {FIRST_STATE, createStore} = await import('/app/state.js');
    const {COMMANDS} = await import('/app/commands/commands.js');
    const {createDevice} = await import('/panels/device/device.js');
    const store = createStore(FIRST_STATE, (error) => { throw error; });
    const {dispatch} = store;
    dispatch(COMMANDS.work.begin, {axes: [design], together: 'independent', ids: [5], active: 0, kept: null});
    const panel = createDevice(body, dispatch, {jog: {end() {}, steer() {}}});
    dispatch(COMMANDS.device.linked, 'there');
    return ['lost', 'ready'].map((state) => {
        dispatch(COMMANDS.device.heard, [{id: '1', port: 'sim://', name: 'Simulated', family: 'grbl', state,
            axes: [{axis: 0, state: 'ready', position_steps: 7, target_steps: 7, speed_steps_per_s: 0,
                steps_per_mm: 80, lowest_steps: null, highest_steps: null}],
            most_axes: 1, stops: 0, capabilities: [], in_control: null, unknown_positions: [0], shuttle: null,
            progress: null, unproven: [], proof: null, ramp: null}], {});
        panel.show(store.state());
        return byId('unknown-position').hidden; });"""


def test_what_is_lost_is_not_said_to_be_back(modules: Modules) -> None:
    assert run(modules, LOST) == [True, False]


# A device of two axes, at the scales that are given; `typed(id, text)` types into a field.
SCALED = """
    const {FIRST_STATE, createStore} = await import('/app/state.js');
    const {COMMANDS} = await import('/app/commands/commands.js');
    const {createDevice} = await import('/panels/device/device.js');
    const store = createStore(FIRST_STATE, (error) => { throw error; });
    const {dispatch} = store, asked = [];
    const one = {...design, axis: {...design.axis, travel_per_rev: 8, travel_unit: 'mm'}};
    dispatch(COMMANDS.work.begin, {axes: [one], together: 'independent', ids: [5], active: 0, kept: null});
    dispatch(COMMANDS.view.setUnits, {length: 'mm', time: 's'});
    dispatch(COMMANDS.device.linked, 'there');
    const device = (scales, state = 'ready') => ({id: '1', port: 'sim://', name: 'Simulated', family: 'grbl', state,
        axes: scales.map((steps_per_mm, axis) => ({axis, state: 'ready', position_told: true, position_steps: 500,
            target_steps: 500, speed_steps_per_s: 0, steps_per_mm, microsteps: null,
            lowest_steps: -1000, highest_steps: 10_000})),
        most_axes: 2, stops: 0, capabilities: ['line'], in_control: null, unknown_positions: [], shuttle: null,
        progress: null, unproven: [], proof: null, ramp: {sequence: null, crc: null}});
    const tell = (...told) => { dispatch(COMMANDS.device.heard, [device(...told)], {}); panel.show(store.state()); };
    const root = made('div');
    body.append(root);
    const act = {jog: {end() {}, begin() {}},
        go: (_, axis, what, sent) => asked.push([axis, what, sent]),
        setPosition: (_, axis, steps) => asked.push([axis, 'position', steps])};
    const panel = createDevice(root, dispatch, act);
    const typed = (id, text) => { byId(id).value = text; byId(id).oninput(); };
    const form = find(body, (each) => each.tag === 'form');
    const section = (name) => { dispatch(COMMANDS.device.chooseSection, name); panel.show(store.state()); };
    const axis = (at) => { dispatch(COMMANDS.device.chooseAxis, at); panel.show(store.state()); };
    const submit = () => form.onsubmit({preventDefault() {}});
    const shown = (...ids) => ids.map((id) => byId(id).hidden ? '' : textOf(byId(id)));
"""


def test_lengths_of_a_device_are_shown_and_sent_by_the_scale_that_its_controller_tells(modules: Modules) -> None:
    """The design has 50 steps/mm: a fifth of the way would be moved, and told as the whole of it."""
    script = (
        SCALED
        + """ tell([250, 400]); section('move');
        typed('move-steps', '5'); form.oninput(); submit();
        const move = shown('live-position', 'live-limits', 'move-in-steps', 'move-scale');
        section('jog'); typed('jog-speed', '2'); typed('set-position', '5'); byId('run-ahead').onclick();
        byId('set-position-button').onclick();
        const jog = shown('jog-scale'); axis(1);
        return [asked.map(([, what, sent]) => sent.by_steps ?? sent.axes?.[0].speed_steps_per_s ?? sent), move, jog,
            shown('live-position', 'jog-scale')]; """
    )
    sent, move, jog, second = run(modules, script)
    assert sent == [1250, 500, 1250]
    note = "Lengths here are the machine’s: 250 steps/mm; the design has 50."
    assert move == ["2.00000", "Soft limits: \u22124 to 40 mm", "1,250 steps", note]
    assert jog == [note]
    assert second == ["1.25000", "Lengths here are the machine’s: 400 steps/mm; the design has 50."]


def test_a_place_that_the_controller_does_not_tell_is_none(modules: Modules) -> None:
    script = (
        SCALED
        + """ tell([50]); const told = shown('live-position', 'beyond-limits');
        const untold = device([50]); untold.axes[0].position_told = false;
        dispatch(COMMANDS.device.heard, [untold], {}); panel.show(store.state());
        return [...told, ...shown('live-position', 'live-speed'), textOf(body).includes('not told')]; """
    )
    assert run(modules, script) == ["10.0000", "", "–", "0.000", True]


def test_each_axis_of_a_line_has_its_own_scale(modules: Modules) -> None:
    script = (
        SCALED
        + """ tell([250, 400]); section('move');
        find(body, (each) => each['data-value'] === 'line').onclick();
        for (const at of [0, 1]) typed(`line-${at}`, '1');
        form.oninput(); submit();
        return [asked[0][2].axes, shown('line-0-in-steps', 'line-1-in-steps', 'line-2-in-steps', 'move-scale')]; """
    )
    axes, steps = run(modules, script)
    assert axes == [{"axis": 0, "by_steps": 250}, {"axis": 1, "by_steps": 400}]
    assert steps[:3] == ["250 steps", "400 steps", ""]
    told = "axis 0 has 250 steps/mm, its design 50; axis 1 has 400 steps/mm, its design 50."
    assert steps[3] == f"Lengths here are the machine’s: {told}"


def test_what_is_typed_stays_while_a_device_with_a_scale_of_its_own_is_heard(modules: Modules) -> None:
    script = (
        SCALED
        + """ tell([250, 400]); section('move'); typed('move-steps', '5.000');
        tell([250, 400]); tell([250, 400], 'moving'); const typing = byId('move-steps').value;
        dispatch(COMMANDS.view.setUnits, {length: 'steps', time: 's'}); panel.show(store.state());
        return [typing, byId('move-steps').value, ...shown('move-scale', 'jog-scale', 'live-position')]; """
    )
    assert run(modules, script) == ["5.000", "1,250", "", "", "500"]


def test_a_scale_that_is_the_designs_or_not_known_says_nothing(modules: Modules) -> None:
    script = (
        SCALED
        + """ return [50, 50.0000001, null].map((scale) => {
        tell([scale]); section('move'); return shown('live-position', 'move-scale'); }); """
    )
    assert run(modules, script) == [["10.0000", ""]] * 3


# The same of a device that counts in microsteps of its own, so many of a full step.
FINER = SCALED.replace("scales.map((steps_per_mm, axis)", "scales.map((microsteps, axis)").replace(
    "steps_per_mm, microsteps: null", "steps_per_mm: null, microsteps"
)


def test_lengths_of_a_device_are_shown_and_sent_by_the_microsteps_that_its_controller_tells(modules: Modules) -> None:
    """The design has 2 of a full step, 50 steps/mm: of 16 an eighth of the way would be moved."""
    script = (
        FINER
        + """ tell([16, 2]); section('move');
        typed('move-steps', '5'); form.oninput(); submit();
        const move = shown('live-position', 'live-limits', 'move-in-steps', 'move-scale');
        section('jog'); typed('jog-speed', '2'); typed('set-position', '5'); byId('run-ahead').onclick();
        byId('set-position-button').onclick();
        const jog = shown('jog-scale'); axis(1);
        return [asked.map(([, what, sent]) => sent.by_steps ?? sent.axes?.[0].speed_steps_per_s ?? sent), move, jog,
            shown('live-position', 'jog-scale')]; """
    )
    sent, move, jog, second = run(modules, script)
    assert sent == [2000, 800, 2000]
    note = "Lengths here are the machine’s: 16 microsteps; the design has 2."
    assert move == ["1.25000", "Soft limits: \u22122.5 to 25 mm", "2,000 steps", note]
    assert jog == [note]
    assert second == ["10.0000", ""]


@pytest.mark.parametrize(("unit", "asked", "place"), [("deg", 36, "56.2500"), ("rev", 0.1, "0.156250")])
def test_degrees_and_turns_are_by_the_microsteps_too(modules: Modules, unit: str, asked: float, place: str) -> None:
    """3200 steps a turn, the design has 400."""
    script = (
        FINER
        + f""" tell([16, 16]); dispatch(COMMANDS.view.setUnits, {{length: '{unit}', time: 's'}});
        panel.show(store.state()); section('move'); typed('move-steps', '{asked}'); form.oninput(); submit();
        return [asked[0][2].by_steps, ...shown('live-position', 'move-scale')]; """
    )
    assert run(modules, script) == [320, place, "Lengths here are the machine’s: 16 microsteps; the design has 2."]


def test_each_axis_of_a_line_has_its_own_microsteps(modules: Modules) -> None:
    script = (
        FINER
        + """ tell([16, 2]); section('move');
        find(body, (each) => each['data-value'] === 'line').onclick();
        for (const at of [0, 1]) typed(`line-${at}`, '1');
        form.oninput(); submit();
        return [asked[0][2].axes.map(({by_steps}) => by_steps), ...shown('move-scale')]; """
    )
    told = "Lengths here are the machine’s: axis 0 has 16 microsteps, its design 2."
    assert run(modules, script) == [[400, 50], told]


def test_microsteps_that_are_the_designs_or_not_known_say_nothing(modules: Modules) -> None:
    script = (
        FINER
        + """ return [2, null].map((microsteps) => {
        tell([microsteps]); section('move'); return shown('live-position', 'move-scale', 'machine-scale'); }); """
    )
    assert run(modules, script) == [["10.0000", "", ""]] * 2


def test_a_design_takes_the_microsteps_of_a_machine(modules: Modules) -> None:
    script = (
        FINER
        + """ tell([16]); const told = shown('machine-scale'); byId('use-scale').onclick(); panel.show(store.state());
        const {microsteps, travel_per_rev} = store.state().history.present.axes[0].axis;
        return [...told, microsteps, travel_per_rev, ...shown('machine-scale', 'use-scale')]; """
    )
    told = "The controller is set to 16 microsteps, the design has 2."
    assert run(modules, script) == [told, 16, 8, "", ""]


def test_soft_limits_are_set_by_the_scale_of_their_axis(modules: Modules) -> None:
    script = (
        SCALED
        + """ tell([250, 400]); byId('settings').onclick(); await settled();
        return [0, 1].flatMap((at) => [byId(`limit-${at}-lowest`).value, byId(`limit-${at}-highest`).value]); """
    )
    assert run(modules, script) == ["-4", "40", "-2.5", "25"]


LIMITS = """ const limits = (axis, lowest_steps, highest_steps) => ({axis, lowest_steps, highest_steps});
    const kept = (...all) => { dispatch(COMMANDS.device.limitsKept, 'sim://', all); panel.show(store.state()); };
    const again = []; act.limitAgain = (_, axes) => again.push(axes);
    const words = () => find(byId('limits-offer'), ({tag}) => tag === 'span').textContent;
    const offered = () => byId('limits-offer').hidden ? '' : words();
    const button = () => [byId('set-limits').hidden, byId('set-limits').disabled]; """


def test_soft_limits_that_are_not_in_force_are_told_by_the_scale_of_their_axis(modules: Modules) -> None:
    script = (
        SCALED
        + LIMITS
        + """ tell([250, 400]); kept({...limits(1, 0, 4000), steps_per_mm: 400, microsteps: null});
        byId('set-limits').onclick();
        return [offered(), button(), again]; """
    )
    limits = [{"axis": 1, "lowest_steps": 0, "highest_steps": 4000}]
    words = "Soft limits of this port, axis 1 0 to 10 mm, are not in force."
    assert run(modules, script) == [words, [False, False], [limits]]


def test_soft_limits_that_would_be_at_other_places_are_said_and_not_offered(modules: Modules) -> None:
    script = (
        SCALED
        + LIMITS
        + """ const then = {steps_per_mm: 250, microsteps: null}, first = {...limits(0, -2500, 12500), ...then};
        kept(first); tell([125]);
        const seen = [[offered(), button()]];
        tell([125], 'connecting'); seen.push([offered(), button()]);
        kept(first, {...limits(1, 0, 2500), ...then}); tell([125, 250]); byId('set-limits').onclick();
        return [...seen, [offered(), button()], again]; """
    )
    words = "Soft limits of this port, \u221210 to 50 mm, are not in force."
    why = "were set while it made 250 steps per mm, and by now it makes 125, so they may be at other places"
    anew = "set them anew in the device settings."
    both = "Soft limits of this port, axis 0 \u221210 to 50 mm, axis 1 0 to 10 mm, are not in force."
    assert run(modules, script) == [
        [f"{words} They {why}: {anew}", [True, False]],
        [words, [False, True]],
        [f"{both} Those of axis 0 {why}: {anew}", [False, False]],
        [[{"axis": 1, "lowest_steps": 0, "highest_steps": 2500}]],
    ]


SHOWN = """
    const {FIRST_STATE, createStore} = await import('/app/state.js');
    const {COMMANDS} = await import('/app/commands/commands.js');
    const {createDevice} = await import('/panels/device/device.js');
    const store = createStore(FIRST_STATE, (error) => { throw error; });
    const {dispatch} = store;
    dispatch(COMMANDS.work.begin, {axes: [design], together: 'independent', ids: [5], active: 0, kept: null});
    const panel = createDevice(body, dispatch, {jog: {end() {}, steer() {}}});
    dispatch(COMMANDS.device.linked, 'there');
    const tell = (told) => {
        dispatch(COMMANDS.device.heard, [{id: '1', port: 'sim://', name: 'Simulated', family: 'grbl', state: 'ready',
            axes: [{axis: 0, state: 'ready', position_steps: 7, target_steps: 7, speed_steps_per_s: 0,
                steps_per_mm: 80, lowest_steps: null, highest_steps: null}],
            most_axes: 1, stops: 0, capabilities: [], in_control: null, unknown_positions: [], shuttle: null,
            progress: null, unproven: [], proof: null, ramp: null, message: null, timer_hz: null, ...told}], {});
        panel.show(store.state()); };
    """


def test_a_cause_is_said_once(modules: Modules) -> None:
    told = (
        SHOWN
        + """
    const refuse = (message) => dispatch(COMMANDS.device.refused, [{field: null, value: null, allowed: null, message}]);
    const problem = find(body, (one) => one.className === 'problem');
    const seen = [];
    refuse('It does not answer.'); tell({state: 'lost', message: 'It does not answer. It was given settings.'});
    seen.push(textOf(problem).trim());
    refuse('Not so.'); tell({state: 'lost', message: 'It does not answer.'}); seen.push(textOf(problem).trim());
    tell({message: 'Unlock it.'}); seen.push(textOf(problem).trim());
    return seen;"""
    )
    first, other, back = run(modules, told)
    assert first == "It does not answer. It was given settings. It is connected again once it is back."
    assert other == "It does not answer. It is connected again once it is back. Not so."
    assert back == "Unlock it."


def test_a_controller_that_works_its_ramps_out_itself_is_told_no_segments(modules: Modules) -> None:
    told = (
        SHOWN
        + """
    const seen = [];
    for (const timer_hz of [null, 1_000_000]) {
        tell({state: 'writing', timer_hz, progress: {stage: 'planning', bytes_done: 0, bytes_total: 0}});
        seen.push(textOf(byId('push-progress')).trim());
    }
    tell({});
    return seen;"""
    )
    assert run(modules, told) == ["Reading its settings …", "Working out the segments …"]


# A grbl of two axes to which something was pushed; `sees()` what its panel says of whether that is stored.
GIVEN = (
    SHOWN.replace("capabilities: []", "capabilities: ['keep', 'backup', 'import', 'prove'], backup: 'saved'")
    .replace(
        "const panel = createDevice(body",
        """dispatch(COMMANDS.device.chooseAxis, 1);
    const root = made('div'); body.append(root);
    const panel = createDevice(root""",
    )
    .replace(
        "{jog: {end() {}, steer() {}}}",
        """{jog: {end() {}, steer() {}},
            listBackups: async () => ({backups: [{name: '2026-11-28T06-00-00.000000Z'}], unreadable: []})}""",
    )
    .replace("most_axes: 1", "most_axes: 2")
    + """
    const axes = [0, 1].map((axis) => ({axis, state: 'ready', position_steps: 7, target_steps: 7, speed_steps_per_s: 0,
        steps_per_mm: 80, lowest_steps: null, highest_steps: null}));
    const item = {name: 'Full speed', unit: 'steps/s', axis: 1, requested: 900, sent: 900, read_back: 900,
        own: {term: '$111', unit: 'mm/min', sent: 216, on_device: 216}};
    const pushed = {items: [item], verified: true, segments: null, bytes: 25, largest_deviation_us: null,
        sequence: null, warnings: [], warnings_told: []};
    const pending = {axes, pushed, unproven: ['$111'], unproven_words: '$111 is in use. Wait, or restart it now.'};
    const away = {...pending, state: 'connecting', proving: true};
    const stored = {proven: ['$111'], not_kept: [], others: [], stored: 'Stored: $111.', words: 'Stored: $111.'};
    const other = {proven: [], not_kept: ['$111'], stored: null, words: 'Another.',
        others: [{name: '$111', written: '216.000', at: 'then', now: '500.000'}]};
    const given = (id) => { const one = byId(id); return one.hidden ? '' : textOf(one).trim(); };
    const report = () => { const [bar, details] = byId('push-report').children;
        const [head, ...more] = details.children;
        return {bar: bar.children.filter((one) => !one.hidden).map((one) => one.className),
            head: details.hidden ? '' : textOf(head).trim(), more: details.hidden ? '' : more.map(textOf).join(' ')}; };
    const pill = () => find(body, (one) => one.className === 'pill');
    """
)


def test_that_it_is_being_worked_out_what_a_push_would_change_is_said_until_it_is_known(modules: Modules) -> None:
    script = (
        SHOWN
        + """
    const words = () => byId('push-awaited').hidden ? '' : textOf(byId('push-awaited'));
    const known = {items: [], same: true, segments: null, bytes: 0, largest_deviation_us: null, warnings: [],
        warnings_told: []};
    const after = (told) => {
        tell({axes: [], on_trial: false, motors_on: true, ...told});
        const soon = words(); pass();
        return [soon, words()]; };
    const seen = [after({}), after({state: 'moving'}), after({in_control: 'other'}), after({state: 'ready'})];
    const question = {id: '1', axis: 0, designs: [design], ids: [5], state: [null, false, null, null, '', true]};
    dispatch(COMMANDS.device.previewCame, {question, preview: known, rejections: []});
    return [...seen, after({})];"""
    )
    said = "What a push would change is being worked out \u2026"
    assert run(modules, script) == [["", said], ["", ""], ["", ""], ["", said], ["", ""]]


def test_while_a_controller_restarts_to_prove_what_it_has_stored_what_is_known_of_it_stays(modules: Modules) -> None:
    script = (
        GIVEN
        + """
    tell(pending); await settled();
    const before = [report(), given('proof'), Boolean(byId('prove').disabled)];
    tell(away);
    const seen = {pill: textOf(pill()), state: pill().dataset.state, report: report(), proof: given('proof'),
        reason: given('push-reason'), old: given('old-state'), axis: byId('device-axis').value,
        backups: byId('backups').hidden, trial: find(body, (one) => one.textContent === 'Try').hidden,
        can: ['push', 'prove-restart', 'restore-backup', 'start-from', 'settings', 'connect', 'move']
            .filter((id) => !byId(id).disabled)};
    tell({...pending, unproven: [], unproven_words: null, proof: stored}); const proven = report();
    tell({...pending, unproven_words: null, proof: other}); const others = report();
    return [before, seen, proven, others];"""
    )
    before, seen, proven, others = run(modules, script)
    done = ["done"] * 4
    assert (before[0]["bar"], before[1:]) == ([*done, ""], ["$111 is in use. Wait, or restart it now.", False])
    assert "Full speed" in before[0]["more"]
    assert (seen["pill"], seen["state"]) == ("restarting", "restarting")
    assert (seen["report"]["bar"], seen["proof"]) == ([*done, "doing"], "")
    assert seen["report"]["head"].startswith("Restarts to prove it is stored")
    assert seen["report"]["more"] == before[0]["more"]
    assert seen["reason"] == "It restarts to prove what it has stored."
    assert seen["old"].endswith("It restarts: this is where it was.")
    assert (seen["axis"], seen["backups"], seen["trial"], seen["can"]) == ("1", False, True, [])
    assert (proven["bar"], others["bar"]) == ([*done, "done"], [*done, "failed"])
    assert (proven["head"][:6], others["head"][:14]) == ("Stored", "Not as written")
    assert "Stored: $111." in proven["more"]
    assert "216.000 500.000" in others["more"]


def test_what_was_pushed_before_it_was_connected_is_reported_once_a_start_has_shown_it(modules: Modules) -> None:
    """As after it was unplugged: it looks as any that is connected, and knows of no push."""
    script = (
        GIVEN
        + """
    const seen = [];
    for (const told of [{state: 'connecting', axes: [], unproven: ['$111']}, {proof: stored}, {proof: other}, {}]) {
        tell({pushed: null, ...told});
        seen.push([textOf(pill()), report(), find(body, (one) => one.textContent === 'Try').hidden]); }
    tell({proof: stored}); await settled();
    find(body, (one) => one['aria-label'] === 'Close the report').onclick(); tell({proof: stored});
    return [...seen, [report().head, byId('push-report').children[0].hidden]];"""
    )
    back, kept, others, nothing, closed = run(modules, script)
    assert back == ["waiting for the board", {"bar": [""] * 5, "head": "", "more": ""}, True]
    assert (kept[1]["bar"], kept[1]["more"]) == (["done"] * 5, "Stored: $111.")
    assert (others[1]["bar"], others[1]["head"][:14]) == ([*["done"] * 4, "failed"], "Not as written")
    assert (nothing[1]["bar"], nothing[1]["head"]) == ([""] * 5, "")
    assert closed == ["", True]


def test_the_ways_out_are_said_in_one_wording(modules: Modules) -> None:
    """The button, its question and where that is answered; the panel and the server."""
    script = (
        GIVEN
        + """
    tell({...pending, unknown_positions: [1], proof: other}); await settled();
    const dialog = byId('prove-dialog');
    return [textOf(byId('prove')), textOf(dialog), textOf(byId('prove-restart')), textOf(byId('unknown-position')),
        textOf(byId('push-failed'))];"""
    )
    button, dialog, confirm, unknown, failed = run(modules, script)
    assert button == confirm == "Restart and prove now"
    assert dialog.count(button) == 2
    position = "Look where each axis is, then set its position under Jog."
    assert position in dialog
    assert position in unknown
    assert failed.strip().endswith(MENDING)
