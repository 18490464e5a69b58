"""What follows from the page's state after some commands."""

import pytest

from designs import document
from frontend.modules import Modules
from frontend.state import MACHINE, OTHER, STATE, VIEW, after


def test_a_remedy_is_one_step_of_the_axis_that_was_refused(modules: Modules) -> None:
    changes = [
        {"field": "ramp.acceleration_steps_per_s2", "value": 4321},
        {"field": "method.name", "value": "newton"},
    ]
    seen = """({history, shown}) => [history.present.active, history.past.length, shown.includes('newton'),
        history.present.axes.map(({ramp, method}) => [ramp.acceleration_steps_per_s2, method.name])]"""
    before = [document()["ramp"]["acceleration_steps_per_s2"], document()["method"]["name"]]
    mend: list[object] = ["work.mend", 7, {"text": "", "changes": changes}]
    assert after(modules, [mend], seen) == [1, 2, True, [before, [4321, "newton"]]]
    undone = after(modules, [mend, ["work.undo"]], seen)
    assert isinstance(undone, list)
    assert undone[1:] == [1, True, [before, before]]


def test_turns_of_the_wheel_minutes_apart_are_taken_back_one_by_one(modules: Modules) -> None:
    path, gesture = "move.steps", "step:move.steps"
    turned = [["work.setValue", path, 3000 + at, gesture, at] for at in (0, 500, 1000, 61_000, 61_500)]
    look = "({history}) => [history.present.axes[0].move.steps, history.past.length]"
    before = after(modules, [], look)
    assert after(modules, turned, look) == [64_500, before[1] + 2]
    assert after(modules, [*turned, ["work.undo"]], look) == [4000, before[1] + 1]
    assert after(modules, [*turned, ["work.undo"], ["work.undo"]], look) == before


def test_a_slider_that_comes_back_to_its_first_value_slides_on_until_it_is_let_go(modules: Modules) -> None:
    path, gesture = "move.steps", "slide:move.steps"
    first = document()["move"]["steps"]
    away = [["work.endGesture"], ["work.setValue", path, 1234, gesture]]
    back = [*away, ["work.setValue", path, first, gesture]]
    look = "(state, {isSliding}) => [isSliding(state), state.history.past.length]"
    assert after(modules, away, look) == [True, 2]
    assert after(modules, back, look) == [True, 2]
    assert after(modules, [*back, ["work.endGesture"]], look) == [False, 1], "it was no change"
    assert after(modules, [*back, ["work.setValue", path, 1235, gesture], ["work.endGesture"]], look) == [False, 2]
    assert after(modules, [*away, ["work.endGesture"]], look) == [False, 2]


@pytest.mark.parametrize("gesture", ["slide:move.steps", "drag:row 1"])
def test_a_drag_that_is_given_up_leaves_what_can_be_done_again(modules: Modules, gesture: str) -> None:
    path, first = "move.steps", document()["move"]["steps"]
    look = "({history}) => history.future.map(({axes}) => axes[0].name)"
    begun = [["work.endGesture"], ["work.setValue", path, 1234, gesture], ["work.setValue", path, 1300, gesture]]
    given_up = [*begun, ["work.setValue", path, first, gesture], ["work.endGesture"]]
    assert after(modules, given_up, look) == ["after"]
    assert after(modules, [*given_up, ["work.redo"]], "({history}) => history.present.axes[0].name") == "after"
    assert after(modules, [*begun, ["work.endGesture"]], look) == [], "it was a change"
    once = [*begun, ["work.endGesture"], ["work.setValue", path, first], ["work.endGesture"]]
    assert after(modules, once, look) == [], "two changes that make up for each other are two"


def test_an_axis_keeps_its_id_and_its_zoom(modules: Modules) -> None:
    zoom = ["view.zoomTo", [2, 5]]
    seen = "(state, {axisOf, viewOf}) => [state.history.present.ids, axisOf(state), viewOf(state).zoom]"
    assert after(modules, [zoom, ["work.setName", "Typed"]], seen) == [[5, 7], 5, [2, 5]]
    assert after(modules, [zoom, ["work.choose", 7]], seen) == [[5, 7], 7, None]
    assert after(modules, [zoom, ["work.removeAxis", 5]], seen) == [[7], 7, None]
    assert after(modules, [zoom, ["work.removeAxis", 5], ["work.addAxis"]], seen) == [[7, 8], 8, None]
    assert after(modules, [zoom, ["work.removeAxis", 5], ["work.undo"]], seen) == [[5, 7], 5, [2, 5]]
    opened = ["work.open", {"axes": [OTHER], "together": "independent"}]
    assert after(modules, [["view.look", VIEW], zoom, opened], seen) == [[8], 8, None]
    look = "(state, {viewOf}) => [viewOf(state).against, viewOf(state).part]"
    assert after(modules, [["view.look", VIEW], zoom, opened], look) == ["time", "up"]


