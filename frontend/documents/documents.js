// @ts-check
// Designs as text: what is saved in files and carried by links. A text is read whole or not at all, and then it is said
// why. Values are for the server to judge: what stands in a number field may be any number, or text that was typed there.

import { LONGEST_NAME, MOST_ROWS } from '../model/design.js';
import { METHODS } from '../model/methods.js';
import { MECHANISMS } from '../model/mechanisms.js';
import { MOST_POINTS, SHAPES } from '../model/shapes.js';
import { MOST_AXES } from '../model/workbench.js';
import { repeatedField } from './repeated.js';

/** @typedef {import('../model/types.js').Design} Design */
/** @typedef {import('../model/workbench.js').Work} Work */
/** @typedef {{document: Work, problem: null} | {document: null, problem: string}} ReadDocument */
/** What may stand in a field: null when the value will do, else what is allowed. `otherwise` stands in for a field that
 * is left out; a field without it has to be there, unless it may stay out.
 * @typedef {{refusal: (value: unknown) => string | null, otherwise?: unknown, mayStayOut?: boolean}} Rule */

/** No text longer than this is read: the longest sensible one, four axes of 1,000 rows, has a quarter of it [characters]. */
export const LONGEST_TEXT = 1_000_000;
/** The versions of a design, the newest last: the first has neither shapes nor plans. */
const DESIGNS = ['stepramp/1', 'stepramp/2'];
const MACHINE = 'stepramp-machine/1';
const TOGETHER = ['independent', 'line'];
const SHORT = 60;
/** What was typed in a number field, and is none [characters]. */
const LONGEST_ENTRY = 100;

class Unreadable extends Error {}

/** @type {Rule} */
const name = {
  refusal: (value) => (isText(value, LONGEST_NAME) ? null : `a text of up to ${LONGEST_NAME} characters`),
  otherwise: '',
};

/** A number field.
 * @param {number} [otherwise] @returns {Rule} */
function entry(otherwise) {
  const rule = {
    refusal: (/** @type {unknown} */ value) =>
      isText(value, LONGEST_ENTRY) || Number.isFinite(value) ? null : 'a number',
  };
  return otherwise === undefined ? rule : { ...rule, otherwise };
}

/** A number field that may be left open.
 * @type {Rule} */
const openEntry = {
  refusal: (value) => (value === null || entry().refusal(value) === null ? null : 'a number or null'),
  otherwise: null,
};

/** One of some words, of which the first is the usual one.
 * @param {string[]} words @returns {Rule} */
function oneOf(...words) {
  return {
    refusal: (value) => (words.some((word) => word === value) ? null : words.join(', ')),
    otherwise: words[0],
  };
}

/** @param {unknown} value @returns {string | null} */
function shapeRefusal(value) {
  const { name, ...own } = /** @type {Record<string, unknown>} */ (isObject(value) ? value : {});
  const shape = SHAPES.find((one) => one.name === name);
  if (shape === undefined) return `an object whose name is ${SHAPES.map((one) => one.name).join(', ')}`;
  const isKnown = Object.entries(own).every(([field, value]) => {
    const holds = field === 'points' ? arePoints(value) : openEntry.refusal(value) === null;
    return shape.fields.includes(field) && holds;
  });
  return isKnown ? null : `with the name ${shape.name}: ${shape.fields.map((field) => CONTENTS[field] ?? `${field}, a number`).join('; ') || 'nothing besides'}`;
}

/** What else than a number a field of a shape holds.
 * @type {Record<string, string>} */
const CONTENTS = { points: `points, a list of up to ${MOST_POINTS} pairs of numbers` };

/** @param {unknown} value */
function arePoints(value) {
  const isPair = (/** @type {unknown} */ point) =>
    Array.isArray(point) && point.length === 2 && point.every((one) => entry().refusal(one) === null);
  return Array.isArray(value) && value.length <= MOST_POINTS && value.every(isPair);
}

