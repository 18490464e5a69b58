"""The page's commands: each makes another state, and leaves the old one as it was."""

from pathlib import Path

import pytest

from designs import document
from frontend.modules import FRONTEND, Modules
from frontend.state import DEVICE, MACHINE, OTHER, STATE, VIEW

ARGUMENTS: dict[str, list[object]] = {
    "answers.allAxesAwaited": [],
    "answers.allAxesCame": [{"axes": [document()], "together": "line", "planned": None, "rejections": []}],
    "answers.allAxesMissed": [],
    "answers.curvesAwaited": [],
    "answers.curvesCame": [{"design": document(), "range": None, "profiles": {}, "errors": {}, "failures": {}}, 0],
    "answers.curvesMissed": [5],
    "answers.curvesRefused": [[{"field": "name", "value": 1, "allowed": "a text", "message": "no"}], document(), 0],
    "answers.examplesCame": [[{"title": "One", "description": "", "design": document()}]],
    "answers.motorCame": [document(), None, [], 5],
    "answers.stallMapCame": [0, "load", {"stage": "running", "progress": 0.5}],
    "answers.ownRampCame": [{"design": document(), "player": "families/grbl", "ramp": None}],
    "answers.pinnedCame": [document(), None],
    "device.accessCame": [{"role": "view", "is_shared": True, "place": "192.0.2.7"}],
    "device.aged": [{"1": 3}],
    "capture.captureAsked": [],
    "capture.captureCame": [{"move": None}, "{}"],
    "capture.captureCancelled": [],
    "capture.captureMissed": [],
    "capture.captureRefused": [[{"field": "edge", "value": 1, "allowed": "rising", "message": "no"}]],
    "capture.captureSent": [0.75],
    "capture.openCapture": [{"name": "other.vcd", "size": 1}],
    "capture.removeCapture": [],
    "capture.showCapture": [True],
    "capture.wishCapture": [{"edge": "both"}],
    "device.answered": [],
    "device.asks": ["push"],
    "device.chooseAxis": [1],
    "device.chooseFamily": ["sim://", "stepramp"],
    "device.choosePort": ["sim://"],
    "device.chooseSection": ["jog"],
    "device.homingBegan": ["1", {"wish": {"axes": []}, "stops": 0, "heard_s": 1, "outcomes": None}],
    "device.heard": [[DEVICE], {}],
    "device.limitsKept": ["sim://", [{"axis": 0, "lowest_steps": 1, "highest_steps": None}]],
    "device.linked": ["gone"],
    "device.portsCame": [{"ports": [{"port": "sim://", "name": "Simulated"}], "families": []}],
    "device.previewCame": [{"question": {"id": "1", "axis": 0, "designs": []}, "preview": None, "rejections": []}],
    "device.pushed": ["1", {"designs": [document()], "ids": [0], "toAxis": 0, "crc": None}],
    "device.pushCutShort": ["1", {"designs": [document()], "ids": [0], "toAxis": 0, "before": None}],
    "device.refused": [[{"field": None, "value": None, "allowed": None, "message": "no"}]],
    "device.removeTrace": [],
    "device.setTracing": [False],
    "device.showMeasured": [{"of": {"axis": 0, "design": None}, "move": {"step": [1, 2]}}],
    "device.stopKnown": [True, "waiting"],
    "device.traceCame": ["1", {"step": [1]}],
    "guide.answer": ["ramp.slew_speed_steps_per_s", 1234],
    "guide.beginCarefully": [],
    "guide.closeGuide": [],
    "guide.goToStep": ["limits"],
    "guide.lengthenMove": [],
    "guide.openGuide": [],
    "guide.setDrive": ["wheel"],
    "guide.setMotor": [{"name": "P", "help": "", "values": {"microsteps": 32, "travel_unit": "mm"}}],
    "guide.setPlayer": ["grbl"],
    "guide.takeDrive": [],
    "library.besideCame": [{"a 1": None}],
    "library.layBeside": [{"key": "b 1", "label": "B, revision 1", "design": document()}],
    "library.link": [5, {"id": "a", "name": "A", "number": 1, "version": 1, "design": document()}],
    "library.relink": [7, {"name": "Renamed", "version": 3}],
    "library.takeAway": ["a 1"],
    "others.declineOther": ["b"],
    "others.otherChanged": [{"id": "b", "at_ms": 2, "isOpen": True, "machine": MACHINE}],
    "others.othersCame": [[{"id": "b", "at_ms": 1, "isOpen": False, "machine": MACHINE}]],
    "told.announce": ["Undone"],
    "told.closeFault": [],
    "told.closeNotice": [],
    "told.setAside": [MACHINE],
    "told.saved": ["full"],
    "told.showLink": ["#d=1"],
    "told.showTableText": ["{1, 2}"],
    "told.tell": ["Saved", False],
    "told.tellFault": ["broken"],
    "told.urge": ["ended", "It may still move"],
    "view.chooseTab": ["table", True],
    "view.look": [VIEW],
    "view.read": [{"step": 1, "time_s": 0, "x": 1, "methods": []}],
    "view.selectRow": [3],
    "view.tellInFlight": [[{"atMs": 0, "kind": "target", "value": 500}]],
    "view.setTheme": ["light"],
    "view.setUnits": [{"length": "mm", "time": "min"}],
    "view.drawMachine": [{"name": "tic", "title": "Pololu Tic"}],
    "view.showAll": [True],
    "view.switchMethod": ["newton"],
    "view.switchOwn": [],
    "view.wantPoints": [[1, 10]],
    "view.zoomTo": [[2, 5]],
    "work.addAxis": [],
    "work.begin": [{"axes": [OTHER], "together": "independent"}],
    "work.choose": [7],
    "work.endGesture": [],
    "work.mend": [7, {"text": "slower", "changes": [{"field": "ramp.slew_speed_steps_per_s", "value": 700}]}],
    "work.openInPlace": [OTHER],
    "work.open": [{"axes": [OTHER], "together": "independent"}],
    "work.pin": [],
    "work.setMeasured": ["stalled", {"rpm": "", "torque_nm": ""}],
    "work.setMechanism": ["screw"],
    "work.setValues": [[{"field": "ramp.acceleration_steps_per_s2", "value": 7000}]],
    "work.setMotor": [
        {"name": "One", "motor": {"holding_torque_nm": 0.5, "rated_current_a": 2}, "drive": {}, "axis": {}}
    ],
    "work.redo": [],
    "work.removeAxis": [7],
    "work.setMethod": ["compromise"],
    "work.setName": ["Named"],
    "work.setPlan": ["any_move"],
    "work.setPreset": ["axis", {"name": "P", "help": "", "values": {"microsteps": 32}}],
    "work.setShape": ["cosine"],
    "work.setTable": [[[10, 5000]], "us", "drag", 7],
    "work.setTogether": ["line"],
    "work.setValue": ["move.steps", 123, "slide:move.steps", 1],
    "work.undo": [],
    "work.unpin": [],
}
"""What each command is tried with: all of them do something to the state that STATE makes."""