def test_a_table_goes_to_the_axis_that_it_was_made_for(modules: Modules) -> None:
    rows = [[10, 5000], [30, 1500]]
    put = ["work.setTable", rows, "us", "", 7]
    look = "({history}) => history.present.axes.map(({table}) => table && table.rows)"
    own, other = after(modules, [put], look)
    assert (own, other) == (document()["table"]["rows"], rows)
    assert after(modules, [["work.removeAxis", 7], put], look) == [own]


MEASURED = ["device.showMeasured", {"of": {"axis": None, "design": None}, "move": {"step": [1, 2]}}]


@pytest.mark.parametrize("step", [["view.wantPoints", [1, 9]], ["work.addAxis"], ["work.open", MACHINE]])
def test_a_choice_that_can_not_be_shown_now_counts_again_whatever_else_is_looked_at(
    modules: Modules, step: list[object]
) -> None:
    look = "(state, {viewOf}) => viewOf(state).third"
    hidden = [["view.look", {"third": "deviation"}], step]
    assert after(modules, hidden, look) == "error"
    assert after(modules, [*hidden, MEASURED], look) == "deviation"


TABLE_TAB: list[object] = ["view.chooseTab", "table", True]
DEVICE_TAB: list[object] = ["view.chooseTab", "device", True]


@pytest.mark.parametrize(
    ("meanwhile", "seen"),
    [
        ([], ["time", "up", "velocity", [2, 5]]),
        ([["view.zoomTo", [1, 3]], ["view.wantPoints", [1, 9]]], ["time", "up", "velocity", [2, 5]]),
        ([["work.choose", 7], ["work.choose", 5]], ["time", "up", "velocity", [2, 5]]),
        # Who looks otherwise meanwhile has chosen what is seen then.
        ([["view.look", {"only": "error"}]], ["step", "start", "error", None]),
        ([["view.look", {"against": "position"}]], ["position", "start", "delay", None]),
    ],
)
def test_after_the_table_the_plots_show_what_they_showed_before(
    modules: Modules, meanwhile: list[list[object]], seen: list[object]
) -> None:
    look = """(state, {viewOf}) => (({against, part, only, zoom}) => [against, part, only, zoom])(viewOf(state))"""
    before: list[list[object]] = [["view.look", VIEW], ["view.zoomTo", [2, 5]], TABLE_TAB]
    assert after(modules, before, look) == ["step", "start", "delay", None]
    assert after(modules, [*before, *meanwhile, DEVICE_TAB], look) == seen


def test_a_document_that_is_opened_at_the_table_is_looked_at_as_the_one_before(modules: Modules) -> None:
    look = "(state, {viewOf}) => [viewOf(state).against, viewOf(state).part, viewOf(state).only]"
    opened: list[list[object]] = [["view.look", VIEW], TABLE_TAB, ["work.open", {"axes": [OTHER], "together": "line"}]]
    assert after(modules, opened, look) == ["step", "start", "delay"]
    assert after(modules, [*opened, DEVICE_TAB], look) == ["time", "up", "velocity"]