/** The parts of a design and what stands in for what is left out: the same as where the server reads one.
 * @type {Record<string, Record<string, Rule>>} */
const PARTS = {
  axis: {
    full_steps_per_rev: entry(200),
    microsteps: entry(1),
    travel_per_rev: entry(360),
    travel_unit: oneOf('deg', 'mm'),
  },
  timer: { frequency_hz: entry(), counter_bits: entry(16), shortest_interval_us: entry(20) },
  ramp: {
    base_speed_steps_per_s: entry(0),
    slew_speed_steps_per_s: entry(),
    acceleration_steps_per_s2: entry(),
    deceleration_steps_per_s2: openEntry,
    shape: { refusal: shapeRefusal, mayStayOut: true },
  },
  method: {
    name: oneOf(...METHODS.map((method) => method.name)),
    arithmetic: oneOf('float64', 'float32', 'fixed'),
    rounding: oneOf('nearest', 'floor', 'carry'),
    tuned_for: oneOf('largest_error', 'time'),
  },
  move: { steps: entry(), plan: { refusal: oneOf('this_move', 'any_move').refusal, mayStayOut: true } },
};
const MAY_BE_LEFT_OUT = ['axis', 'method'];

/** @param {Rule} rule @returns {Rule} */
const mayStayOut = (rule) => ({ refusal: rule.refusal, mayStayOut: true });
const openNumber = mayStayOut(openEntry);

/** What drives a motor.
 * @type {Record<string, Rule>} */
const DRIVE = {
  supply_v: openNumber,
  current_a: openNumber,
  current_is: { refusal: (value) => (value === null ? null : oneOf('rms', 'peak').refusal(value)), mayStayOut: true },
};

/** What a design may do without; each of them is as it was given.
 * @type {Record<string, Record<string, Rule>>} */
const OPTIONAL_PARTS = {
  motor: {
    ...Object.fromEntries(
      ['resistance_ohm', 'inductance_mh', 'holding_torque_nm', 'rated_current_a', 'rotor_inertia_g_cm2'].map((name) => [name, entry()]),
    ),
    full_steps_per_rev: openNumber,
    detent_torque_nm: openNumber,
    pull_out_factor: openNumber,
    kind: mayStayOut(oneOf('hybrid', 'gauge')),
    stalled: { refusal: (value) => (value === null || isStallPoint(value) ? null : 'null, or rpm and torque_nm, two numbers'), mayStayOut: true },
    measured_with: { refusal: (value) => (value === null || isDrive(value) ? null : `null, or ${Object.keys(DRIVE).join(', ')}`), mayStayOut: true },
    torque_curve: { refusal: (value) => (value === null || arePoints(value) ? null : `null, or ${CONTENTS.points}`), mayStayOut: true },
  },
  drive: DRIVE,
  load: {
    inertia_g_cm2: openNumber,
    torque_nm: openNumber,
    friction_nm: openNumber,
    mechanism: { refusal: (value) => (value === null ? null : mechanismRefusal(value)), mayStayOut: true },
  },
};

/** @param {unknown} value @returns {string | null} */
function mechanismRefusal(value) {
  const { name, ...own } = /** @type {Record<string, unknown>} */ (isObject(value) ? value : {});
  const mechanism = MECHANISMS.find((one) => one.name === name);
  if (mechanism === undefined) return `null, or an object whose name is ${MECHANISMS.map((one) => one.name).join(', ')}`;
  const isKnown = Object.entries(own).every(([field, one]) => mechanism.fields.includes(field) && openEntry.refusal(one) === null);
  return isKnown ? null : `with the name ${mechanism.name}: ${mechanism.fields.map((field) => `${field}, a number`).join('; ')}`;
}

/** @param {unknown} value */
function isDrive(value) {
  return isObject(value) && Object.entries(value).every(([name, one]) => DRIVE[name]?.refusal(one) === null);
}

