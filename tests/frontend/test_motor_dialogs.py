"""What is found of motors: it stays with the axis and the design that it was found for.

Plain objects stand in for elements.
"""

import json

from designs import document
from frontend.dialogs import NOBODY, run
from frontend.modules import Modules
from frontend.test_motor_modules import ANSWER
from motor.trains import NEMA_17

RUN = {
    "damping": 0.05, "lost_full_steps": 0, "first_lost_step": None, "largest_load_angle_deg": 45.2,
    "speed_ripple": None, "overshoot_deg": 9.0, "settled_after_s": 0.02,
}  # fmt: skip
GENTLER = {"text": "less acceleration", "changes": [{"field": "ramp.acceleration_steps_per_s2", "value": 321}]}
FOUND = ANSWER | {
    "verdict": "stalls", "cause": "onset", "evidence": None, "lost_full_steps": 4, "largest_load_angle_deg": 200,
    "most_used": 1.2, "most_used_at_steps_per_s": 900, "natural_frequency_hz": 100, "not_covered": "belts",
    "proposals": [GENTLER], "runs": [RUN],
    "rotor": {"step": [0, 1, 2], "time_s": [0, 0.1, 0.2], "load_angle_deg": [0, 10, 0],
              "speed_steps_per_s": [0, 9, 0]},
}  # fmt: skip

# A store with a machine of one axis that has a motor, X. A second one that is added has the same design, Y.
# `press(box, text)` presses the button that says so, and tells whether there is one that can be pressed.
STORE = f"""
    const {{createStore, FIRST_STATE}} = await import('/app/state.js');
    const {{COMMANDS: {{work, answers, view}}}} = await import('/app/commands/commands.js');
    const {{Refusal}} = await import('/server/api.js');
    const store = createStore(FIRST_STATE, (error) => {{ throw error; }});
    const X = 0, Y = 1, found = {json.dumps(FOUND)};
    const begin = () => store.dispatch(work.begin, {{together: 'independent',
        axes: [{{...design, schema: 'stepramp/2', motor: {json.dumps(NEMA_17)}}}]}});
    const inHand = () => {{ const {{axes, active}} = store.state().history.present; return axes[active]; }};
    const curves = () => ({{design: inHand(), range: null, profiles: {{}}, errors: {{}}, failures: {{}}}});
    const refusing = (field, message) => () => Promise.reject(
        new Refusal(422, [{{field, value: 7, allowed: 'less', message}}]));
    const press = (box, text) => {{
        const button = find(box, (one) => one.tag === 'button' && one.textContent === text);
        if (button === null || button.disabled) return false;
        button.onclick(); return true; }};
    const accelerations = () => store.state().history.present.axes.map(({{ramp}}) => ramp.acceleration_steps_per_s2);
"""


def test_what_is_proposed_for_an_axis_is_never_offered_for_another(modules: Modules) -> None:
    own, other, refused, back = run(
        modules,
        f"""{STORE}
        const {{askForMotor}} = await import('/app/effects/motor.js');
        const {{motorOf, designOf, axisOf}} = await import('/app/selectors.js');
        const {{createMotorFound}} = await import('/panels/parameters/motor_found.js');
        let answer = async () => found;
        askForMotor(store, () => answer());
        const panel = createMotorFound(store.dispatch, {{}});
        store.subscribe((now) => panel.show(motorOf(now), now.units, designOf(now), axisOf(now)));
        const calculated = async (axis) => {{ store.dispatch(answers.curvesCame, curves(), axis); await settled(); }};
        const look = () => panel.element.hidden ? null : [find(panel.element, ({{id}}) => id === 'motor-verdict'),
            find(panel.element, ({{id}}) => id === 'motor-proposals')].map((one) => textOf(one).trim());
        begin(); await calculated(X);
        const own = look();
        store.dispatch(work.addAxis);
        const other = look();
        answer = refusing('motor', 'It is too long.'); await calculated(Y);
        const refused = look();
        answer = async () => found;
        store.dispatch(work.choose, X); await calculated(X);
        return [own, other, refused, [press(panel.element, 'Less acceleration'), ...accelerations()]];""",
    )
    assert own[0].startswith("Stalls: it speeds up too suddenly")
    assert own[1] == "Less acceleration"
    assert other is None, "nothing is known of it yet"
    assert refused == ["It is too long.", ""]
    assert back == [True, 321, document()["ramp"]["acceleration_steps_per_s2"]]


# The dialog, open, with what it asks for: `reply()` answers what was asked last, with a ramp of these `changes`.
FASTEST = f"""{STORE}
    const {{createFastest}} = await import('/panels/motor/fastest.js');
    const asked = [];
    const ask = (about, part) => new Promise((take, refuse) => asked.push({{about, part, take, refuse}}));
    const dialog = createFastest(store.dispatch, ask);
    store.subscribe(dialog.show);
    const whole = byId('fastest-dialog'), margin = find(whole, ({{id}}) => id === 'fastest-margin');
    const changes = [{{field: 'ramp.acceleration_steps_per_s2', value: 321}}];
    const figures = {{duration_s: 1, ramp_up_s: 0.2, peak_speed_steps_per_s: 900, acceleration_steps_per_s2: 321,
        most_used: 0.6, verdict: 'safe', rejections: [], is_fastest: false}};
    const curve = {{time_s: [0, 0.1], speed_steps_per_s: [0, 900]}};
    const candidates = [{{...figures, shape: 'constant', changes}}];
    const answer = {{margin: 0.6, words: 'Found.', gain: null, present: figures, candidates}};
    const reply = async () => {{ asked.at(-1).take({{answer, curves: [curve, curve]}}); await settled(); }};
    begin(); dialog.open(); await settled();
"""


