// @ts-check
// A stall map: whether the motor makes the move with other accelerations and another speed, load or voltage; where a design
// lies on it, and what a place on it makes of the design.

import { valueAt, withValue } from './design.js';
import { withDriveThen } from './measured.js';
import { SUPPLY_V } from './motor_fields.js';

/** @typedef {import('./types.js').Design} Design */
/** @typedef {import('./types.js').Over} Over */
/** @typedef {import('./types.js').MapResult} MapResult */
/** A place on a map: an acceleration [steps/s²], and what it goes over.
 * @typedef {{acceleration: number, value: number}} MapPlace */

/** What a map goes over beside the acceleration: where it stands in a design, and what holds where that is left open.
 * @type {{name: Over, label: string, path: string, unit: string, usual: number, quantity?: 'speed'}[]} */
export const OVERS = [
  { name: 'slew_speed', label: 'Slew speed', path: 'ramp.slew_speed_steps_per_s', unit: 'steps/s', usual: NaN, quantity: 'speed' },
  { name: 'load', label: 'Load torque', path: 'load.torque_nm', unit: 'Nm', usual: 0 },
  { name: 'supply_voltage', label: 'Supply', path: 'drive.supply_v', unit: 'V', usual: SUPPLY_V },
];
/** By the server's numbers. */
export const MAP_VERDICTS = ['Safe', 'Marginal', 'Stalls', 'Not possible'];
export const UNKNOWN = -1;
const ACCELERATION = 'ramp.acceleration_steps_per_s2';
const DECELERATION = 'ramp.deceleration_steps_per_s2';
const FIGURES = 4;

/** @param {Over} name */
export const overOf = (name) => /** @type {typeof OVERS[number]} */ (OVERS.find((one) => one.name === name));

/** Where a design lies; not numbers where it holds none.
 * @param {Design} design @param {Over} over @returns {MapPlace} */
export function placeOf(design, over) {
  const { path, usual } = overOf(over);
  return { acceleration: Number(valueAt(design, ACCELERATION)), value: Number(valueAt(design, path) ?? usual) };
}

/** All of a design that a map is of: what it varies it isn't of, but in which proportion the ramp down is.
 * @param {Design} design @param {Over} over */
export function mapKey(design, over) {
  const { acceleration } = placeOf(design, over);
  const down = valueAt(design, DECELERATION);
  const part = down === null || down === undefined ? null : Number((Number(down) / acceleration).toPrecision(FIGURES));
  const told = { ...ofSupply(design, over), name: '' };
  const bare = [ACCELERATION, DECELERATION, overOf(over).path].reduce((made, path) => withValue(made, path, undefined), told);
  // A drive of which all is left open is none.
  const parts = Object.entries(bare).filter(([name, value]) => !(['drive', 'load'].includes(name) && Object.keys(Object(value)).length === 0));
  return JSON.stringify([part, Object.fromEntries(parts.sort(([one], [other]) => (one < other ? -1 : 1)))]);
}

/** What a place makes of a design: the ramp down stays in its proportion.
 * @param {Design} design @param {Over} over @param {MapPlace} place @returns {import('./types.js').Remedy['changes']} */
export function changesTo(design, over, { acceleration, value }) {
  const before = Number(valueAt(design, ACCELERATION));
  const down = valueAt(design, DECELERATION);
  const slower = down === null || down === undefined ? [] : [{ field: DECELERATION, value: rounded((Number(down) / before) * acceleration) }];
  const { motor } = ofSupply(design, over);
  const then = motor === design.motor ? [] : [{ field: 'motor', value: motor }];
  return [{ field: ACCELERATION, value: rounded(acceleration) }, ...slower, ...then, { field: overOf(over).path, value: rounded(value) }];
}

/** The picture to show of a design: its own, or else the newest, which is of another one.
 * @param {import('./types.js').StallMap | undefined} map @param {string} key of the design
 * @returns {{result: MapResult | null, isOld: boolean}} */
export function pictureOf(map, key) {
  const own = map?.pictures.find((one) => one.key === key);
  const shown = own ?? map?.pictures[0];
  return { result: shown?.result ?? null, isOld: own === undefined && shown !== undefined };
}

