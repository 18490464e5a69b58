// @ts-check
// Where the server's messages belong on the page.

import { GROUPS } from './fields.js';
import { METHODS } from './methods.js';
import { formatEntry, isNumberText, pointHint } from './numbers.js';
import { SHAPES } from './shapes.js';

/** @typedef {import('./types.js').Rejection} Rejection */
/** Something that works, but not as the design says; or what makes an axis slower along a line, which says whose it is.
 * @typedef {{field: string | null, message: string, axis?: number, told?: import('./types.js').Told[]}} Remark */
/** What was refused, when something was, is kept to be told in other units, and to be mended.
 * about: what it can be closed by, when it can; design: which it is said of, whose units need not be those of the one in hand.
 * @typedef {{text: string, isWarning: boolean, refused?: Rejection, about?: string,
 *   design?: import('./types.js').Design}} Message */
/** A remark is worth a look, and no more: it is told in full where the row is selected.
 * @typedef {{column: number | null, isRemark?: boolean} & Message} RowMessage */

/** @typedef {object} Messages
 * @property {Map<string, Message>} fields  by path in the design
 * @property {Map<number, RowMessage>} rows  by row of the table
 * @property {Message[]} others              those that no field shows */

const CHOICE_LABELS = {
  'method.name': 'Method',
  'method.arithmetic': 'Arithmetic',
  'method.rounding': 'Rounding',
  'method.tuned_for': 'Tuned for',
  'axis.travel_unit': 'Travel unit',
  'ramp.shape.name': 'Shape',
  'ramp.shape.points': 'Drawn acceleration',
  'motor.kind': 'Kind',
  'motor.stalled': 'Stall point',
  'motor.torque_curve': 'Torque curve',
  'drive.current_is': 'Current is',
  'motor.measured_with.current_is': 'Current then is',
  'load.mechanism': 'Moved by',
  'load.mechanism.name': 'Moved by',
  'move.plan': 'Short moves',
  table: 'Lookup table',
};
const LABELS = new Map([
  ['name', 'Name'],
  ...Object.entries(CHOICE_LABELS),
  ...GROUPS.flatMap((group) => group.fields).map(
    (field) => /** @type {[string, string]} */ ([field.path, field.label]),
  ),
]);
/** What the page calls a field of a design; of one that it shows nowhere, its path.
 * @param {string} path */
export const labelOf = (path) => LABELS.get(path) ?? LABELS.get(path.split('.')[0]) ?? path;

/** What is about several axes calls their designs by their places. */
const OF_AXIS = /^(?:designs|axes)\.(\d+)\.(.*)$/;
/** So does a push; of one design there is no place. */
const OF_DESIGN = /^(?:axes\.(\d+)|design)\.(.*)$/;
// A cut list or object is told in words by the server already.
const LONGEST_VALUE = 80;
const POINT = /^(ramp\.shape\.points|motor\.torque_curve)\.(\d+)(?:\.([01]))?$/;
const ROW = /^table\.rows\.(\d+)(?:\.([01]))?$/;

/**
 * Sort messages by the place that shows them. Errors come before warnings: the first at a place is kept.
 * @param {Rejection[]} errors
 * @param {Remark[]} warnings
 * @param {import('./types.js').Design} [design] that was refused
 * @returns {Messages}
 */
export function sortMessages(errors, warnings, design) {
  /** @type {Messages} */
  const sorted = { fields: new Map(), rows: new Map(), others: [] };
  for (const error of errors) place(sorted, error, error, design);
  for (const warning of warnings) place(sorted, warning);
  return sorted;
}

/** What was refused, as a sentence that calls the field by its label.
 * @param {Rejection} rejection @param {string} label @param {{given?: string, allowed?: string | null}} [words] of the
 *   value and of what is allowed, where they are told in another unit */
export function refusalText({ message, value, reason, ...rejection }, label, words = {}) {
  const { choices } = rejection;
  const allowed = words.allowed ?? (choices ? choicesText(choices) : rejection.allowed);
  return reason !== undefined || allowed === null
    ? message
    : `${label} is ${words.given ?? rejection.given ?? givenText(value, rejection)}; allowed: ${allowed}.${pointHint(value)}`;
}

/** @param {unknown} value @param {Pick<Rejection, 'choices' | 'limits' | 'unit'>} rejection */
function givenText(value, { choices, limits, unit }) {
  if (typeof value !== 'string') return valueText(value);
  if (choices) return nameOf(value);
  // Of a list the server tells how long it is.
  const isLength = limits && unit === 'items' && /^[\d,]+ items?$/.test(value);
  return isLength ? value.replace(/^0 items$/, 'empty') : valueText(value);
}

/** Names that are allowed, as the page calls them, and what leaves only these.
 * @param {import('./types.js').Choices} choices */
function choicesText({ names, because: { field, value }, is_need }) {
  const label = LABELS.get(field.replace(/^(?:designs?|axes)\.(?:\d+\.)?/, '')) ?? field;
  const words = [names.map(nameOf).join(', '), label.toLowerCase(), nameOf(value)];
  return is_need ? `${words[0]}, since the ${words[1]} is ${words[2]}` : `${words[0]} with ${words[1]} ${words[2]}`;
}

