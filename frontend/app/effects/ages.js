// @ts-check
// The clock of what is known of the devices: what is old is shown as old while nothing is heard, and so nothing else asks.

import { createAges } from '../../devices/ages.js';
import { aged } from '../commands/device.js';
import { whenChanged } from '../state.js';

const TICK_MS = 500;

/** @param {import('../state.js').Store} store */
export function watchAges({ dispatch, subscribe }) {
  const ages = createAges();
  const now_s = () => performance.now() / 1000;
  const tell = () => dispatch(aged, ages.old(now_s()));
  subscribe(
    whenChanged(
      (present) => [present.devices.list],
      (list) => {
        ages.hear(list, now_s());
        tell();
      },
    ),
  );
  setInterval(tell, TICK_MS);
}