/** @param {unknown} value */
function isStallPoint(value) {
  return isObject(value) && Object.keys(value).length === 2 && ['rpm', 'torque_nm'].every((name) => entry().refusal(value[name]) === null);
}

/**
 * Read a design, or a machine of up to four of them.
 * @param {string} source
 * @returns {ReadDocument}
 */
export function readDocument(source) {
  try {
    return { document: readWork(parse(source)), problem: null };
  } catch (error) {
    if (!(error instanceof Unreadable)) throw error;
    return { document: null, problem: error.message };
  }
}

/** Write what `readDocument` reads: a design when there is one axis, else the machine.
 * @param {Work} work @param {number} [indent] spaces a level; 0: all in one line @returns {string} */
export function writeDocument({ axes, together }, indent = 2) {
  return JSON.stringify(axes.length === 1 ? axes[0] : { schema: MACHINE, together, axes }, null, indent);
}

/** @param {string} source @returns {unknown} */
function parse(source) {
  if (source.length > LONGEST_TEXT) {
    throw new Unreadable(`This is not a StepRamp design: it is longer than ${inWords(LONGEST_TEXT)} characters.`);
  }
  const text = source.replace(/^\ufeff/, '');
  /** @type {unknown} */
  let document;
  try {
    document = JSON.parse(text);
  } catch {
    throw new Unreadable('This is not a StepRamp design: it is not JSON, or not all of it.');
  }
  const field = repeatedField(text);
  if (field !== null) throw new Unreadable(`The design can\u2019t be read: ${shorten(field)} is given more than once; allowed: once.`);
  return document;
}

/** @param {unknown} document @returns {Work} */
function readWork(document) {
  const { schema } = /** @type {Record<string, unknown>} */ (isObject(document) ? document : {});
  if (schema !== MACHINE) return { axes: [readDesign(document, '')], together: 'independent' };
  const { axes, together, ...others } = /** @type {Record<string, unknown>} */ (document);
  refuseUnknown(Object.keys(others), ['schema'], '');
  check({ refusal: oneOf(...TOGETHER).refusal }, together, 'together');
  const isCounted = Array.isArray(axes) && axes.length >= 1 && axes.length <= MOST_AXES;
  if (!isCounted) throw refused('axes', axes, `from 1 to ${MOST_AXES} designs`);
  const designs = axes.map((axis, index) => readDesign(axis, `axes.${index}.`));
  return { axes: designs, together: /** @type {Work['together']} */ (together) };
}

/** @param {unknown} document @param {string} place such as "axes.0.", '' for a design by itself @returns {Design} */
function readDesign(document, place) {
  if (!isObject(document))
    throw new Unreadable(`This is not a StepRamp design${place === '' ? '' : ` at ${place.slice(0, -1)}`}.`);
  refuseSchema(document.schema, place);
  refuseUnknown(Object.keys(document), ['schema', 'name', 'table', ...Object.keys(PARTS), ...Object.keys(OPTIONAL_PARTS)], place);
  const parts = Object.entries(PARTS).map(([name, rules]) => {
    const given = document[name] ?? (MAY_BE_LEFT_OUT.includes(name) ? {} : undefined);
    return [name, readPart(given, rules, place + name)];
  });
  return /** @type {Design} */ ({
    schema: document.schema,
    name: check(name, document.name, `${place}name`),
    ...Object.fromEntries(parts),
    table: readTable(document.table ?? null, `${place}table`),
    ...Object.fromEntries(
      Object.entries(OPTIONAL_PARTS).flatMap(([name, rules]) =>
        (document[name] ?? null) === null ? [] : [[name, readPart(document[name], rules, place + name)]],
      ),
    ),
  });
}

