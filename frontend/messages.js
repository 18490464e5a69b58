// @ts-check
// Where the server's messages belong on the page.

import { GROUPS } from './fields.js';

/** @typedef {import('./types.js').Rejection} Rejection */
/** @typedef {{text: string, isWarning: boolean}} Message */
/** @typedef {{column: number | null} & Message} RowMessage */

/** @typedef {object} Messages
 * @property {Map<string, Message>} fields  by path in the design
 * @property {Map<number, RowMessage>} rows  by row of the table
 * @property {Message[]} others              those that no field shows */

const CHOICE_LABELS = {
  'method.name': 'Method',
  'method.arithmetic': 'Arithmetic',
  'method.rounding': 'Rounding',
  'axis.travel_unit': 'Travel unit',
  table: 'Lookup table',
};
const LABELS = new Map([
  ...Object.entries(CHOICE_LABELS),
  ...GROUPS.flatMap((group) => group.fields).map(
    (field) => /** @type {[string, string]} */ ([field.path, field.label]),
  ),
]);
const ROW = /^table\.rows\.(\d+)(?:\.([01]))?$/;

/**
 * Sort messages by the place that shows them. Errors come before warnings: the first at a place is kept.
 * @param {{field: string | null, message: string}[]} errors
 * @param {{field: string | null, message: string}[]} warnings
 * @returns {Messages}
 */
export function sortMessages(errors, warnings) {
  /** @type {Messages} */
  const sorted = { fields: new Map(), rows: new Map(), others: [] };
  for (const { field, message } of errors) place(sorted, field, message, false);
  for (const { field, message } of warnings) place(sorted, field, message, true);
  return sorted;
}

/** @param {Messages} sorted @param {string | null} field @param {string} message @param {boolean} isWarning */
function place(sorted, field, message, isWarning) {
  const whole = (field ?? '').replace(/^design\./, '');
  const row = ROW.exec(whole);
  // The table has one place for all that is not about one row.
  const path = /^table\b/.test(whole) ? 'table' : whole;
  if (row) {
    const [index, column] = [Number(row[1]), row[2] === undefined ? null : Number(row[2])];
    const label = `Row ${index + 1}${column === null ? '' : column === 0 ? ', last step,' : ', delay,'}`;
    if (!sorted.rows.has(index)) sorted.rows.set(index, { column, text: named(message, field, label), isWarning });
  } else if (LABELS.has(path)) {
    const text = named(message, field, /** @type {string} */ (LABELS.get(path)));
    if (!sorted.fields.has(path)) sorted.fields.set(path, { text, isWarning });
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