/** What was measured with one supply isn't measured with another.
 * @param {Design} design @param {Over} over */
const ofSupply = (design, over) => (over === 'supply_voltage' ? withDriveThen(design) : design);

/** Increasing values that a map goes along.
 * @typedef {{values: number[], spacing: MapResult['over_spacing']}} MapAxis */

/** @param {Pick<MapResult, 'over_values' | 'over_spacing' | 'accelerations_steps_per_s2'>} map @returns {{over: MapAxis, acceleration: MapAxis}} */
export const axesOf = ({ over_values, over_spacing, accelerations_steps_per_s2 }) => ({
  over: { values: over_values, spacing: over_spacing },
  acceleration: { values: accelerations_steps_per_s2, spacing: 'ratios' },
});

/** How far along its values something lies: 0 at the first, 1 at the last, beyond them less or more.
 * @param {MapAxis} axis @param {number} value */
export function shareOf({ values, spacing }, value) {
  const [first, last] = ends(values);
  return spacing === 'ratios' ? Math.log(value / first) / Math.log(last / first) : (value - first) / (last - first);
}

/** What lies so far along.
 * @param {MapAxis} axis @param {number} share */
export function valueAtShare({ values, spacing }, share) {
  const [first, last] = ends(values);
  return spacing === 'ratios' ? first * (last / first) ** share : first + share * (last - first);
}

/** The verdict of the nearest point that was asked about; null: the place lies beyond all.
 * @param {MapResult} map @param {MapPlace} place */
export function verdictAt(map, { acceleration, value }) {
  const axes = axesOf(map);
  const [row, column] = [nearest(axes.acceleration, acceleration), nearest(axes.over, value)];
  return row === null || column === null ? null : map.verdicts[row][column];
}

/** Stretches of equal verdicts: of row `row` the columns from `from` up to, and without, `to`.
 * @param {number[][]} verdicts @returns {{verdict: number, row: number, from: number, to: number}[]} */
export function stretchesOf(verdicts) {
  return verdicts.flatMap((line, row) => {
    const starts = line.flatMap((verdict, column) => (column === 0 || verdict !== line[column - 1] ? [column] : []));
    return starts.map((from, index) => ({ verdict: line[from], row, from, to: starts[index + 1] ?? line.length }));
  });
}

/** How much of a map has each verdict, of what is known.
 * @param {number[][]} verdicts @returns {number[]} parts of 1, in the order of MAP_VERDICTS */
export function partsOf(verdicts) {
  const known = verdicts.flat().filter((verdict) => verdict !== UNKNOWN);
  return MAP_VERDICTS.map((_, verdict) => known.filter((one) => one === verdict).length / Math.max(1, known.length));
}

/** How much of a map is known, in words: a part of all of it, and what that part has.
 * @param {number[][]} verdicts @param {boolean} isOld whether it is of an earlier design */
export function mapText(verdicts, isOld) {
  const all = verdicts.flat();
  const known = all.filter((verdict) => verdict !== UNKNOWN).length;
  if (known === 0) return '';
  const percent = (/** @type {number} */ part) => (part < 0.01 ? 'under 1 %' : `${Math.round(part * 100)} %`);
  const parts = partsOf(verdicts).flatMap((part, verdict) => (part === 0 ? [] : [`${MAP_VERDICTS[verdict].toLowerCase()} ${percent(part)}`]));
  const map = `the ${isOld ? 'earlier ' : ''}map`;
  return `Of ${known === all.length ? map : `what is known of ${map}, ${percent(Math.min(known / all.length, 0.99))} of it`}: ${parts.join(', ')}.`;
}

/** @param {MapAxis} axis @param {number} value @returns {number | null} */
function nearest(axis, value) {
  const place = shareOf(axis, value) * (axis.values.length - 1);
  const index = Math.round(place);
  return place >= -0.5 && index < axis.values.length && !Number.isNaN(place) ? Math.max(0, index) : null;
}

/** @param {number[]} values @returns {[number, number]} */
const ends = (values) => [values[0], values[values.length - 1]];

/** As a hand sets it.
 * @param {number} value */
const rounded = (value) => Number(value.toPrecision(FIGURES));
