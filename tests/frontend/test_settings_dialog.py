"""The dialog of a device's settings and soft limits: nothing of it is taken while anything is refused."""

import json
from typing import Any

import pytest

from frontend.dialogs import run
from frontend.modules import Modules
from stepramp.controllers.stepramp.input_roles import EMERGENCY_INPUTS, INPUTS
from stepramp.controllers.stepramp.settings import StepRampSettings
from stepramp.errors import Rejected
from stepramp.http_api.error_items import ErrorItem, error_items
from stepramp.http_api.json_response import json_bytes
from stepramp.http_api.motion_models import AxisLimits
from stepramp.validation import Document

# `type(id, text)` types into a field, `use()` presses the button; `sent` is what was asked of the server, which answers
# as `answers` says; `said(id)` is what stands at a field, and `below()` what stands below all of them.
DIALOG = """
    const {createSettingsDialog} = await import('/panels/device/settings_dialog.js');
    const {api, Refusal} = await import('/server/api.js');
    const sent = [], answers = {}, told = [];
    const taking = (what) => async (_, wanted) => { sent.push([what, wanted]); await answers[what]?.(); };
    const dialog = createSettingsDialog({limit: taking('limits'), useSettings: taking('settings'),
        tell: (text) => told.push(text)});
    const asked = api.settings;
    api.settings = async () => ({outputs: 'gauges', both_edges: [], step_inverted: [], direction_inverted: [],
        enable_level: 'low', pulse_width_us: 0, direction_setup_us: 30, enable_lead_ms: 1, enable_hold_ms: null});
    const device = {id: 'a', name: 'board', port: 'A', capabilities: ['settings'],
        axes: [{axis: 0, lowest_steps: null, highest_steps: null}]};
    const situation = {scaled: [design], units: {length: 'steps', time: 's'}};
    await dialog.open(device, situation);
    api.settings = asked;
    const whole = byId('settings-dialog');
    const within = (one, id) => find(one, (each) => each.id === id);
    const type = (id, text) => { const field = within(whole, id); field.value = text; field.oninput?.();
        whole.emit('input', {target: field}); };
    const form = find(whole, ({tag}) => tag === 'form');
    const use = async () => { form.onsubmit({preventDefault() {}}); await settled(); };
    const said = (id) => { const [field, words] = [within(whole, id), within(whole, `${id}-message`)];
        const isTied = field['aria-describedby']?.split(' ').includes(`${id}-message`);
        return field['aria-invalid'] === 'true' && isTied ? textOf(words).trim() : ''; };
    const below = () => textOf(find(whole, ({role}) => role === 'alert')).trim();
"""
WIDTH = "Pulse width is {}; allowed: a whole number from 0 to 100 µs."
HIGHEST = "limit-0-highest"
HINT = "setting-pulse_width_us-hint"


def test_nothing_is_taken_while_a_field_is_refused(modules: Modules) -> None:
    said, others, sent, then, is_open = run(
        modules,
        f"""{DIALOG} type('limit-0-lowest', '-100'); type('{HIGHEST}', '100000000');
        type('setting-pulse_width_us', '3,5'); await use();
        const said0 = said('setting-pulse_width_us'), others = [said('{HIGHEST}'), below()], sent0 = [...sent];
        type('setting-pulse_width_us', '3'); await use();
        return [said0, others, sent0, sent, whole.open];""",
    )
    assert said == f"{WIDTH.format(repr('3,5'))} A point is expected for the comma: 3.5."
    assert others == ["", ""]
    assert sent == []
    assert [what for what, _ in then] == ["settings", "limits"]
    assert then[0][1]["pulse_width_us"] == 3
    assert then[1][1] == [{"axis": 0, "lowest_steps": -100, "highest_steps": 100_000_000}]
    assert not is_open


