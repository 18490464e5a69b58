// @ts-check
// What a person works on: up to four designs as axes of one machine, one of them in hand, one design pinned to compare
// with, and the history of all of it. Nothing here is changed: what a change makes is another history.

import { LONGEST_NAME } from './design.js';
import { areEqual } from './equal.js';

/** @typedef {import('./types.js').Design} Design */
/** @typedef {'independent' | 'line'} Together */
/** @typedef {{axes: Design[], together: Together}} Work   what is saved and shared */
/** `ids` are those of the axes, in their order: an axis keeps its id while others come and go, when it comes back, and in
 * another tab.
 * @typedef {Work & {ids: number[], active: number, kept: Design | null}} Machine */

/** @typedef {object} History
 * @property {readonly Machine[]} past     the oldest first
 * @property {Machine} present
 * @property {readonly Machine[]} future   the farthest first
 * @property {readonly Machine[]} dropped  the future that the gesture under way took the place of: back, if it is given up
 * @property {string} gesture              that the last change was a part of; '' when it stood alone
 * @property {number} at_ms                when the gesture went on
 * @property {number} nextId               no axis has had it yet */

export const MOST_AXES = 4;
// As many steps back as anybody goes, and never so many that the browser's memory fills.
const MOST_STEPS_BACK = 500;
// Turns of the wheel and presses of keys have no end of their own: after such a pause they are others.
const STEPS_END_AFTER_MS = 2_000;
/** How the names of such gestures begin. */
export const STEP_GESTURE = 'step:';
/** How the names of what the guide changes begin: each of its steps is one, whatever is let go of meanwhile. */
export const GUIDE_GESTURE = 'guide:';
/** How the name of a slider's drag begins. */
export const SLIDE_GESTURE = 'slide:';

/** @param {Work & {active?: number, kept?: Design | null, ids?: number[]}} first
 * @param {number} [firstId] from which on no axis of any tab has an id @returns {History} */
export function historyOf({ axes, together, active = 0, kept = null, ids }, firstId = Math.max(-1, ...(ids ?? [])) + 1) {
  const present = { axes, together, active, kept, ids: ids ?? axes.map((_, index) => firstId + index) };
  return { past: [], present, future: [], dropped: [], gesture: '', at_ms: 0, nextId: ids ? firstId : firstId + axes.length };
}

/** @param {History} history @param {Machine} next @param {string} [gesture] @param {number} [at_ms] @returns {History} */
function changed(history, next, gesture = '', at_ms = 0) {
  const { past, present, future } = history;
  if (areEqual(next, present)) return history;
  const isPaused = gesture.startsWith(STEP_GESTURE) && at_ms - history.at_ms > STEPS_END_AFTER_MS;
  const goesOn = gesture !== '' && gesture === history.gesture && !isPaused && past.length > 0;
  const before = goesOn ? past : [...past, present].slice(-MOST_STEPS_BACK);
  const dropped = goesOn ? history.dropped : future;
  const after = { ...history, past: before, present: next, future: [], dropped, gesture, at_ms };
  // A slider on its way passes where it began, and goes on; any other gesture that comes back is over.
  return goesOn && !gesture.startsWith(SLIDE_GESTURE) && isBack(after) ? gestureEnded(after) : after;
}

/** Whether what is in hand is what it was before the last change.
 * @param {History} history */
const isBack = ({ past, present }) => past.length > 0 && areEqual(present, past[past.length - 1]);

/** The design of an axis becomes another. Changes in a row that are one gesture are undone as one.
 * @param {History} history @param {number} id @param {Design} design
 * @param {string} [gesture] such as "slide:ramp.slew_speed_steps_per_s"
 * @param {number} [at_ms] when, by any clock that goes on; for gestures of steps
 * @returns {History} */
export function withDesign(history, id, design, gesture, at_ms) {
  const { present } = history;
  const index = present.ids.indexOf(id);
  if (index < 0) return history;
  return changed(history, { ...present, axes: present.axes.with(index, design) }, gesture, at_ms);
}

/** A gesture has ended: the next change is undone by itself, whatever it is. One that ended where it began, as a drag that
 * is given up, was none.
 * @param {History} history @returns {History} */
export function gestureEnded(history) {
  if (history.gesture === '') return history;
  const { past, dropped } = history;
  const kept = isBack(history) ? { past: past.slice(0, -1), present: past[past.length - 1], future: dropped } : {};
  return { ...history, ...kept, dropped: [], gesture: '' };
}