/** What the page calls a method, a shape or another choice.
 * @param {unknown} value */
export const nameOf = (value) => [...METHODS, ...SHAPES].find(({ name }) => name === value)?.label ?? String(value);

/** What is wrong with a design's name: how long it is says more than what it begins with.
 * @param {Message | undefined} problem @param {string} name of which a refusal has the beginning only
 * @returns {string} empty: nothing */
export function nameText(problem, name) {
  const most = problem?.refused?.limits?.highest;
  const length = [...name].length.toLocaleString('en-US');
  return most ? `The name has ${length} characters; allowed: at most ${most}.` : (problem?.text ?? '');
}

/** What a number of the table is called in a sentence about it.
 * @param {number} index of the row, from 0 @param {number | null} column null: the whole row */
export function rowLabel(index, column) {
  return `Row ${index + 1}${column === null ? '' : column === 0 ? ', last index,' : ', delay,'}`;
}

/** What a point of a drawn acceleration or a torque curve, or one of its numbers, is called.
 * @param {RegExpExecArray} point */
function pointLabel([, path, index, column]) {
  const value = path === 'motor.torque_curve' ? 'torque' : 'part';
  return `Point ${Number(index) + 1}${column === undefined ? '' : column === '0' ? ', speed,' : `, ${value},`}`;
}

/** @param {unknown} value */
function valueText(value) {
  if (value === null) return 'missing';
  if (value === '') return 'empty';
  if (typeof value === 'number') return formatEntry(value);
  // A number that is too large for one is no word.
  const text = typeof value !== 'string' ? JSON.stringify(value) : isNumberText(value) ? value : `'${value}'`;
  return text.length <= LONGEST_VALUE ? text : `${text.slice(0, LONGEST_VALUE - 1)}…`;
}

/** What was refused, as one text that calls the fields what the page calls them.
 * @param {Rejection[]} errors */
export function textOf(errors) {
  const { fields, rows, others } = sortMessages(errors, []);
  return [...fields.values(), ...rows.values(), ...others].map(({ text }) => text).join(' ');
}

/** Why designs can't be pushed, each with its place among them; null: it is nothing of a design. Remedies have the paths
 * of a design.
 * @param {Rejection[]} errors @returns {{text: string, axis: number | null, remedies: import('./types.js').Remedy[]}[]} */
export function pushRefusals(errors) {
  return errors.map((error) => {
    const [, number, path] = OF_DESIGN.exec(error.field ?? '') ?? [];
    const text = number === undefined ? textOf([error]) : axesMessages([error], false)[0].text;
    const remedies = (error.remedies ?? []).map((remedy) => ({
      ...remedy,
      changes: remedy.changes.map(({ field, value }) => ({ field: OF_DESIGN.exec(field)?.[2] ?? field, value })),
    }));
    return { text, axis: path === undefined ? null : Number(number ?? 0), remedies };
  });
}

/** The same as one text.
 * @param {Rejection[]} errors */
export const pushText = (errors) => pushRefusals(errors).map(({ text }) => text).join(' ');

/** What is said of all axes together, each message with the axis it is about.
 * @param {(Rejection | Remark)[]} list @param {boolean} isWarning @returns {Message[]} */
export function axesMessages(list, isWarning) {
  return list.map((one) => {
    const [, axis, path] = OF_AXIS.exec(one.field ?? '') ?? [];
    const label = LABELS.get(path);
    const text = label !== undefined && 'allowed' in one ? refusalText(one, label) : one.message;
    const namesItself = axis === undefined || 'axis' in one;
    return { text: namesItself ? text : `Axis ${axis}: ${text}`, isWarning };
  });
}

/** @param {Messages} sorted @param {Remark} remark @param {Rejection} [refused] the same, when it is one
 * @param {import('./types.js').Design} [design] that it is said of */
function place(sorted, { field, message }, refused, design) {
  const isWarning = refused === undefined;
  const textWith = (/** @type {string} */ label) => (refused ? refusalText(refused, label) : message);
  const whole = (field ?? '').replace(/^design\./, '');
  const row = ROW.exec(whole);
  // The table has one place for all that is not about one row.
  const point = POINT.exec(whole);
  const path = /^table\b/.test(whole) ? 'table' : point ? point[1] : whole;
  const label = point ? pointLabel(point) : LABELS.get(path);
  if (row) {
    const [index, column] = [Number(row[1]), row[2] === undefined ? null : Number(row[2])];
    if (!sorted.rows.has(index)) sorted.rows.set(index, { column, text: textWith(rowLabel(index, column)), isWarning });
  } else if (label !== undefined) {
    const text = textWith(label);
    if (!sorted.fields.has(path)) sorted.fields.set(path, { text, isWarning, refused, design });
  } else {
    sorted.others.push({ text: message, isWarning });
  }
}
