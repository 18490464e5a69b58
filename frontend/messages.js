// @ts-check
// Where the server's messages belong on the page.

import { GROUPS } from './fields.js';

/** @typedef {import('./types.js').Rejection} Rejection */
/** What was refused, when something was, is kept to be told in other units.
 * @typedef {{text: string, isWarning: boolean, refused?: {value: unknown, allowed: string}}} Message */
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
  table: 'Lookup table',
};
const LABELS = new Map([
  ...Object.entries(CHOICE_LABELS),
  ...GROUPS.flatMap((group) => group.fields).map(
    (field) => /** @type {[string, string]} */ ([field.path, field.label]),
  ),
]);
/** A push calls the designs of axes by their axes. */
const OF_AXIS = /^(?:designs|axes)\.(\d+)\.(.*)$/;
const ROW = /^table\.rows\.(\d+)(?:\.([01]))?$/;

/**
 * Sort messages by the place that shows them. Errors come before warnings: the first at a place is kept.
 * @param {Rejection[]} errors
 * @param {{field: string | null, message: string}[]} warnings
 * @returns {Messages}
 */
export function sortMessages(errors, warnings) {
  /** @type {Messages} */
  const sorted = { fields: new Map(), rows: new Map(), others: [] };
  for (const { field, message, value, allowed } of errors) {
    place(sorted, field, message, false, allowed === null ? undefined : { value, allowed });
  }
  for (const { field, message } of warnings) place(sorted, field, message, true);
  return sorted;
}

/** What was refused, as one text that calls the fields what the page calls them.
 * @param {Rejection[]} errors */
export function textOf(errors) {
  const { fields, rows, others } = sortMessages(errors, []);
  return [...fields.values(), ...rows.values(), ...others].map(({ text }) => text).join(' ');
}

/** Why designs can't be pushed, of one axis or of several.
 * @param {Rejection[]} errors */
export function pushText(errors) {
  const ofAxes = errors.filter(({ field }) => OF_AXIS.test(field ?? ''));
  const others = errors.filter((error) => !ofAxes.includes(error));
  return [textOf(others), ...axesMessages(ofAxes, false).map(({ text }) => text)].filter(Boolean).join(' ');
}

/** What is said of all axes together, each message with the axis it is about.
 * @param {{field: string | null, message: string}[]} list @param {boolean} isWarning @returns {Message[]} */
export function axesMessages(list, isWarning) {
  return list.map(({ field, message }) => {
    const [, axis, path] = OF_AXIS.exec(field ?? '') ?? [];
    const label = LABELS.get(path);
    const text = (label === undefined ? message : named(message, field, label)).replace(/\bdesigns\.(\d)/g, 'axis $1');
    const isNamed = axis === undefined || text.includes(`axis ${axis}`);
    return { text: isNamed ? text : `Axis ${axis}: ${text}`, isWarning };
  });
}

/** @param {Messages} sorted @param {string | null} field @param {string} message @param {boolean} isWarning
 * @param {Message['refused']} [refused] */
function place(sorted, field, message, isWarning, refused) {
  const whole = (field ?? '').replace(/^design\./, '');
  const row = ROW.exec(whole);
  // The table has one place for all that is not about one row.
  const path = /^table\b/.test(whole) ? 'table' : whole;
  if (row) {
    const [index, column] = [Number(row[1]), row[2] === undefined ? null : Number(row[2])];
    const label = `Row ${index + 1}${column === null ? '' : column === 0 ? ', last index,' : ', delay,'}`;
    if (!sorted.rows.has(index)) sorted.rows.set(index, { column, text: named(message, field, label), isWarning });
  } else if (LABELS.has(path)) {
    const text = named(message, field, /** @type {string} */ (LABELS.get(path)));
    if (!sorted.fields.has(path)) sorted.fields.set(path, { text, isWarning, refused });
  } else {
    sorted.others.push({ text: message, isWarning });
  }
}

/** The server's sentence with the field called what the page calls it.
 * @param {string} message @param {string | null} field @param {string} label */
function named(message, field, label) {
  const path = field ?? '';
  const short = path.replace(/^design\./, '');
  return message.startsWith(path)
    ? label + message.slice(path.length)
    : message.startsWith(short)
      ? label + message.slice(short.length)
      : message;
}
