"""What follows from the page's state of devices after some commands."""

import pytest

from designs import document
from frontend.modules import Modules
from frontend.state import DEVICE, OTHER, STATE, after


def test_an_axis_that_is_refused_is_marked_while_another_is_in_hand(modules: Modules) -> None:
    refused = [{"field": "name", "value": 1, "allowed": "a text", "message": "no"}]
    script = """(state, {refusedAxesOf}) => refusedAxesOf(state)"""
    asked = f"""async ([design, refused]) => {{ {STATE}
        const {{curvesRefused, curvesCame}} = await import('/app/commands/answers.js');
        const {{choose, setName}} = await import('/app/commands/work.js');
        const see = {script};
        const selectors = await import('/app/devices.js');
        const wrong = curvesRefused(state, refused, state.history.present.axes[0], 5);
        const away = choose(wrong, 7);
        const mended = setName(choose(away, 5), 'Another');
        return [state, wrong, away, mended, curvesCame(away, {{}}, 5)].map((one) => see(one, selectors)); }}"""
    assert modules.evaluate(asked, [document(), refused]) == [[], [5], [5], [], []]


def test_what_a_person_chose_stays_while_less_can_be_chosen(modules: Modules) -> None:
    axis = {"state": "ready"}
    two = {**DEVICE, "axes": [axis, axis]}
    one = {**DEVICE, "axes": [axis], "most_axes": 1}
    look = "(state, {deviceAxisOf, portOf}) => [deviceAxisOf(state), state.devices.axis, portOf(state)]"
    chosen = [["device.heard", [two], {}], ["device.chooseAxis", 1]]
    assert after(modules, chosen, look) == [1, 1, "sim://"]
    assert after(modules, [*chosen, ["device.heard", [one], {}]], look) == [0, 1, "sim://"]
    assert after(modules, [*chosen, ["device.heard", [one], {}], ["device.heard", [two], {}]], look) == [1, 1, "sim://"]
    moved = {**two, "port": "/dev/other"}
    assert after(modules, [*chosen, ["device.heard", [moved], {}]], look) == [1, 1, "/dev/other"]


def test_a_move_is_of_the_axis_that_was_pushed_there_last(modules: Modules) -> None:
    pushed = ["device.pushed", "1", {"designs": [document(), OTHER], "ids": [5, 7], "toAxis": 1}]
    look = "(state, {moveOf}) => [0, 1, 2].map((axis) => moveOf(state, '1', axis).axis)"
    assert after(modules, [pushed], look) == [None, 5, 7]
    assert after(modules, [pushed, ["device.pushed", "1", None]], look) == [None, None, None]


def test_of_a_device_that_is_not_told_any_more_nothing_is_known(modules: Modules) -> None:
    known = [
        ["device.heard", [DEVICE, {**DEVICE, "id": "2"}], {}],
        *(["device.pushed", name, {"designs": [document()], "ids": [5], "toAxis": 0}] for name in "12"),
        *(["device.traceCame", name, {"step": [1]}] for name in "12"),
        ["device.previewCame", {"question": {"id": "1", "axis": 0, "designs": []}, "preview": None, "rejections": []}],
    ]
    look = """({devices: {pushed, traces, preview}}) =>
        [Object.keys(pushed), Object.keys(traces), preview?.question.id ?? null]"""
    assert after(modules, known, look) == [["1", "2"], ["1", "2"], "1"]
    assert after(modules, [*known, ["device.heard", [{**DEVICE, "id": "2"}], {}]], look) == [["2"], ["2"], None]


def test_a_value_that_is_refused_is_no_change_since_the_push(modules: Modules) -> None:
    look = "(state, {situationOf}) => situationOf(state).isChanged"
    pushed = ["device.pushed", "1", {"designs": [document(), document()], "ids": [5, 7], "toAxis": 0}]
    known = [["device.heard", [DEVICE], {}], pushed]
    changed = [*known, ["work.setValue", "ramp.slew_speed_steps_per_s", 700, "", 1]]
    assert after(modules, changed, look)
    rejection = {"field": "ramp.slew_speed_steps_per_s", "value": 700, "allowed": "less", "message": "no"}
    assert not after(modules, [*changed, ["answers.curvesRefused", [rejection], document(), 5]], look)


def test_a_running_move_lies_over_the_plots_of_its_own_axis_and_a_jog_over_none(modules: Modules) -> None:
    look = (
        "(state, {samplesOf, runningMoveOf}) => [samplesOf(state)?.length ?? null, runningMoveOf(state)?.done ?? null]"
    )
    axis = {"axis": 0, "state": "moving", "position_steps": 30, "target_steps": 90, "speed_steps_per_s": 5}
    moving = [{**DEVICE, "state": "moving", "axes": [axis]}]

    def heard(length: int | None) -> list[object]:
        samples = {"time_s": [0, 1], "position": [0, 30], "speed": [0, 5], "length": length}
        return ["device.heard", moving, {"1 0": {"samples": samples, "restingPlace": 0}}]

    def pushed(axis_id: int) -> list[object]:
        return ["device.pushed", "1", {"designs": [document()], "ids": [axis_id], "toAxis": 0}]

    assert after(modules, [heard(90)], look) == [90, 30], "nobody knows which axis' it is"
    assert after(modules, [heard(90), pushed(5)], look) == [90, 30]
    assert after(modules, [heard(90), pushed(7)], look) == [None, None]
    assert after(modules, [heard(None), pushed(5)], look) == [None, 30]


@pytest.mark.parametrize(
    ("steps", "played"),
    [
        ([], 0),
        ([["device.chooseAxis", 1]], 1),
        # What was pushed there is known better: axis 1 of the device plays the design of the first tab.
        ([["device.chooseAxis", 1], ["device.pushed", "1", {"designs": [OTHER], "ids": [5], "toAxis": 1}]], 0),
        ([["device.chooseAxis", 1], ["work.choose", 7], ["work.removeAxis", 7]], None),
        ([["device.pushed", "1", {"designs": [OTHER], "ids": [99], "toAxis": 0}]], None),
        ([["device.heard", [{**DEVICE, "state": "lost"}], {}]], None),
    ],
)
def test_which_design_the_chosen_axis_of_a_device_plays(
    modules: Modules, steps: list[list[object]], played: int | None
) -> None:
    two = {**DEVICE, "axes": [{"state": "ready"}, {"state": "ready"}]}
    known: list[list[object]] = [["device.heard", [two], {}], *steps]
    assert after(modules, known, "(state, {playedOf}) => playedOf(state)") == played