/** All axes at once, as other ones: a file, a link, an example. Those of another tab bring their ids.
 * @param {History} history @param {Work & {ids?: number[]}} work @returns {History} */
export function replaced(history, { axes, together, ids = axes.map((_, index) => history.nextId + index) }) {
  const next = changed(history, { ...history.present, axes, together, ids, active: 0 });
  return { ...next, nextId: history.nextId + axes.length };
}

/** Another axis in the place of the one in hand, which an undo brings back as what it was.
 * @param {History} history @param {Design} design @returns {History} */
export function withAxisInPlace(history, design) {
  const { present, nextId } = history;
  const { axes, ids, active } = present;
  return { ...changed(history, { ...present, axes: axes.with(active, design), ids: ids.with(active, nextId) }), nextId: nextId + 1 };
}

/** The ids of all axes that are in hand, or may come back.
 * @param {History} history @returns {Set<number>} */
export const idsOf = (history) => new Set(machinesOf(history).flatMap(({ ids }) => ids));

/** The tables of all axes that are in hand, or may come back.
 * @param {History} history */
export const tablesOf = (history) => machinesOf(history).flatMap(({ axes }) => axes.map(({ table }) => table));

/** @param {History} history */
const machinesOf = ({ past, present, future, dropped }) => [...past, present, ...future, ...dropped];

/** @param {History} history @returns {History} */
export function undone(history) {
  const { past, present, future } = history;
  if (past.length === 0) return history;
  return { ...history, past: past.slice(0, -1), present: past[past.length - 1], future: [...future, present], gesture: '' };
}

/** @param {History} history @returns {History} */
export function redone(history) {
  const { past, present, future } = history;
  if (future.length === 0) return history;
  return { ...history, past: [...past, present], present: future[future.length - 1], future: future.slice(0, -1), gesture: '' };
}

/** Another axis after the last one, alike the one in hand. Nothing happens when there are four.
 * @param {History} history @param {Design} [design] @returns {History} */
export function withAxis(history, design = history.present.axes[history.present.active]) {
  const { present, nextId } = history;
  if (present.axes.length === MOST_AXES) return history;
  const axes = [...present.axes, design];
  const next = changed(history, { ...present, axes, ids: [...present.ids, nextId], active: present.axes.length });
  return { ...next, nextId: nextId + 1 };
}

/** @param {History} history @param {number} id the last one stays @returns {History} */
export function withoutAxis(history, id) {
  const { present } = history;
  const index = present.ids.indexOf(id);
  if (present.axes.length === 1 || index < 0) return history;
  const axes = present.axes.toSpliced(index, 1);
  const active = Math.min(present.active - Number(index < present.active), axes.length - 1);
  return changed(history, { ...present, axes, ids: present.ids.toSpliced(index, 1), active: Math.max(0, active) });
}

/** Another axis in hand: no step of the history, as nothing is changed by it.
 * @param {History} history @param {number} id @returns {History} */
export function withAxisInHand(history, id) {
  const active = history.present.ids.indexOf(id);
  if (active < 0 || active === history.present.active) return history;
  return { ...history, present: { ...history.present, active }, gesture: '' };
}

/** @param {History} history @param {Together} together @returns {History} */
export function movedTogether(history, together) {
  return changed(history, { ...history.present, together });
}

/** The design in hand is pinned, to compare the next ones with; null: none is any more.
 * @param {History} history @param {Design | null} kept @returns {History} */
export function pinnedTo(history, kept) {
  return changed(history, { ...history.present, kept });
}

/** The same work under other names: "Stage copy", then "Stage copy 2". A name stays within its limit.
 * @param {Work} work @returns {Work} */
export function duplicateOf({ axes, together }) {
  return { axes: axes.map((design) => ({ ...design, name: copyName(design.name) })), together };
}

/** @param {string} name */
function copyName(name) {
  const [isCopy, start = '', number = '1'] = /^(?:(.*) )?copy(?: (\d+))?$/su.exec(name) ?? ['', name];
  const end = isCopy ? `copy ${Number(number) + 1}` : 'copy';
  const begun = [...start].slice(0, LONGEST_NAME - end.length - 1).join('');
  return begun === '' ? end : `${begun} ${end}`;
}
