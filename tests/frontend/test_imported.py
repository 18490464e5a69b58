"""What is told of settings that were imported, and of backups, in words that a person meets elsewhere in the page."""

from datetime import UTC, datetime

from designs import document
from frontend.dialogs import run
from frontend.modules import Modules


def test_a_remark_names_its_axis_where_it_is_not_of_all(modules: Modules) -> None:
    axes = [
        {"design": document(name=name), "remarks": remarks, "remarks_told": [[] for _ in remarks]}
        for name, remarks in (
            ("X", ["No jerk is kept.", "The travel is unknown."]),
            ("Y", ["No jerk is kept."]),
            ("Z", ["No jerk is kept.", "The travel is unknown.", "It is slow."]),
        )
    ]
    units = {"length": "steps", "time": "s"}
    told = modules.call("/model/imported.js", "remarksOf", axes, units)
    assert told == ["No jerk is kept.", "X: The travel is unknown.", "Z: The travel is unknown.", "Z: It is slow."]
    alone = modules.call("/model/imported.js", "remarksOf", axes[:1], units)
    assert alone == ["No jerk is kept.", "The travel is unknown."]


def test_a_paste_of_which_nothing_comes_says_what_can_be_pasted(modules: Modules) -> None:
    """A text that a field takes is that field's."""
    seen = run(
        modules,
        """const {watchPastes} = await import('/documents/files.js');
        globalThis.Element = class {
            constructor(isField) { this.matches = () => isField; } };
        const seen = [];
        let paste;
        document.addEventListener = (_, act) => { paste = act; };
        watchPastes({onSettings: (text) => seen.push(text),
            onDocument: ({problem}, from) => seen.push([from, problem])});
        const bring = (text, isField, defaultPrevented = false) => paste({clipboardData: {getData: () => text},
            target: new Element(isField), defaultPrevented, preventDefault() { seen.push('taken'); }});
        bring('hello world', false); bring('$100=80.000', true); bring('3 4', true); bring('3 4', false, true);
        delete globalThis.Element;
        return seen;""",
    )
    [[origin, problem], *rest] = seen
    assert origin == "what was pasted"
    assert problem.startswith(
        "It is nothing that StepRamp reads. What a controller tells of itself can be pasted: grbl"
    )
    assert rest == ["taken", "$100=80.000"]


def test_a_message_tells_when_a_backup_was_saved_as_lists_do(modules: Modules) -> None:
    # As `devices/backups.py` names them.
    name = datetime(2026, 11, 26, 0, 34, 30, 440152, UTC).strftime("%Y-%m-%dT%H-%M-%S.%fZ")
    listed = modules.call("/model/saved_at.js", "savedAtText", name)
    assert listed == "2026-11-26 00:34:30 UTC"
    said = f"It was lost. What it had is saved as {name}: restore that."
    told = modules.call("/model/saved_at.js", "withSavedAt", said)
    assert told == f"It was lost. What it had is saved as {listed}: restore that."
    assert modules.call("/model/saved_at.js", "withSavedAt", "Saved as usual.") == "Saved as usual."
