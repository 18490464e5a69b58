// @ts-check
// The design document: reading and changing its fields. A change gives a new document.

import { areEqual } from './equal.js';
import { METHODS, methodOf, REFERENCE } from './methods.js';
import { formatEntry } from './numbers.js';
import { isShape, shapeOf } from './shapes.js';

/** @typedef {import('./types.js').Design} Design */
/** @typedef {import('./types.js').Entry} Entry */
/** @typedef {import('./types.js').MethodName} MethodName */
/** @typedef {[Entry, Entry][]} Rows */

/** What the server takes at most. A longer table is never shown: its rows alone would stop the page for good. */
export const MOST_ROWS = 1000;
export const LONGEST_NAME = 100;

/** @param {Design} design @param {string} path such as "ramp.slew_speed_steps_per_s" @returns {any} */
export function valueAt(design, path) {
  return path.split('.').reduce((part, name) => part?.[name], /** @type {any} */ (design));
}

/** @param {Design} design @param {string} path @param {unknown} value undefined: the field is left out @returns {Design} */
export function withValue(design, path, value) {
  const [name, ...rest] = path.split('.');
  const part = /** @type {any} */ (design);
  if (rest.length === 0 && value === undefined) {
    const { [name]: _, ...others } = part;
    return others;
  }
  // What isn't changed is shared, so that who shows it sees at once that it is the same.
  return { ...part, [name]: rest.length === 0 ? value : withValue(part[name] ?? {}, rest.join('.'), value) };
}

/** @param {Design} design @param {import('./types.js').Remedy['changes']} changes with paths of a design @returns {Design} */
export const withChanges = (design, changes) => changes.reduce((changed, { field, value }) => withValue(changed, field, value), design);

/** A design to begin with: the numbers of another, without a name, table or method of its own.
 * @param {Design} design @returns {Design} */
export function unnamed(design) {
  return { ...withMethod(design, REFERENCE), name: '', table: null };
}

/** The design with another method, in the arithmetic usual for it; with its own method it stays as it is.
 * @param {Design} design @param {MethodName} name @returns {Design} */
export function withMethod(design, name) {
  if (name === design.method.name) return design;
  return { ...design, method: { ...design.method, name, arithmetic: methodOf(name).arithmetics[0] } };
}

/** @param {Design} design @param {Rows} rows @param {string} unit @returns {Design} */
export function withTable(design, rows, unit) {
  return { ...design, table: rows.length === 0 ? null : { rows, interval_unit: unit } };
}

/** The design with its table as its method.
 * @param {Design} design @returns {Design} */
export function withTablePlayed(design) {
  const player = METHODS.find((method) => method.plays_table);
  return player === undefined ? design : withMethod(design, player.name);
}

/** Whether designs are the same ramps: all but their names.
 * @param {Design[]} one @param {Design[]} other */
export function areSameRamps(one, other) {
  const nameless = (/** @type {Design[]} */ designs) => designs.map((design) => ({ ...design, name: '' }));
  return one === other || areEqual(nameless(one), nameless(other));
}

/** The methods to ask the server about: the design's own in any case, and of the shown ones those that are possible.
 * @param {Design} design @param {ReadonlySet<MethodName>} shown */
export function methodsToCompute(design, shown) {
  const { methods } = shapeOf(design);
  const isPossible = (/** @type {MethodName} */ name) =>
    methods.includes(name) && (!methodOf(name).plays_table || design.table !== null);
  return METHODS.map((method) => method.name).filter(
    (name) => name === design.method.name || (shown.has(name) && isPossible(name)),
  );
}

/** Steps a second that a table row gives; NaN where the row holds no number.
 * @param {Design} design @param {Entry} interval @param {string} unit */
export function rowSpeed(design, interval, unit) {
  const perSecond = unit === 'ticks' ? design.timer.frequency_hz : 1e6;
  return typeof interval === 'number' && typeof perSecond === 'number' && interval > 0 ? perSecond / interval : NaN;
}

/** Why delays can't be told in the other unit without being lost; '' when they can.
 * @param {Rows} rows @param {string} unit to convert to @param {Entry} frequencyHz */
export function conversionProblem(rows, unit, frequencyHz) {
  const [from, to] = unit === 'ticks' ? ['µs', 'ticks'] : ['ticks', 'µs'];
  if (typeof frequencyHz !== 'number' || !(frequencyHz > 0) || !Number.isFinite(frequencyHz)) {
    const given = typeof frequencyHz === 'number' ? formatEntry(frequencyHz) : `“${frequencyHz}”`;
    return `The delays stay in ${from}: the timer’s frequency is ${given}; a number above 0 converts them.`;
  }
  const perFrom = unit === 'ticks' ? frequencyHz / 1e6 : 1e6 / frequencyHz;
  const lost = rows.findIndex(([, delay]) => typeof delay === 'number' && delay > 0 && delay * perFrom < 0.5);
  if (lost < 0) return '';
  return `The delays stay in ${from}: at ${formatEntry(frequencyHz)} Hz that of row ${lost + 1} would be 0 ${to}.`;
}

/** The rows with their delays in the other unit, to whole numbers, and how many of them had to be rounded.
 * @param {Rows} rows @param {string} unit to convert to @param {number} frequencyHz */
export function convertedRows(rows, unit, frequencyHz) {
  let rounded = 0;
  const factor = unit === 'ticks' ? frequencyHz / 1e6 : 1e6 / frequencyHz;
  /** @type {Rows} */
  const converted = rows.map(([step, interval]) => {
    if (typeof interval !== 'number') return [step, interval];
    const whole = Math.max(1, Math.round(interval * factor));
    rounded += Number(Math.abs(whole - interval * factor) > 1e-6);
    return [step, whole];
  });
  return { rows: converted, rounded };
}

/** A new row after row `after`: halfway to the next one, or beyond the last one.
 * @param {Rows} rows @param {number} after @param {string} unit @param {Entry} frequencyHz @returns {[Entry, Entry]} */
export function rowAfter(rows, after, unit, frequencyHz) {
  if (rows.length === 0)
    return [10, unit === 'ticks' && typeof frequencyHz === 'number' ? Math.round(frequencyHz / 200) : 5000];
  const [step, interval] = rows[after].map(Number);
  const [nextStep, nextInterval] = after + 1 < rows.length ? rows[after + 1].map(Number) : [step * 2, interval * 0.7];
  return [Math.ceil((step + nextStep) / 2) || 1, Math.round((interval + nextInterval) / 2) || 1];
}

/** Whether a stored document has the shape that the page can show; its values are for the server to judge.
 * @param {any} document @returns {document is Design} */
export function isDesign(document) {
  /** @param {unknown} part */
  const isObject = (part) => typeof part === 'object' && part !== null && !Array.isArray(part);
  return (
    isObject(document) &&
    typeof document.name === 'string' &&
    ['axis', 'timer', 'ramp', 'method', 'move'].every((part) => isObject(document[part])) &&
    METHODS.some((method) => method.name === document.method.name) &&
    ['motor', 'drive', 'load'].every((part) => document[part] === undefined || isObject(document[part])) &&
    (document.ramp.shape === undefined || isShape(document.ramp.shape)) &&
    (document.table === null ||
      (isObject(document.table) &&
        Array.isArray(document.table.rows) &&
        document.table.rows.length <= MOST_ROWS &&
        document.table.rows.every((/** @type {unknown} */ row) => Array.isArray(row) && row.length === 2)))
  );
}