def test_a_ramp_is_used_by_the_axis_and_the_design_that_it_was_found_for(modules: Modules) -> None:
    own, other, edited, used, after = run(
        modules,
        f"""{FASTEST} await reply();
        const offers = () => find(whole, (one) => one.tag === 'button' && !one.disabled
            && one.textContent === 'Use this') !== null;
        const own = offers();
        store.dispatch(work.addAxis); await settled();
        const other = [press(whole, 'Use this'), asked.length, accelerations()];
        await reply(); other.push(offers());
        store.dispatch(work.setValue, 'move.steps', 3000, '', 0); await settled();
        const edited = [press(whole, 'Use this'), asked.length];
        await reply();
        const used = [press(whole, 'Use this'), accelerations()];
        await settled(); await reply();
        const after = [offers(), find(whole, ({{textContent}}) => textContent === 'In use').disabled];
        return [own, other, edited, used, after];""",
    )
    before = document()["ramp"]["acceleration_steps_per_s2"]
    assert own
    assert other == [False, 2, [before, before], True], "found anew for the other axis, though its design is the same"
    assert edited == [False, 3]
    assert used == [True, [before, 321]]
    assert after == [False, True]


def test_what_is_wrong_with_the_part_of_the_torque_is_told_in_the_page_s_words_and_until_it_is_typed_anew(
    modules: Modules,
) -> None:
    card, marked, typed = run(
        modules,
        f"""{FASTEST}
        const why = {{field: 'margin', value: 0.05, allowed: 'a margin from 0.1 on, for a table',
            message: "margin is 0.05; allowed: a margin from 0.1 on, for a table."}};
        candidates[0].verdict = null; candidates[0].rejections = [why];
        await reply();
        const card = textOf(find(whole, (one) => one.tag === 'section' && one['aria-label'] !== 'As it is'));
        margin.emit('input'); await settled();
        asked.at(-1).refuse(new Refusal(422, [why])); await settled();
        const isMarked = () => margin['aria-invalid'] === 'true';
        const marked = isMarked();
        margin.emit('input');
        return [card, marked, isMarked()];""",
    )
    assert "Part of the torque is 0.05; allowed: a margin from 0.1 on, for a table." in card
    assert (marked, typed) == (True, False), "what was said is of what stood there before"


def test_the_part_of_the_torque_is_marked_for_what_is_wrong_with_it_alone(modules: Modules) -> None:
    first, part, steps, shape, gone, answered, none = run(
        modules,
        f"""{FASTEST}
        const look = () => {{ const words = find(whole, ({{id}}) => id === 'fastest-margin-message');
            const isTied = margin['aria-describedby'] === 'fastest-margin-message';
            return [margin['aria-invalid'] === 'true', isTied ? textOf(words).trim() : '',
                find(whole, ({{id}}) => id === 'fastest-answer').hidden, textOf(whole)]; }};
        const refuse = async (error) => {{ margin.emit('input'); await settled();
            asked.at(-1).refuse(error); await settled(); return look(); }};
        const refusal = (field, allowed) => new Refusal(422, [{{field, value: 7, allowed,
            message: `${{field}} is 7; allowed: ${{allowed}}.`}}]);
        await reply(); const first = look();
        const part = await refuse(refusal('margin', 'a margin from 0.05 to 1'));
        const steps = await refuse(refusal('design.move.steps', 'less'));
        const shape = await refuse(refusal('design.ramp.shape.margin', 'a margin from 0.05 to 1'));
        await refuse(refusal('margin', 'less'));
        const gone = await refuse(new ServerGone('gone'));
        margin.emit('input'); await settled(); await reply();
        const answered = look();
        store.dispatch(work.setMotor, null);
        return [first, part, steps, shape, gone, answered, look()];""",
    )
    assert first[:3] == answered[:3] == [False, "", False]
    # What is allowed is told as the server has it.
    assert part[:3] == [True, "Part of the torque is 7; allowed: a margin from 0.05 to 1.", True]
    for other, said in [
        (steps, "Distance is 7; allowed: less."), (shape, "Part of torque is 7; allowed: a margin from 0.05 to 1."),
        (gone, NOBODY), (none, "The design has no motor."),
    ]:  # fmt: skip
        assert other[:3] == [False, "", True]
        assert said in other[3]
    assert NOBODY not in answered[3]


def test_a_refusal_stays_until_what_is_in_hand_was_played(modules: Modules) -> None:
    first, refused, drawn, gone, again, back = run(
        modules,
        f"""{STORE}
        const {{createRotor}} = await import('/panels/motor/rotor.js');
        let answer = async () => found;
        const dialog = createRotor(() => answer());
        store.subscribe(dialog.show);
        const whole = byId('rotor-dialog');
        const look = () => [find(whole, ({{id}}) => id === 'rotor-answer').hidden, textOf(whole)];
        begin(); dialog.open(); await settled();
        const first = look();
        answer = refusing('motor', 'It is too long.');
        store.dispatch(work.setValue, 'move.steps', 3000, '', 0); await settled();
        const refused = look();
        // The curves that come after it, and other units, draw what is there anew.
        store.dispatch(answers.curvesCame, curves(), X);
        store.dispatch(view.setUnits, {{length: 'mm', time: 's'}});
        const drawn = look();
        answer = gone;
        store.dispatch(work.setValue, 'move.steps', 2000, '', 0); await settled();
        const none = look();
        dialog.open(); const again = look(); await settled();
        answer = async () => found; pass(); await settled(); await settled();
        return [first, refused, drawn, none, again, look()];""",
    )
    assert not first[0]
    for hidden, text in (refused, drawn):
        assert hidden
        assert "It is too long." in text
    for hidden, text in (gone, again):
        assert hidden
        assert NOBODY in text
    assert not back[0]
    assert "It is too long." not in back[1]
