// @ts-check
// STOP, and what has to be known of it: whether the next press halts, and which devices are out of reach.

import { createOutOfReach } from '../../devices/out_of_reach.js';
import { createStop } from '../../devices/stopping.js';
import { stopKnown } from '../commands/device.js';
import { announce, urge } from '../commands/told.js';
import { whenChanged } from '../state.js';

/**
 * @param {import('../state.js').Store} store
 * @param {() => void} endMotions  nothing of what was asked for until now is sent any more
 * @param {(devices: import('../../model/types.js').Device[]) => void} hearStops
 */
export function createStopping({ state, dispatch, subscribe }, endMotions, hearStops) {
  const devices = () => state().devices.list;
  const outOfReach = createOutOfReach();
  const stop = createStop({ devices, endMotions, hearStops }, (text) => {
    dispatch(announce, text);
    tell();
  });

  function tell() {
    const isUndelivered = outOfReach.isUndelivered(devices(), stop.isStopped);
    dispatch(stopKnown, stop.isHaltNext(), isUndelivered ? 'undelivered' : stop.fate());
    dispatch(urge, 'out of reach', outOfReach.words(devices(), stop.isStopped));
  }

  subscribe(
    whenChanged(
      (present) => [present.devices.list],
      (list) => {
        stop.follow(list);
        outOfReach.follow(list);
        tell();
      },
    ),
  );
  subscribe(
    whenChanged(
      (present) => [present.devices.link],
      (link) => {
        if (link !== 'gone') return;
        outOfReach.leave(devices());
        stop.leave();
        tell();
      },
    ),
  );
  return {
    stop() {
      const pressed = stop.press();
      tell();
      pressed.then(tell);
    },
  };
}
