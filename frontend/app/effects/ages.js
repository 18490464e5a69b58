// @ts-check
// The clock of what is known of the devices: what is old is shown as old while nothing is heard, and so nothing else asks.

import { createAges, TOLD_EACH_S } from '../../devices/ages.js';
import { aged } from '../commands/device.js';
import { whenChanged } from '../state.js';

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
  setInterval(tell, TOLD_EACH_S * 1000);
}