def test_an_axis_has_no_answers_of_another(modules: Modules) -> None:
    refused = [{"field": "move.steps", "value": 1, "allowed": "more", "message": "no"}]
    script = f"""async ([design, refused]) => {{ {STATE}
        const {{curvesCame, curvesMissed, curvesRefused}} = await import('/app/commands/answers.js');
        const {{heard, previewCame}} = await import('/app/commands/device.js');
        const {{choose}} = await import('/app/commands/work.js');
        const {{previewQuestionOf, situationOf}} = await import('/app/devices.js');
        const {{curvesOf, isDesignValid, messagesOf, shownCurvesOf, stalenessOf}} = await import('/app/selectors.js');
        const device = {{id: '1', port: 'sim://', name: 'S', state: 'ready', axes: [], most_axes: 4, stops: 0}};
        const summary = {{warnings: [{{field: 'ramp.slew_speed_steps_per_s', message: 'slow'}}]}};
        const curves = {{design, profiles: {{[design.method.name]: summary}}, errors: {{}}, failures: {{}}}};
        const see = (one) => [stalenessOf(one), curvesOf(one) !== null, shownCurvesOf(one) !== null, isDesignValid(one),
            [...messagesOf(one).fields.keys()], previewQuestionOf(one) !== null, situationOf(one).preview];
        const sound = heard(curvesCame(state, curves, 5), [device], {{}});
        const known = previewCame(sound, {{question: previewQuestionOf(sound), preview: 'known', rejections: []}});
        const away = choose(known, 7);
        const wrong = choose(curvesRefused(sound, refused, design, 5), 7);
        return [state, known, away, wrong, choose(wrong, 5), curvesRefused(away, refused, design, 7),
            curvesMissed(away, 7), curvesCame(away, curves, 7)].map(see); }}"""
    speed, steps = ["ramp.slew_speed_steps_per_s"], ["move.steps"]
    first, known, away, wrong, back, refused_too, missed, came = modules.evaluate(script, [document(), refused])
    assert first == ["awaited", False, False, False, [], False, None]
    assert known == [None, True, True, True, speed, True, "known"]
    # Nothing of it is used but to be shown as old; what a push would change holds for all axes, and stays in view.
    assert away == ["awaited", False, True, False, [], False, "known"]
    assert wrong == ["awaited", False, True, False, [], False, None]
    assert back == ["refused", True, True, False, steps, False, None]
    assert refused_too == ["refused", False, False, False, steps, False, None]
    assert missed == ["unanswered", False, False, False, [], False, None]
    assert came == [None, True, True, True, speed, True, "known"]


def test_a_row_is_selected_in_the_table_of_one_axis(modules: Modules) -> None:
    select, choose = ["view.selectRow", 3], ["work.choose", 7]
    look = "({row}) => row"
    assert after(modules, [select, ["work.setName", "Typed"]], look) == 3
    elsewhere: list[list[list[object]]] = [
        [select, choose],
        [select, ["work.removeAxis", 5]],
        [select, ["work.addAxis"]],
        [["work.removeAxis", 5], select, ["work.undo"]],
        [["work.removeAxis", 5], ["work.undo"], select, ["work.redo"]],
    ]
    for steps in elsewhere:
        assert after(modules, steps, look) == -1, steps


def test_how_axes_are_looked_at_is_forgotten_with_them(modules: Modules) -> None:
    opened = ["work.open", {"axes": [OTHER], "together": "independent"}]
    look = "({history, views}) => [history.past.length, Object.keys(views).length]"
    assert after(modules, [["view.zoomTo", [2, 5]], opened], look) == [2, 2], "undone, its zoom is there again"
    assert after(modules, [opened] * 700, look) == [500, 501]


# ---- other tabs ----


def other(name: str, ids: list[int], tab: str = "b") -> dict[str, object]:
    """Return a tab that has designs with these ids in hand."""
    axes = [{**document(), "name": name} for _ in ids]
    machine = {"axes": axes, "ids": ids, "active": 0, "together": "independent", "kept": None}
    return {"id": tab, "at_ms": 1, "isOpen": True, "machine": machine}


OFFERED = "(state, {offerOf}) => offerOf(state)?.machine.axes[0].name ?? null"


def test_only_what_another_tab_made_of_the_same_design_is_offered(modules: Modules) -> None:
    changed = ["others.otherChanged", other("Of theirs", [5])]
    assert after(modules, [changed], OFFERED) == "Of theirs"
    assert after(modules, [["others.otherChanged", other("Else", [9])]], OFFERED) is None
    assert after(modules, [changed, ["others.declineOther", "b"]], OFFERED) is None
    assert after(modules, [["others.declineOther", "b"], changed], OFFERED) is None, "not again"
    assert after(modules, [changed, ["work.open", {"axes": [OTHER], "together": "line"}]], OFFERED) is None
    name = "(state) => state.history.present.axes[0].name"
    assert after(modules, [changed], name) == "A", "nothing is taken"


def test_what_another_tab_has_is_opened_with_its_ids_and_taken_back(modules: Modules) -> None:
    theirs = other("Of theirs", [5])
    taken = [["others.otherChanged", theirs], ["work.open", theirs["machine"]]]
    look = "(state, {offerOf}) => [state.history.present.axes[0].name, state.history.present.ids, offerOf(state)?.id]"
    assert after(modules, taken, look) == ["Of theirs", [5], None]
    assert after(modules, [*taken, ["work.undo"]], look) == ["A", [5, 7], "b"]


