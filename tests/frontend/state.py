"""A state to begin with, and what is seen of it after commands."""

from __future__ import annotations

from designs import document
from frontend.modules import Modules

OTHER = {**document(), "name": "Other"}
DEVICE = {"id": "1", "port": "sim://", "name": "Simulated", "state": "ready", "axes": [], "most_axes": 4, "stops": 0}
MACHINE = {"axes": [document()], "together": "line", "ids": [0], "active": 0, "kept": None}
VIEW = {"against": "time", "part": "up"}

# Two axes, 5 and 7, of which 5 is in hand; a step back, one forward, a gesture under way, one design pinned; a
# captured file.
STATE = """const {FIRST_STATE} = await import('/app/state.js');
    const frozen = (value) => { if (typeof value === 'object' && value !== null && !Object.isFrozen(value)) {
        Object.freeze(value); Object.values(value).forEach(frozen); } return value; };
    const machine = (name) => ({axes: [{...design, name}, {...design, name: 'B'}], ids: [5, 7], active: 0,
        together: 'independent', kept: {...design, name: 'Pinned'}});
    const state = frozen({...structuredClone(FIRST_STATE), shown: ['exact', 'first_order'],
        capture: {file: {name: 'one.csv', size: 9}, axis: 5, wish: {step_channel: 'D0', edge: 'falling', move_number: 2,
            direction_channel: '', alignment: 'best_fit', shortest_pulse_us: 2, longest_wait_us: null},
            stage: 'refused', sent: 0.5, answer: null, of: null, rejections: [], before: null},
        library: {links: {7: {id: 'a', name: 'A', number: 1, version: 1, design}},
            beside: [{key: 'a 1', label: 'A, revision 1', design, curves: null}]},
        guide: {...FIRST_STATE.guide, isOpen: true},
        devices: {...structuredClone(FIRST_STATE.devices), asking: 'connect'},
        history: {past: [machine('before')], present: machine('A'), future: [machine('after')], dropped: [],
            gesture: 'name', at_ms: 0, nextId: 8}});"""


def after(modules: Modules, steps: list[list[object]], look: str) -> object:
    """Return what is seen of the state after commands, each with its arguments."""
    script = f"""async ([design, steps]) => {{ {STATE}
        const {{COMMANDS}} = await import('/app/commands/commands.js');
        const selectors = {{...await import('/app/selectors.js'), ...await import('/app/devices.js')}};
        const end = steps.reduce((now, [name, ...args]) => {{ const [noun, verb] = name.split('.');
            return frozen(COMMANDS[noun][verb](now, ...args)); }}, state);
        return ({look})(end, selectors); }}"""
    return modules.evaluate(script, [document(), steps])
