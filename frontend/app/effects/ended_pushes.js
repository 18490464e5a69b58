// @ts-check
// What became of a push on whose way a STOP came: told as soon as it is known.

import { createEndedPushes, PUSH_OUTCOMES, REPORT_WITHIN_MS } from '../../devices/ended_pushes.js';
import { tell } from '../commands/told.js';
import { whenever } from '../state.js';

/** @typedef {import('../../model/types.js').Device} Device */

/** @param {import('../state.js').Store} store */
export function watchEndedPushes({ state, dispatch, subscribe }) {
  const pushes = createEndedPushes(() => performance.now());
  const look = () => pushes.follow(state().devices.list).forEach((outcome) => dispatch(tell, PUSH_OUTCOMES[outcome], true));

  subscribe(
    whenever(
      (now) => [now.devices.list],
      () => {
        if (!pushes.isAwaiting()) return;
        look();
        // At rest nothing more may be told.
        setTimeout(look, REPORT_WITHIN_MS);
      },
      state(),
    ),
  );
  return {
    /** @param {Device} before how the device was when the push was asked for */
    await(before) {
      const now = state().devices.list.find(({ id }) => id === before.id);
      pushes.await(before, now?.state === 'writing');
    },
    forget: pushes.forget,
  };
}
