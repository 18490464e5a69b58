// @ts-check
// What the browser remembers: written a moment after it has changed, and at the latest when the page is left.

import { keepInView, keptInView } from '../../documents/in_view.js';
import { memory } from '../../documents/memory.js';
import { records } from '../../documents/records.js';
import { keptMaps } from '../../documents/stall_maps.js';
import { FIRST_GUIDE, knownAnswers } from '../../model/guide.js';
import { saved } from '../commands/told.js';
import { inViewOf } from '../devices.js';
import { isOwnWork, machineOf } from '../selectors.js';
import { FIRST_STATE, whenChanged, whenever } from '../state.js';

/** @typedef {import('../../documents/records.js').TabRecord} TabRecord */
/** @typedef {import('../state.js').State} State */

// Dozens of changes a second while a slider moves: the last one counts.
const AFTER_MS = 200;

/** The state that the page begins with: the first one, with what the browser remembers.
 * @param {{id: string, record: TabRecord | null}} tab and what it begins with @param {number} firstId @returns {State} */
export function rememberedState({ id, record }, firstId) {
  const kept = keptInView();
  const chosen = kept && { kept, port: kept.port, axis: kept.axis };
  const devices = { ...FIRST_STATE.devices, ...chosen, chosenFamilies: memory.families(), softLimits: memory.allSoftLimits() };
  const shown = memory.shown() ?? FIRST_STATE.shown;
  const first = { ...FIRST_STATE, units: memory.units(), shown, devices, firstId, stallMaps: keptMaps(id) };
  if (record === null) return first;
  const { machine, isExample, replaced, views, areAllShown, allZoom, inFlight, links } = record;
  const lastExample = isExample ? machine.axes[0] : null;
  const guide = { ...FIRST_GUIDE, ...record.guide };
  const library = { ...first.library, links };
  return { ...first, library, units: record.units, shown: record.shown, lastExample, replaced, views, areAllShown, allZoom, guide, inFlight };
}

/** What the tab keeps; null: there is nothing yet.
 * @param {State} state @returns {TabRecord | null} */
export function recordOf(state) {
  const machine = machineOf(state);
  if (machine === null) return null;
  const { replaced, units, shown, areAllShown, allZoom, inFlight } = state;
  const views = Object.fromEntries(machine.ids.flatMap((id) => (state.views[id] ? [[id, state.views[id]]] : [])));
  const links = Object.fromEntries(machine.ids.flatMap((id) => (state.library.links[id] ? [[id, state.library.links[id]]] : [])));
  const isExample = !isOwnWork(state);
  const isOwn = !isExample || replaced !== null;
  const guide = knownAnswers(state.guide);
  return { at_ms: Date.now(), isOwn, isExample, machine, replaced, units, shown, views, areAllShown, allZoom, guide, inFlight, links };
}

/** @param {import('../state.js').Store} store @param {string} tab its id */
export function saveByItself({ state, dispatch, subscribe }, tab) {
  /** What is to be written, by what it is.
   * @type {Map<string, () => void>} */
  const waiting = new Map();
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  let timer;

  function write() {
    clearTimeout(timer);
    const writes = [...waiting.values()];
    waiting.clear();
    for (const one of writes) one();
  }

  /** @param {string} what @param {() => void} writing */
  function soon(what, writing) {
    if (waiting.size === 0) timer = setTimeout(write, AFTER_MS);
    waiting.set(what, writing);
  }

  function writeRecord() {
    const record = recordOf(state());
    if (record !== null) dispatch(saved, records.write(tab, record));
  }

  /** What a tab begins with that is opened anew.
   * @template {unknown[]} Parts
   * @param {string} what @param {(state: State) => [...Parts]} look @param {(...parts: Parts) => void} keep */
  function save(what, look, keep) {
    subscribe(whenChanged(look, (...parts) => soon(what, () => keep(...parts)), state()));
  }

  save('units', (now) => [now.units], memory.keepUnits);
  save('shown', (now) => [now.shown], memory.keepShown);
  save('in view', inViewOf, keepInView);
  subscribe(
    whenever(
      (now) => [machineOf(now), now.replaced, now.units, now.shown, now.views, now.areAllShown, now.allZoom, now.inFlight, now.library.links, now.examples, now.guide.drive, now.guide.player],
      () => soon('record', writeRecord),
      state(),
    ),
  );
  addEventListener('pagehide', write);
  document.addEventListener('visibilitychange', () => document.hidden && write());
}