def test_each_refusal_stands_at_its_field(modules: Modules) -> None:
    fields = ["pulse_width_us", "direction_setup_us", "enable_lead_ms", "enable_hold_ms"]
    said, limits, sent, emptied, hints = run(
        modules,
        f"""{DIALOG} const fields = {fields}.map((name) => `setting-${{name}}`);
        for (const id of fields) type(id, '-5');
        type('limit-0-lowest', '10'); type('{HIGHEST}', '5'); await use();
        const said0 = [...fields.map(said), below()], limits = ['limit-0-lowest', '{HIGHEST}'].map(said);
        type('limit-0-lowest', 'low'); type('{HIGHEST}', '1.5'); type('setting-pulse_width_us', '');
        type('setting-enable_hold_ms', ''); await use();
        limits.push(...['limit-0-lowest', '{HIGHEST}'].map(said));
        return [said0, limits, sent, [fields[0], fields[3]].map(said),
            fields.map((id) => within(whole, id)['aria-describedby'])];""",
    )
    assert said == [
        WIDTH.format(-5),
        "Direction setup is -5; allowed: a whole number from 20 to 15,000 µs.",
        "Enable lead is -5; allowed: a whole number from 0 to 1,000 ms.",
        "Enable hold is -5; allowed: a whole number from 0 to 65,534 ms, or empty: they stay on.",
        "",
    ]
    whole = "allowed: a whole number from -2,147,483,648 to 2,147,483,647 steps."
    assert limits == [
        "",
        "Highest is 5; allowed: at least 10 steps, the lowest.",
        f"Lowest is 'low'; {whole}",
        f"Highest is 1.5; {whole}",
    ]
    assert sent == []
    assert emptied == [WIDTH.format("empty"), ""]
    assert hints[0] == f"setting-pulse_width_us-message {HINT}"
    assert hints[3] == "setting-enable_hold_ms-hint", "what explains a field stays with it"


@pytest.mark.parametrize(
    ("failing", "error", "told"),
    [
        (
            "limits",
            "new Refusal(409, [{field: null, value: null, allowed: null, message: 'The motor moves.'}])",
            "The motor moves. The settings of the pins were taken. The soft limits were not taken.",
        ),
        (
            "settings",
            "new Refusal(409, [{field: null, value: null, allowed: null, message: 'The motor moves.'}])",
            "The motor moves. The settings of the pins were not taken. The soft limits were not taken.",
        ),
        (
            "limits",
            "new ServerGone('The server does not answer.')",
            "The server does not answer. The settings of the pins were taken. "
            "Whether the soft limits were taken isn’t known.",
        ),
        (
            "settings",
            "new Refusal(502, [{field: null, value: null, allowed: null, message: 'The device is gone.'}])",
            "The device is gone. Whether the settings of the pins were taken isn’t known. "
            "The soft limits were not taken.",
        ),
    ],
)
def test_what_was_taken_is_told_where_the_rest_was_not(modules: Modules, failing: str, error: str, told: str) -> None:
    words, first, again = run(
        modules,
        f"""{DIALOG} answers.{failing} = () => {{ throw {error}; }};
        type('{HIGHEST}', '5'); type('setting-pulse_width_us', '3'); await use();
        const words = below(), first = sent.map(([what]) => what);
        sent.length = 0; delete answers.{failing}; await use();
        return [words, first, sent.map(([what]) => what)];""",
    )
    assert " ".join(words.split()) == told
    assert first == (["settings", "limits"] if failing == "limits" else ["settings"])
    assert again == (["limits"] if failing == "limits" else ["settings", "limits"]), "what was taken is not sent again"


def test_what_only_the_server_refuses_stands_at_its_field_too(modules: Modules) -> None:
    with pytest.raises(Rejected) as caught:
        StepRampSettings.checked({"pulse_width_us": 900, "enable_hold_ms": -5})
    errors = [served(each) for each in error_items(caught.value)]
    said = run(
        modules,
        f"""{DIALOG} answers.settings = () => {{ throw new Refusal(422, {json.dumps(errors)}); }};
        type('setting-pulse_width_us', '3'); await use();
        return [said('setting-pulse_width_us'), said('setting-enable_hold_ms'), below()];""",
    )
    held = "Enable hold is -5; allowed: a whole number from 0 to 65,534 ms, or empty: they stay on."
    assert said == [WIDTH.format(900), held, ""]


def test_a_refusal_goes_when_what_it_was_said_of_is_typed_over(modules: Modules) -> None:
    said = run(
        modules,
        f"""{DIALOG} const fields = ['limit-0-lowest', 'setting-pulse_width_us', 'setting-enable_lead_ms'];
        for (const id of fields) type(id, '-0.5'); await use();
        const look = () => fields.map((id) => said(id) !== ''), seen = [look()];
        for (const id of fields) {{ type(id, '7'); seen.push(look()); }}
        return seen;""",
    )
    assert said == [[True] * 3, [False, True, True], [False, False, True], [False] * 3]


