// @ts-check
// The dialogs about the motor of the design in hand: what its rotor does, its stall map, and its fastest safe ramps.

import { createFastest } from './fastest.js';
import { createMap } from './map.js';
import { createRotor } from './rotor.js';

/** @param {import('../../app/state.js').Dispatch} dispatch @param {Parameters<typeof createMap>[1]} act */
export function createMotorDialogs(dispatch, act) {
  const [rotor, map, fastest] = [createRotor(), createMap(dispatch, act), createFastest(dispatch)];
  return {
    openRotor: rotor.open,
    openMap: () => map.open(),
    /** What was kept of the axis in hand comes in view. */
    openMapOver: map.open,
    openFastest: fastest.open,
    /** @param {import('../../app/state.js').State} state */
    show(state) {
      for (const dialog of [rotor, map, fastest]) dialog.show(state);
    },
  };
}