def test_each_command_is_tried_here(modules: Modules) -> None:
    script = """async () => Object.entries((await import('/app/commands/commands.js')).COMMANDS)
        .flatMap(([noun, verbs]) => Object.keys(verbs).map((verb) => `${noun}.${verb}`))"""
    assert sorted(modules.evaluate(script)) == sorted(ARGUMENTS)
    folder = Path(FRONTEND / "app" / "commands")
    assert {path.stem for path in folder.glob("*.js")} - {"commands"} == {name.split(".")[0] for name in ARGUMENTS}


@pytest.mark.parametrize("command", sorted(ARGUMENTS))
def test_a_command_makes_another_state_and_leaves_the_old_one(modules: Modules, command: str) -> None:
    script = f"""async ([design, noun, verb, args]) => {{ {STATE}
        const before = JSON.stringify(state);
        const {{COMMANDS}} = await import('/app/commands/commands.js');
        const next = COMMANDS[noun][verb](state, ...frozen(args));
        return {{isOther: next !== state, isSame: JSON.stringify(state) === before,
            names: Object.keys(next).sort().join() === Object.keys(state).sort().join()}}; }}"""
    noun, verb = command.split(".")
    made = modules.evaluate(script, [document(), noun, verb, ARGUMENTS[command]])
    assert made == {"isOther": True, "isSame": True, "names": True}