def test_that_the_highest_is_behind_the_lowest_goes_when_the_lowest_is_typed_over(modules: Modules) -> None:
    behind = {"axis": 0, "lowest_steps": 10, "highest_steps": 5}
    with pytest.raises(Rejected) as caught:
        AxisLimits.checked(behind)
    [told] = [served(each) | {"field": "axes.0.highest_steps"} for each in error_items(caught.value)]
    by_page, by_server, by_itself = run(
        modules,
        f"""{DIALOG} const seen = [], look = () => said('{HIGHEST}') !== '';
        type('limit-0-lowest', '10'); type('{HIGHEST}', '5'); await use();
        seen.push([look()]); type('limit-0-lowest', '3'); seen[0].push(look());
        answers.limits = () => {{ throw new Refusal(422, [{json.dumps(told)}]); }}; await use();
        seen.push([look()]); type('limit-0-lowest', '2'); seen[1].push(look());
        type('{HIGHEST}', '1.5'); await use();
        seen.push([look()]); type('limit-0-lowest', '1'); seen[2].push(look());
        return seen;""",
    )
    assert (by_page, by_server) == ([True, False], [True, False])
    assert by_itself == [True, True], "what it is refused for itself stays"


@pytest.mark.parametrize(
    ("model", "field", "value"),
    [(StepRampSettings, "pulse_width_us", value) for value in (-1, 101, 3.5, "3,5", "")]
    + [(StepRampSettings, "direction_setup_us", 19), (AxisLimits, "lowest_steps", 2**31)],
)
def test_what_is_refused_beforehand_is_what_the_server_refuses(
    modules: Modules, model: type[Document], field: str, value: object
) -> None:
    with pytest.raises(Rejected) as caught:
        model.checked({"axis": 0, field: value} if model is AxisLimits else {field: value})
    script = """async ([field, value]) => { const {refusalOf, DEVICE_TAKES} = await import('/model/taken.js');
        return refusalOf(field, value, DEVICE_TAKES[field]); }"""
    [item] = error_items(caught.value)
    assert modules.evaluate(script, [field, value]) | {"message": item.message} == served(item)


def served(item: ErrorItem) -> dict[str, Any]:
    found: dict[str, Any] = json.loads(json_bytes(item))
    return found


@pytest.mark.parametrize("ends", ["done()", "done(Promise.reject(new Refusal(409, [{field: null, message: 'no'}])))"])
def test_what_comes_of_it_is_of_the_dialog_that_was_shown_then(modules: Modules, ends: str) -> None:
    """It may be closed meanwhile, and opened for another device."""
    is_open, below, sent = run(
        modules,
        f"""{DIALOG} let done; answers.settings = () => new Promise((resolve) => {{ done = resolve; }});
        type('setting-pulse_width_us', '3'); await use(); await use();
        whole.close();
        await dialog.open({{...device, id: 'b', capabilities: []}},
            {{scaled: [design], units: {{length: 'steps', time: 's'}}}});
        type('limit-0-lowest', '-7');
        {ends}; await settled();
        const seen = [whole.open, below()];
        await use();
        return [...seen, sent];""",
    )
    assert (is_open, below) == (True, "")
    assert [what for what, _ in sent] == ["settings", "limits"], "the first once, and then what the other one wants"


CLOSED = "The settings of board were closed, and what was not used yet is not: {}."


@pytest.mark.parametrize(
    ("told", "link", "why"),
    [
        ("[device]", "there", ""),
        ("[{...device, state: 'lost'}]", "there", ""),
        ("[device]", "silent", ""),
        ("[{...device, id: 'b'}]", "there", "it is not connected any more"),
        # Another server counts its devices from the first again.
        ("[{...device, port: 'B'}]", "there", "it was at A, and what has its number now is at B"),
        ("[device]", "gone", "the server is gone"),
    ],
)
def test_it_is_closed_when_its_device_may_be_another(modules: Modules, told: str, link: str, why: str) -> None:
    is_open, words, sent = run(
        modules,
        f"""{DIALOG} type('{HIGHEST}', '5'); dialog.follow({told}, '{link}');
        const seen = [whole.open, told]; await use(); return [...seen, sent];""",
    )
    assert is_open == (why == "")
    assert words == ([CLOSED.format(why)] if why else [])
    assert [what for what, _ in sent] == ([] if why else ["limits"])


def test_it_says_whose_settings_they_are(modules: Modules) -> None:
    names = run(
        modules,
        f"""{DIALOG} const title = () => textOf(find(whole, ({{tag}}) => tag === 'h2')), first = title();
        await dialog.open({{...device, id: 'b', name: 'other', capabilities: []}}, situation);
        return [first, title()];""",
    )
    assert names == ["Settings of board", "Settings of other"]