def test_axes_get_ids_that_no_other_tab_gives(modules: Modules) -> None:
    script = """async ([design, firstId]) => { const {FIRST_STATE} = await import('/app/state.js');
        const {COMMANDS: {work}} = await import('/app/commands/commands.js');
        const begun = (machine) => work.begin({...FIRST_STATE, firstId}, machine);
        const one = {axes: [design], together: 'line'};
        const fresh = work.addAxis(begun(one)), known = work.addAxis(begun({...one, ids: [7000]}));
        return [fresh, known, work.open(known, one)].map(({history}) => history.present.ids); }"""
    assert modules.evaluate(script, [document(), 4096]) == [[4096, 4097], [7000, 4096], [4097]]


# ---- bounds ----


def test_a_table_that_would_be_too_long_is_refused_in_words(modules: Modules) -> None:
    rows = [[index, 1000] for index in range(1, 1002)]
    look = "({history, told}) => [history.present.axes[0].table?.rows.length ?? 0, told.notice?.text ?? '']"
    before = after(modules, [], look)[0]
    words = "The table stays as it is: it would have 1,001 rows; allowed: at most 1,000."
    assert after(modules, [["work.setTable", rows, "us"]], look) == [before, words]
    assert after(modules, [["work.setTable", rows[:1000], "us"]], look) == [1000, ""]


@pytest.mark.parametrize(
    ("name", "copy"),
    [
        ("Stage", "Stage copy"),
        ("Stage copy", "Stage copy 2"),
        ("Stage copy 9", "Stage copy 10"),
        ("", "copy"),
        ("copy", "copy 2"),
        ("A copy machine", "A copy machine copy"),
        ("軸" * 100, "軸" * 95 + " copy"),
        ("𝛼" * 97 + " copy 9", "𝛼" * 92 + " copy 10"),
    ],
)
def test_a_duplicate_is_called_a_copy(modules: Modules, name: str, copy: str) -> None:
    work = {"axes": [{**document(), "name": name}], "together": "line"}
    made = modules.call("model/workbench.js", "duplicateOf", work)
    assert made == {"axes": [{**document(), "name": copy}], "together": "line"}


def test_a_trace_lies_over_the_axis_whose_ramp_was_pushed(modules: Modules) -> None:
    look = "(state, {measuredOf}) => measuredOf(state)?.step ?? null"
    move = {"step": [1, 2]}
    measured = ["device.showMeasured", {"of": {"axis": 7, "design": document()}, "move": move}]
    assert after(modules, [measured], look) is None
    assert after(modules, [measured, ["work.choose", 7]], look) == [1, 2]
    unknown = ["device.showMeasured", {"of": {"axis": None, "design": None}, "move": move}]
    assert after(modules, [unknown], look) == [1, 2]


def test_a_trace_of_another_ramp_is_told_apart(modules: Modules) -> None:
    look = "(state, {isMeasuredOfDesign}) => isMeasuredOfDesign(state)"

    def measured(design: dict[str, object] | None) -> list[object]:
        return ["device.showMeasured", {"of": {"axis": 5, "design": design}, "move": {"step": [1, 2]}}]

    # A name is no part of a ramp, and a move may be as long as one likes.
    assert after(modules, [measured({**document(), "name": "Other", "move": {"steps": 7}})], look)
    assert not after(modules, [measured(document(ramp__acceleration_steps_per_s2=1))], look)
    assert not after(modules, [measured(None)], look)
    changed = [measured(document()), ["work.setValue", "ramp.slew_speed_steps_per_s", 700, "", 1]]
    assert not after(modules, changed, look)


def test_a_file_that_can_not_be_read_leaves_the_capture_before_it(modules: Modules) -> None:
    look = "({capture}) => [capture.file.name, capture.stage]"
    good = [["capture.openCapture", {"name": "good.csv"}], ["capture.captureCame", {"move": None}, "{}"]]
    bad = [["capture.openCapture", {"name": "bad.csv"}], ["capture.captureRefused", []]]
    closed = ["capture.showCapture", False]
    assert after(modules, [*good, *bad], look) == ["bad.csv", "refused"], "it says why for as long as it is looked at"
    assert after(modules, [*good, *bad, closed], look) == ["good.csv", "answered"]
    assert after(modules, [*good, *bad, *bad, closed], look) == ["good.csv", "answered"]
    assert after(modules, [*bad, closed], look) == ["bad.csv", "refused"]
    waited = [["capture.openCapture", {"name": "long.csv"}], ["capture.captureCancelled"]]
    assert after(modules, [*good, *waited], look) == ["good.csv", "answered"]


