"""The dialog that fits a table, without a browser: what it asks, asks again, and refuses."""

import json

import pytest

from designs import document
from frontend.dialogs import NOBODY, run
from frontend.modules import Modules
from stepramp.errors import Rejected
from stepramp.http_api.error_items import error_items
from stepramp.http_api.json_response import json_bytes
from stepramp.http_api.tables_models import FitPayload


@pytest.mark.parametrize("back", ["pass()", "dialog.again()"])
def test_a_fit_is_asked_for_again_until_the_server_answers(modules: Modules, back: str) -> None:
    seen = run(
        modules,
        f"""const {{createFitDialog}} = await import('/panels/table/fit_dialog.js');
        const asked = [];
        let answer = gone;
        const dialog = createFitDialog({{fitTable: (to) => {{ asked.push(to.name); return answer(); }},
            fitCurve: () => gone()}}, () => {{}});
        dialog.open(design, 3); await settled();
        const first = textOf(byId('fit-result'));
        answer = async () => ({{table: {{rows: [[1, 2]]}}, rows: 1, bytes: 4, largest_relative_error: 0.5,
            relative_errors: [0.5], floor: {{relative_error: 0.1, ramp_index: 2}}, linear_rows: null}});
        {back}; await settled();
        const then = textOf(byId('fit-result'));
        dialog.show({{...design, name: 'Steeper', ramp: {{...design.ramp, acceleration_steps_per_s2: 77}}}}, 3);
        await settled();
        answer = gone; dialog.show(design, 3); await settled();
        dialog.close(); pass(); await settled();
        return [first, then, asked, waiting.size];""",
    )
    first, then, asked, waiting = seen
    assert NOBODY in first
    assert "1 row" in then
    assert asked == [document()["name"]] * 2 + ["Steeper", document()["name"]], "closed, it asks no more"
    assert waiting == 0


@pytest.mark.parametrize(
    ("wish", "typed", "told"),
    [
        ("rows", "", "Rows is empty; allowed: a whole number from 1 to 1,000 rows."),
        ("rows", "x", "Rows is 'x'; allowed: a whole number from 1 to 1,000 rows."),
        ("rows", "1e400", "Rows is 1e400; allowed: a whole number from 1 to 1,000 rows."),
        ("rows", "-1", "Rows is -1; allowed: a whole number from 1 to 1,000 rows."),
        ("rows", "1e300", "Rows is 1e+300; allowed: a whole number from 1 to 1,000 rows."),
        ("bytes", "3", "Bytes is 3; allowed: a whole number from 4 to 6,000 bytes."),
        (
            "largest_relative_error",
            "2,5",
            "Error is '2,5'; allowed: a number from 0.0001 to 100 %. A point is expected for the comma: 2.5.",
        ),
        ("largest_relative_error", "101", "Error is 101 %; allowed: a number from 0.0001 to 100 %."),
    ],
)
def test_a_wish_is_refused_by_its_field_s_name_and_in_its_unit(
    modules: Modules, wish: str, typed: str, told: str
) -> None:
    dialog = """const {createFitDialog} = await import('/panels/table/fit_dialog.js');
        const {Refusal} = await import('/server/api.js');
        const asked = []; let answer = gone;
        const dialog = createFitDialog({fitTable: async (_, wish) => { asked.push(wish); return answer(); },
            fitCurve: () => gone()}, () => {});
        dialog.open(design, 3);
        find(byId('fit-dialog'), (one) => one['data-value'] === WISH || one.dataset?.value === WISH).onclick();
        const input = find(byId('fit-dialog'), ({id}) => id === 'fit-wish');
        const type = async (text) => { input.value = text; input.oninput(); await settled(); };
    """.replace("WISH", repr(wish))
    [asked] = run(modules, f"{dialog} await type({typed!r}); return asked.slice(-1);")
    with pytest.raises(Rejected) as caught:
        FitPayload.checked({"design": document(), **asked})
    errors = [json.loads(json_bytes(item)) for item in error_items(caught.value)]
    seen = run(
        modules,
        f"""{dialog} answer = () => {{ throw new Refusal(422, {json.dumps(errors)}); }};
        await type({typed!r}); return [textOf(byId('fit-result')).trim(), input['aria-invalid']];""",
    )
    assert seen == [told, "true"]


def test_what_refuses_a_fit_besides_its_wish_is_called_as_the_page_calls_it(modules: Modules) -> None:
    error = {"field": "design.move.steps", "value": 0, "allowed": "another one", "message": "design.move.steps is 0"}
    wish = {"name": "rows", "label": "Rows", "unit": "rows", "factor": 1}
    told = modules.call("panels/table/fits.js", "problemOf", {"rejections": [error]}, wish, 8)
    assert told == "Distance is 0; allowed: another one."