def test_what_is_typed_stays_when_it_is_asked_for_again(modules: Modules) -> None:
    sent = run(
        modules,
        f"""{DIALOG} type('{HIGHEST}', '5'); await dialog.open({{...device}}, situation); await use(); return sent;""",
    )
    assert [what for what, _ in sent] == ["limits"]


WITH_INPUTS = """await dialog.open({...device, id: 'b'}, situation); whole.close(); dialog.follow([], 'there');
    api.settings = async () => ({outputs: 'gauges', both_edges: [], step_inverted: [], direction_inverted: [],
        enable_level: 'low', pulse_width_us: 0, direction_setup_us: 30, enable_lead_ms: 1, enable_hold_ms: null,
        silence_s: 1.024, silence_ends_moves: false, looks: 4, inputs: [
            {input: 'D9', role: 'limit', active: 'high', pull_up: false, axis: 1, end: 'high', stops: 'at_once'}]});
    await dialog.open(device, situation); api.settings = asked;
    const choose = (id, value) => { const field = within(whole, id); field.value = value; field.onchange?.();
        whole.emit('input', {target: field}); };"""


def test_what_inputs_are_for_is_chosen_and_sent_as_a_whole(modules: Modules) -> None:
    before, sent = run(
        modules,
        f"""{DIALOG} {WITH_INPUTS} await use(); const before = [...sent];
        await dialog.open({{...device, id: 'c'}}, situation); api.settings = asked;
        return [before, sent];""",
    )
    assert before == sent == [], "what was not changed is not sent"
    [[what, settings]] = run(
        modules,
        f"""{DIALOG} {WITH_INPUTS} choose('input-A0-role', 'emergency_stop'); choose('input-A0-active', 'high');
        type('setting-looks', '6'); await use(); return sent;""",
    )
    stop = {"input": "A0", "role": "emergency_stop", "active": "high", "pull_up": True}
    limit = {"input": "D9", "role": "limit", "active": "high", "pull_up": False}
    assert what == "settings"
    assert settings["inputs"] == [
        {**stop, "axis": None, "end": None, "stops": None},
        {**limit, "axis": 1, "end": "high", "stops": "at_once"},
    ]
    assert (settings["looks"], settings["silence_s"], settings["silence_ends_moves"]) == (6, 1.024, False)
    StepRampSettings.checked(settings)


def test_a_refused_input_says_so_in_its_row(modules: Modules) -> None:
    with pytest.raises(Rejected) as caught:
        StepRampSettings.checked(
            {"inputs": [{"input": "A1", "role": "driver_fault"}, {"input": "D9", "role": "emergency_stop"}]}
        )
    errors = [served(each) for each in error_items(caught.value)]
    assert [each["field"] for each in errors] == ["inputs.1.input"]
    here, other, below = run(
        modules,
        f"""{DIALOG} {WITH_INPUTS} answers.settings = () => {{ throw new Refusal(422, {json.dumps(errors)}); }};
        choose('input-A1-role', 'driver_fault'); await use();
        return [said('input-D9-role'), said('input-A1-role'), below()];""",
    )
    assert here.startswith("D9 is 'D9'; allowed: for an emergency stop one of A0")
    assert (other, below) == ("", "")


def test_settings_of_inputs_are_shown_only_where_there_are_any(modules: Modules) -> None:
    fields = ["setting-silence_s", "setting-silence_ends_moves", "setting-looks"]
    script = f"""const gone = () => [...{fields}.map((id) => find(whole, ({{className, children}}) =>
        className === 'setting' && children.some(({{htmlFor}}) => htmlFor === id)).hidden),
        find(whole, ({{className}}) => className === 'input-roles').hidden];"""
    without = run(modules, f"{DIALOG} {script} return gone();")
    with_some = run(modules, f"{DIALOG} {WITH_INPUTS} {script} return gone();")
    assert (without, with_some) == ([True] * 4, [False] * 4)


def test_the_page_knows_the_inputs_of_the_board(modules: Modules) -> None:
    script = "async () => { const own = await import('/panels/device/input_fields.js'); return own; }"
    known = modules.evaluate(script.replace("return own", "return [own.INPUTS, own.EMERGENCY_INPUTS]"), [])
    assert known == [list(INPUTS), list(EMERGENCY_INPUTS)]
