"""Plain objects that stand in for a page's elements, so that dialogs and notices are tried without a browser."""

from typing import Any

from designs import document
from frontend.modules import Modules

# `textOf(element)` is all its text; `find(element, wanted)` the first within it that `wanted` is true of.
# `pass()` ends what waits, as time does; `settled()` lets all promises go on.
ELEMENTS = """
    const own = {document: globalThis.document, HTMLInputElement: globalThis.HTMLInputElement,
        addEventListener: globalThis.addEventListener, setTimeout: globalThis.setTimeout,
        clearTimeout: globalThis.clearTimeout};
    const made = (tag) => { const heard = {};
        const plain = {tag, children: [], dataset: {}, style: {}, value: '', textContent: '',
            hidden: false, disabled: false, options: [], open: false, classList: {toggle() {}, add() {}, remove() {}},
            addEventListener(name, act) { heard[name] = act; }, emit(name, event) { heard[name]?.(event); },
            get lastElementChild() { return this.children.at(-1) ?? null; },
            append(...more) { this.children.push(...more); }, replaceChildren(...more) { this.children = more; },
            setAttribute(name, value) { this[name] = value; }, getAttribute(name) { return this[name] ?? null; },
            removeAttribute(name) { delete this[name]; }, toggleAttribute() {},
            querySelectorAll: () => [], querySelector: () => made('input'), focus() {}, select() {},
            show() { this.open = true; }, close() { this.open = false; heard.close?.(); }};
        return new Proxy(plain, {has: () => true}); };
    const body = made('body'), waiting = new Map();
    globalThis.document = {createElement: made, createElementNS: (_, tag) => made(tag), body, activeElement: null};
    globalThis.HTMLInputElement = class {};
    globalThis.addEventListener = () => {};
    globalThis.setTimeout = (act) => { const id = {}; waiting.set(id, act); return id; };
    globalThis.clearTimeout = (id) => waiting.delete(id);
    const pass = () => { const due = [...waiting.values()]; waiting.clear(); for (const act of due) act(); };
    const settled = () => new Promise((done) => own.setTimeout(done, 0));
    const textOf = (one) => typeof one === 'string' ? one : one.textContent + one.children.map(textOf).join(' ');
    const find = (one, wanted) => typeof one === 'string' ? null : wanted(one) ? one :
        one.children.map((child) => find(child, wanted)).find((found) => found) ?? null;
    const byId = (id) => find(body, (one) => one.id === id);
    const {ServerGone} = await import('/server/api.js');
    const gone = () => Promise.reject(new ServerGone('gone'));
"""


def run(modules: Modules, script: str) -> Any:
    """Return what a script makes of a design, with elements to stand in for a page's."""
    whole = f"async (design) => {{ {ELEMENTS} try {{ {script} }} finally {{ Object.assign(globalThis, own); }} }}"
    return modules.evaluate(whole, document())


NOBODY = "The server does not answer. It is asked again until it does."


LOST = """{text: '$100=80', file_name: 'a.gcode', settings: [],
    remarks: ['Base speed 100 steps/s is not kept.', 'Another is.'],
    remarks_told: [[{text: '100 steps/s', value: 100, unit: 'steps/s', rounding: 'nearest', axis: null}], []]}"""

REFUSED = """new Refusal(422, [{field: 'design.ramp.slew_speed_steps_per_s', value: 0.5, allowed: 'a number',
    message: 'no', limits: {lowest: 1, highest: null, is_whole: false, note: ' with it'}, unit: 'steps/s'}])"""

OF_50_STEPS_PER_MM = ["Base speed 100 steps/s is not kept.", "Base speed 2 mm/s is not kept."]