/** @param {unknown} schema @param {string} place */
function refuseSchema(schema, place) {
  if (DESIGNS.some((known) => known === schema)) return;
  const version = typeof schema === 'string' && /^stepramp(-[\w-]+)?\/\d/.test(schema);
  if (version) {
    throw new Unreadable(
      `This was made by another, probably newer StepRamp: its format is ${shown(schema)}, this one reads ${DESIGNS.join(', ')} and ` +
        `${MACHINE}. Open it with a newer StepRamp.`,
    );
  }
  if (schema === undefined) throw new Unreadable(`This is not a StepRamp design: its field ${place}schema is missing.`);
  throw new Unreadable(`This is not a StepRamp design: ${place}schema is ${shown(schema)}; allowed: ${DESIGNS.map((known) => `"${known}"`).join(', ')}.`);
}

/** @param {unknown} part @param {Record<string, Rule>} rules @param {string} path */
function readPart(part, rules, path) {
  if (!isObject(part)) throw refused(path, part, 'an object with named fields');
  refuseUnknown(Object.keys(part), Object.keys(rules), `${path}.`);
  const present = Object.entries(rules).filter(([name, rule]) => !rule.mayStayOut || part[name] !== undefined);
  return Object.fromEntries(present.map(([name, rule]) => [name, check(rule, part[name], `${path}.${name}`)]));
}

/** @param {unknown} table @param {string} path @returns {Design['table']} */
function readTable(table, path) {
  if (table === null) return null;
  if (!isObject(table)) throw refused(path, table, 'an object with named fields, or null');
  refuseUnknown(Object.keys(table), ['rows', 'interval_unit'], `${path}.`);
  const { rows } = table;
  if (!Array.isArray(rows)) throw refused(`${path}.rows`, rows, 'a list of rows of two numbers');
  if (rows.length > MOST_ROWS)
    throw refused(`${path}.rows`, `${inWords(rows.length)} rows`, `at most ${inWords(MOST_ROWS)} rows`);
  rows.forEach((row, index) => {
    if (!Array.isArray(row) || row.length !== 2) throw refused(`${path}.rows.${index}`, row, 'a row of two numbers');
    row.forEach((value, column) => check(entry(), value, `${path}.rows.${index}.${column}`));
  });
  return { rows, interval_unit: check(oneOf('us', 'ticks'), table.interval_unit, `${path}.interval_unit`) };
}

/** The value itself, or what stands in for it.
 * @param {Rule} rule @param {unknown} value @param {string} path @returns {any} */
function check(rule, value, path) {
  if (value === undefined && rule.otherwise !== undefined) return rule.otherwise;
  const refusal = rule.refusal(value);
  if (refusal !== null) throw refused(path, value, refusal);
  return value;
}

/** @param {string[]} names @param {string[]} known @param {string} place */
function refuseUnknown(names, known, place) {
  const unknown = names.find((name) => !known.includes(name));
  if (unknown !== undefined) throw new Unreadable(`There is no field ${shorten(place + unknown)} in a design.`);
}

/** @param {string} path @param {unknown} value @param {string} allowed */
function refused(path, value, allowed) {
  const given = value === undefined ? 'is missing' : `is ${shown(value)}`;
  return new Unreadable(`The design can’t be read: ${path} ${given}; allowed: ${allowed}.`);
}

/** @param {unknown} value */
function shown(value) {
  // JSON has no word for a number that is too large for it, such as 1e999.
  return typeof value === 'number' ? String(value) : shorten(JSON.stringify(value));
}

/** @param {string} long */
function shorten(long) {
  return long.length > SHORT ? `${long.slice(0, SHORT)}…` : long;
}

/** @param {unknown} value @returns {value is Record<string, unknown>} */
function isObject(value) {
  return typeof value === 'object' && value !== null && !Array.isArray(value);
}

/** @param {unknown} value @param {number} longest characters */
function isText(value, longest) {
  // As the server counts them, of which some take two places here.
  return typeof value === 'string' && [...value.slice(0, 2 * longest + 1)].length <= longest;
}

/** @param {number} count */
function inWords(count) {
  return count.toLocaleString('en-US');
}
