// @ts-check
// The units that lengths, speeds and accelerations are shown in. Designs are in steps and seconds whatever is shown.

/** @typedef {import('./types.js').Design} Design */
/** @typedef {'steps' | 'rev' | 'deg' | 'mm'} LengthUnit */
/** @typedef {{length: LengthUnit, time: 's' | 'min'}} Units */
/** @typedef {'length' | 'speed' | 'acceleration' | 'jerk'} Quantity */

const DEGREES_PER_REV = 360;
const SECONDS_PER_MIN = 60;

/** @type {Units} */
export const STEPS_AND_SECONDS = { length: 'steps', time: 's' };

/** Units as a text that can be kept, as "mm min".
 * @param {Units} units */
export const unitsText = ({ length, time }) => `${length} ${time}`;

/** The units that such a text names; the usual ones where it names none.
 * @param {string} text @returns {Units} */
export function unitsNamed(text) {
  const [length, time] = text.split(' ');
  const isKnown = LENGTHS.some(([unit]) => unit === length) && (time === 's' || time === 'min');
  return isKnown ? /** @type {Units} */ ({ length, time }) : STEPS_AND_SECONDS;
}

/** @type {[LengthUnit, string][]} */
const LENGTHS = [
  ['steps', 'steps'],
  ['rev', 'rev'],
  ['deg', '°'],
  ['mm', 'mm'],
];

/** The time's power in each quantity. */
const TIME_POWER = { length: 0, speed: 1, acceleration: 2, jerk: 3 };
const POWERS = ['', '', '²', '³'];

/** The units of length that an axis can be shown in: millimetres only where its travel is known in them.
 * @param {Design} design @returns {[LengthUnit, string][]} */
export function unitChoices(design) {
  return LENGTHS.filter(([unit]) => unit !== 'mm' || design.axis.travel_unit === 'mm');
}

/** How many units of length one step is; NaN while the axis has no such numbers.
 * @param {LengthUnit} unit @param {Design} design */
function lengthOfStep(unit, design) {
  if (unit === 'steps') return 1;
  const { full_steps_per_rev, microsteps, travel_per_rev, travel_unit } = design.axis;
  const stepsPerRev = Number(full_steps_per_rev) * Number(microsteps);
  const isTravel = unit === travel_unit;
  const perRev = isTravel ? Number(travel_per_rev) : unit === 'deg' ? DEGREES_PER_REV : 1;
  return stepsPerRev > 0 && perRev > 0 ? perRev / stepsPerRev : NaN;
}

/** The units that hold for a design: steps where it has no such length.
 * @param {Units} units @param {Design} design @returns {Units} */
export function unitsFor(units, design) {
  const isKnown =
    unitChoices(design).some(([unit]) => unit === units.length) && lengthOfStep(units.length, design) > 0;
  return isKnown ? units : { ...units, length: 'steps' };
}

/** @param {Units} units @param {Design} design @param {Quantity} quantity */
function factorOf(units, design, quantity) {
  const known = unitsFor(units, design);
  const seconds = known.time === 'min' ? SECONDS_PER_MIN : 1;
  return lengthOfStep(known.length, design) * seconds ** TIME_POWER[quantity];
}

/** @param {Units} units @param {Design} design @param {Quantity} quantity @param {number} stored in steps and seconds */
export function shownValue(units, design, quantity, stored) {
  return stored * factorOf(units, design, quantity);
}

/** @param {Units} units @param {Design} design @param {Quantity} quantity @param {number} shown */
export function storedValue(units, design, quantity, shown) {
  return shown / factorOf(units, design, quantity);
}

/** @param {Units} units @param {Design} design @param {Quantity} quantity such as "mm/s²" */
export function unitWord(units, design, quantity) {
  const known = unitsFor(units, design);
  const length = LENGTHS.find(([unit]) => unit === known.length)?.[1] ?? '';
  const power = TIME_POWER[quantity];
  return power === 0 ? length : `${length}/${known.time}${POWERS[power]}`;
}

/** The steps of each mm of an axis' travel, or of each degree.
 * @param {Design['axis']} axis */
export const stepsPerUnit = ({ full_steps_per_rev, microsteps, travel_per_rev }) =>
  (Number(full_steps_per_rev) * Number(microsteps)) / Number(travel_per_rev);

/** So far apart two scales are the same, written with as many figures as controllers tell. */
const SAME_SCALE = 1e-5;

/** What a machine tells of its own steps; null: it doesn't tell.
 * @typedef {{stepsPerMm: number | null, microsteps: number | null}} Scale */

/** What an axis of a device tells of its own steps.
 * @param {import('./types.js').AxisState | undefined} axis @returns {Scale} */
export const scaleOf = (axis) => ({ stepsPerMm: axis?.steps_per_mm ?? null, microsteps: axis?.microsteps ?? null });

/** A design as a machine of such a scale moves it, to convert by: what a motor is sent are steps. A travel in degrees is none in mm.
 * @param {Design} design @param {Scale} scale of the machine @returns {Design} the same one where its scale is the machine's */
export function atScale(design, { stepsPerMm, microsteps }) {
  const { axis } = design;
  if (microsteps !== null && hasOtherMicrosteps(design, microsteps)) return { ...design, axis: { ...axis, microsteps } };
  if (stepsPerMm === null || axis.travel_unit !== 'mm' || !isOtherScale(design, stepsPerMm)) return design;
  return { ...design, axis: { ...axis, travel_per_rev: travelAt(design, stepsPerMm) } };
}

/** Whether a machine makes another number of steps of a full step than a design.
 * @param {Design} design @param {number} microsteps */
export const hasOtherMicrosteps = ({ axis }, microsteps) =>
  Number(axis.microsteps) > 0 && Number(axis.microsteps) !== microsteps;

/** Whether a scale is another one than a design's.
 * @param {Design} design @param {number} stepsPerMm */
export const isOtherScale = ({ axis }, stepsPerMm) => Math.abs(stepsPerUnit(axis) / stepsPerMm - 1) > SAME_SCALE;

/** How far a turn leads at a scale [mm].
 * @param {Design} design @param {number} stepsPerMm */
export const travelAt = ({ axis }, stepsPerMm) => (Number(axis.full_steps_per_rev) * Number(axis.microsteps)) / stepsPerMm;
