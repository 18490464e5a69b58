// @ts-check
// Motors that many people have, as the server lists them, and what a design gets with one. Optional all of it: a design without
// a motor is what it was.

// @ts-expect-error  No file, but what GET /api/v1/motor/presets answers, as a module.
import served from '../assets/motors.js';
import { valueAt } from './design.js';
import { areEqual } from './equal.js';
import { withShape, shapeOf } from './shapes.js';

/** @typedef {import('./types.js').Design} Design */
/** A motor, with what its maker fixes of its drive, its load and its turn; null: nothing.
 * sources: where each of these fields comes from, by its path.
 * @typedef {Required<Pick<Design, 'motor'>> & {name: string, help: string, drive: Design['drive'] | null, load: Design['load'] | null,
 *   axis: Partial<Design['axis']> | null, sources: Record<string, 'datasheet' | 'assumed'>}} MotorPreset */

const SHAPED = 'stepramp/2';
/** Full steps of a turn of a motor whose preset tells none: 1.8° each. */
const USUAL_STEPS = 200;
const OF_MAKER = /** @type {const} */ (['drive', 'load']);

/** @type {MotorPreset[]} */
export const MOTORS = served.presets;

/** The preset whose motor a design has; undefined: another, or none.
 * @param {Design} design */
export const motorPresetOf = (design) =>
  design.motor && MOTORS.find((one) => alikeOf(one, design).length === Object.keys(one.motor).length);

/** The fields of a motor that are as a preset has them.
 * @param {MotorPreset} preset @param {Design} design */
const alikeOf = (preset, design) =>
  Object.keys(preset.motor).filter((name) => areEqual(inPreset(preset, `motor.${name}`), valueAt(design, `motor.${name}`)));

/** @param {MotorPreset} preset @param {string} path */
const inPreset = (preset, path) => valueAt(/** @type {Design} */ (/** @type {unknown} */ (preset)), path);

/** The design with a motor, and with what its maker fixes besides; all else that drives it and that it moves stays, but for what
 * the maker of the motor before fixed.
 * @param {Design} design @param {MotorPreset} preset @returns {Design} */
export function withMotor(design, preset) {
  const before = motorPresetOf(design);
  const others = OF_MAKER.filter((part) => before?.[part] && areEqual(before[part], design[part]));
  const kept = Object.fromEntries(Object.entries(design).filter(([part]) => !others.some((one) => one === part)));
  const fixed = Object.fromEntries(OF_MAKER.flatMap((part) => (preset[part] ? [[part, preset[part]]] : [])));
  const turn = preset.axis ?? (before?.axis ? { full_steps_per_rev: preset.motor.full_steps_per_rev ?? USUAL_STEPS } : {});
  return /** @type {Design} */ ({ ...kept, ...fixed, schema: SHAPED, axis: { ...design.axis, ...turn }, motor: preset.motor });
}

/** The design with nothing known of its motor; a ramp that was shaped by it has the usual shape.
 * @param {Design} design @param {string} usual the shape that needs nothing @returns {Design} */
export function withoutMotor(design, usual) {
  const shaped = shapeOf(design).fields.includes('margin') ? withShape(design, usual) : design;
  const { motor: _, drive: __, load: ___, ...bare } = shaped;
  return bare;
}