def test_curves_of_an_earlier_design_are_told_to_be_so_when_the_answer_is_late(modules: Modules) -> None:
    """Not as soon as something is asked: under a slider that would flicker. Nor while only finer points are awaited."""
    script = """async (design) => {
        const {createStore, FIRST_STATE} = await import('/app/state.js');
        const {COMMANDS} = await import('/app/commands/commands.js');
        const {askForCurves} = await import('/app/effects/curves.js');
        const {stalenessOf} = await import('/app/selectors.js');
        const [answers, seen] = [[], []];
        const store = createStore(FIRST_STATE, (error) => { throw error; });
        askForCurves(store, (design) => new Promise((resolve) => answers.push(() => resolve({design, range: null,
            profiles: {}, errors: {}, failures: {}}))));
        const pause = (ms) => new Promise((go) => setTimeout(go, ms));
        const after = (ms) => pause(ms).then(() => seen.push(stalenessOf(store.state())));
        const answer = () => after(answers.shift()());
        store.dispatch(COMMANDS.work.begin, {axes: [design], together: 'independent', ids: [0], active: 0, kept: null});
        await answer();
        store.dispatch(COMMANDS.work.setValue, 'move.steps', 9_000_000);
        await after(50);
        await after(400);
        await answer();
        store.dispatch(COMMANDS.view.look, {acceleration: true});
        await after(400);
        await answer();
        store.dispatch(COMMANDS.work.setValue, 'move.steps', 8_000_000);
        store.dispatch(COMMANDS.work.setValue, 'move.steps', 7_000_000);
        await after(250);
        await answer();
        await after(250);
        await after(150);
        await answer();
        return seen; }"""
    first, soon, late, come, finer, finer_come, again, other, still, long, last = modules.evaluate(script, document())
    assert [first, soon, late, come] == [None, None, "awaited", None]
    assert [finer, finer_come] == [None, None]
    # The answer about what was asked before is no answer about the present design, but one that was due.
    assert [again, other, still, long, last] == [None, None, None, "awaited", None]


ALL_AXES = """async (design) => {
        const {createStore, FIRST_STATE} = await import('/app/state.js');
        const {COMMANDS} = await import('/app/commands/commands.js');
        const {askForBeside} = await import('/app/effects/beside.js');
        const {ServerGone} = await import('/server/api.js');
        const {plottedStalenessOf, summaryMessagesOf} = await import('/app/selectors.js');
        const [answers, seen] = [[], []];
        const store = createStore(FIRST_STATE, (error) => { throw error; });
        askForBeside(store, () => new Promise((resolve, reject) => answers.push({resolve, reject})));
        const pause = (ms) => new Promise((go) => setTimeout(go, ms));
        const see = () => seen.push([plottedStalenessOf(store.state()), summaryMessagesOf(store.state()).length]);
        const planned = {axes: [], limits: [], warnings: [{field: null, message: 'The axes end at other times.'}]};
        const answer = async () => { answers.shift().resolve(planned); await pause(0); };
        const run = (noun, verb, ...args) => store.dispatch(COMMANDS[noun][verb], ...args);
        run('work', 'begin', {axes: [design, design], together: 'independent', ids: [0, 1], active: 0, kept: null});
        run('answers', 'curvesCame', {design, range: null, profiles: {[design.method.name]: {warnings: []}}, errors: {},
            failures: {}}, 0);
        run('view', 'showAll', true);
        await answer(); see();"""


def test_all_axes_of_earlier_designs_are_told_to_be_so_when_the_answer_is_late(modules: Modules) -> None:
    script = (
        ALL_AXES
        + """
        run('work', 'setValue', 'move.steps', 9_000_000, 'slide:move.steps'); await pause(50); see();
        await pause(400); see();
        await answer(); see();
        run('work', 'setValue', 'move.steps', 8_000_000, 'slide:move.steps'); await pause(0);
        answers.shift().reject(new ServerGone('gone')); await pause(0); see();
        return seen; }"""
    )
    assert modules.evaluate(script, document()) == [
        [None, 1],
        [None, 1],
        ["awaited", 0],
        [None, 1],
        ["unanswered", 0],
    ]


def test_all_axes_are_old_at_once_where_they_were_not_looked_at_or_are_others(modules: Modules) -> None:
    script = (
        ALL_AXES
        + """
        run('view', 'showAll', false);
        run('work', 'setValue', 'move.steps', 9_000_000);
        run('view', 'showAll', true); see();
        await answer(); see();
        run('work', 'addAxis'); see();
        await answer(); see();
        return seen; }"""
    )
    assert modules.evaluate(script, document()) == [[None, 1], ["awaited", 0], [None, 1], ["awaited", 0], [None, 1]]
