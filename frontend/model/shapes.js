// @ts-check
// The shapes of ramps, in the order in which they are offered. The server makes the list.

// @ts-expect-error  No file, but what GET /api/v1/shapes answers, as a module.
import served from '../assets/shapes.js';
import { hasMotorField } from './motor_fields.js';

/** @typedef {import('./types.js').Design} Design */
/** @typedef {import('./types.js').Entry} Entry */
/** @typedef {import('./types.js').MethodName} MethodName */

/** A shape, as the server tells of it.
 * fields: those of `ramp.shape` besides its name; methods: those that compute such a ramp; begins_alike: whether a ramp to
 * a lower speed is the beginning of the one to a higher speed.
 * @typedef {{name: string, label: string, help: string, fields: string[], methods: MethodName[],
 *   begins_alike: boolean}} Shape */

/** @type {Shape[]} */
export const SHAPES = served.shapes;

/** What is served may be a document of another StepRamp: the usual shape stands for one that isn't known.
 * @param {Design} design @returns {Shape} */
export const shapeOf = ({ ramp }) =>
  SHAPES.find(({ name }) => name === (ramp.shape?.name ?? served.usual)) ?? SHAPES[0];

/** Of a drawn acceleration. */
export const MOST_POINTS = 200;
/** The version of documents that may have a shape and a plan. */
const SHAPED = 'stepramp/2';
const FIGURES = 3;
const SHAPE = 'ramp.shape.';
/** Parts that only a design with a motor has. */
const OF_MOTOR = ['motor', 'drive', 'load'];
/** Of the motor's torque, for a ramp that is shaped by it. */
const USUAL_MARGIN = 0.6;

/** The design with another shape, whose own numbers are such as make sense for its ramp; with its own it stays as it is.
 * @param {Design} design @param {string} name @returns {Design} */
export function withShape(design, name) {
  if (name === shapeOf(design).name) return design;
  const { shape: _, ...ramp } = design.ramp;
  if (name === served.usual) return { ...design, ramp };
  const fields = SHAPES.find((one) => one.name === name)?.fields ?? [];
  const own = Object.fromEntries(fields.flatMap((field) => (field in FIRST ? [[field, FIRST[field](design)]] : [])));
  return { ...design, schema: SHAPED, ramp: { ...ramp, shape: { name, ...own } } };
}

/** The shapes that a design may have: what is shaped by a motor needs one.
 * @param {Design} design */
export const shapesFor = (design) =>
  SHAPES.filter(({ fields, name }) => !fields.includes('margin') || design.motor !== undefined || name === shapeOf(design).name);

/** What a design has that names no shape. @type {string} */
export const USUAL_SHAPE = served.usual;

/** The design with a plan for moves that are too short for its slew speed.
 * @param {Design} design @param {string} plan @returns {Design} */
export const withPlan = (design, plan) => ({ ...design, schema: SHAPED, move: { ...design.move, plan } });

/** Whether a design has a field: those of other shapes than its own it has not.
 * @param {Design} design @param {string} path */
export function hasField(design, path) {
  if (path.startsWith(SHAPE)) return shapeOf(design).fields.includes(path.slice(SHAPE.length));
  return !OF_MOTOR.includes(path.slice(0, path.indexOf('.'))) || hasMotorField(design, path);
}

/** Whether it is a shape of a ramp that is known, with no more points than can be shown.
 * @param {any} shape */
export function isShape(shape) {
  const points = shape?.points ?? [];
  const arePairs = Array.isArray(points) && points.every((point) => Array.isArray(point) && point.length === 2);
  return SHAPES.some(({ name }) => name === shape?.name) && arePairs && points.length <= MOST_POINTS;
}

/** What the fields of a shape begin with.
 * @type {Record<string, (design: Design) => unknown>} */
const FIRST = {
  jerk_steps_per_s3: ({ ramp }) => jerkOfOnset(ramp),
  margin: () => USUAL_MARGIN,
  points: ({ ramp }) => {
    const slew = numberOr(ramp.slew_speed_steps_per_s, 1000);
    return [[0, 1], [tidied(slew / 2), 1], [slew, 0.5]]; // prettier-ignore
  },
};

/** The jerk with which the acceleration takes a fifth of the ramp to come: of T = Δ/a + a/j the onset is a/j.
 * @param {Design['ramp']} ramp */
function jerkOfOnset({ base_speed_steps_per_s, slew_speed_steps_per_s, acceleration_steps_per_s2 }) {
  const gain = numberOr(slew_speed_steps_per_s, 1000) - numberOr(base_speed_steps_per_s, 0);
  const acceleration = numberOr(acceleration_steps_per_s2, 1000);
  return gain > 0 ? tidied((4 * acceleration ** 2) / gain) : acceleration;
}

/** @param {Entry} entry @param {number} otherwise */
const numberOr = (entry, otherwise) => (typeof entry === 'number' && entry > 0 ? entry : otherwise);

/** @param {number} value */
const tidied = (value) => Number(value.toPrecision(FIGURES));
