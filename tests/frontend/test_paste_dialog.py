"""The dialog for tables that come as text: what the table would refuse is told before the rows are used."""

from typing import Any

import pytest

from designs import document
from frontend.dialogs import run
from frontend.modules import Modules
from stepramp.design import Design
from stepramp.errors import Rejected

# `paste(text)` types it; `look()` is what the preview says, its rows, the button and what is offered to be rounded.
DIALOG = """
    const {createPasteDialog} = await import('/panels/table/paste_dialog.js');
    const used = [];
    const dialog = createPasteDialog((...rows) => used.push(rows), () => {});
    const whole = byId('paste-dialog'), within = (id) => find(whole, (one) => one.id === id);
    const all = (one, tag) => typeof one === 'string' ? [] : one.tag === tag ? [one] :
        one.children.flatMap((child) => all(child, tag));
    const use = find(whole, ({type}) => type === 'submit'), round = within('paste-round');
    const offer = find(whole, ({htmlFor}) => htmlFor === 'paste-round');
    const paste = (text) => { within('paste-text').value = text; within('paste-text').oninput(); };
    const look = () => [all(within('paste-preview'), 'p').map((line) => textOf(line).trim()),
        all(within('paste-preview'), 'tr').slice(1).map((row) => row.children.map(({textContent}) => textContent)),
        use.disabled ? null : use.textContent, offer.hidden ? null : textOf(offer).trim()];
    const check = (checked) => { round.checked = checked; round.onchange(); };
    const submit = () => find(whole, ({tag}) => tag === 'form').onsubmit({preventDefault() {}});
"""
FRACTIONS = "3;8284,5\n7;4783,25\n100;1115"
WHOLE = "allowed: a whole number from 1 to 4,294,967,295"


@pytest.mark.parametrize(("unit", "word"), [("us", "µs"), ("ticks", "ticks")])
def test_fractions_of_a_sheet_are_refused_and_rounded_only_when_it_is_asked_for(
    modules: Modules, unit: str, word: str
) -> None:
    before, ignored, after, again, used = run(
        modules,
        f"""{DIALOG} dialog.open(design, 3, '{unit}'); paste({FRACTIONS!r});
        const before = look(); submit(); const ignored = [...used];
        check(true); const after = look(); submit();
        dialog.open(design, 3, '{unit}', {FRACTIONS!r});
        return [before, ignored, after, look()[2], used];""",
    )
    problems, rows, button, offer = before
    assert problems == [
        f"Row 1, delay, is 8,284.5; {WHOLE} {word}.",
        f"Row 2, delay, is 4,783.25; {WHOLE} {word}.",
    ]
    assert rows == [["1", "3", "8,284.5"], ["2", "7", "4,783.25"], ["3", "100", "1,115"]]
    assert (button, offer) == (None, f"Round 2 delays to whole {word}")
    assert ignored == []
    assert after[0] == []
    assert after[1] == [["1", "3", "8,285"], ["2", "7", "4,783"], ["3", "100", "1,115"]]
    assert after[2] == "Use 3 rows"
    [[taken, taken_unit, _, rounded]] = used
    assert (taken, taken_unit, rounded) == ([[3, 8285], [7, 4783], [100, 1115]], unit, 2)
    assert again is None, "it is asked anew of other rows"


@pytest.mark.parametrize(
    ("text", "problems"),
    [
        (
            "9 100\n3 200",
            [
                "Row 2, last index, is 3; allowed: a whole number from 10 to 10,000,000 steps: more than the ramp "
                "index of the row before."
            ],
        ),
        ("-2 100\n3 200", ["Row 1, last index, is -2; allowed: a whole number from 0 to 10,000,000 steps."]),
        ("1 0\n3 200", [f"Row 1, delay, is 0; {WHOLE} µs."]),
        ("1 5000000000", [f"Row 1, delay, is 5,000,000,000; {WHOLE} µs."]),
        ("1.5 100", ["Row 1, last index, is 1.5; allowed: a whole number from 0 to 10,000,000 steps."]),
    ],
)
def test_rows_that_the_table_would_refuse_cannot_be_used(modules: Modules, text: str, problems: list[str]) -> None:
    told, _, button, offer = run(modules, f"{DIALOG} dialog.open(design, 3, 'us'); paste({text!r}); return look();")
    assert (told, button, offer) == (problems, None, None)


def test_of_many_refused_numbers_the_first_are_told(modules: Modules) -> None:
    text = "\n".join(f"{row + 1} 0" for row in range(100))
    told, rows, _, _ = run(modules, f"{DIALOG} dialog.open(design, 3, 'us'); paste({text!r}); return look();")
    assert len(rows) == 100
    assert [line.split(";")[0] for line in told] == [
        *(f"Row {row}, delay, is 0" for row in range(1, 6)),
        "95 more numbers can’t be used.",
    ]


@pytest.mark.parametrize(
    "rows",
    [
        [[0, 1]],
        [[10_000_000, 4_294_967_295]],
        [[-1, 5]],
        [[1, 0]],
        [[5, 100], [5, 90]],
        [[5, 100], [4, 90], [3, 80]],
        [[10_000_000, 5], [3, 4]],
        [[10_000_001, 5]],
        [[1.5, 2.5]],
    ],
)
def test_what_is_told_of_rows_is_what_the_server_refuses(modules: Modules, rows: list[Any]) -> None:
    """Where several indices are out of order the server tells the first of them."""
    try:
        Design.checked(document(table__rows=rows))
        refused = []
    except Rejected as caught:
        refused = [each.allowed for each in caught.rejections]
    told = modules.call("model/table_rows.js", "rowProblems", rows, "us")
    assert [each.split("; allowed: ")[1].rstrip(".") for each in told][: len(refused) or None] == refused
