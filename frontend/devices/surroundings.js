// @ts-check
// The world around the virtual controller: what is to change in it so that an input is active, or isn't.

/** @typedef {import('../model/types.js').DeviceInput} DeviceInput */

/** Where an axis is, counted from where it was at first, and from which places on its switches are active; null: none.
 * @typedef {{axis: number, place_steps: number, low_steps: number | null, high_steps: number | null}} AxisSurroundings */
/** @typedef {{emergency_stop: boolean, driver_fault: boolean, axes: AxisSurroundings[]}} Surroundings */
/** @typedef {{emergency_stop?: boolean, driver_fault?: boolean, axes?: Omit<AxisSurroundings, 'place_steps'>[]}} SurroundingsChange */

/** So far beyond an axis is a switch that was let go [steps]. */
const LET_GO_STEPS = 1000;

/** What changes so that an input is pressed, or let go. A switch that is pressed is where its axis is.
 * @param {DeviceInput} input @param {boolean} isPressed @param {Surroundings} now @returns {SurroundingsChange} */
export function changeFor({ role, axis, end }, isPressed, now) {
  if (role !== 'limit') return { [role]: isPressed };
  const around = now.axes.find((one) => one.axis === axis);
  if (around === undefined) return {};
  const { place_steps: place, ...switches } = around;
  const beyond = isPressed ? 0 : LET_GO_STEPS;
  return { axes: [{ ...switches, ...(end === 'low' ? { low_steps: place - beyond } : { high_steps: place + beyond }) }] };
}
