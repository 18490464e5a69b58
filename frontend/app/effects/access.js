// @ts-check
// What this page may do, where the server is shared: asked at the start, and again when the server is back.

import { api } from '../../server/api.js';
import { accessCame } from '../commands/device.js';
import { tell } from '../commands/told.js';
import { whenChanged } from '../state.js';
import { createQuestion } from './question.js';

/** @param {import('../state.js').Store} store */
export function askForAccess({ state, dispatch, subscribe }) {
  const question = createQuestion({
    ask: () => api.access(),
    take: (access) => dispatch(accessCame, access),
    refuse: (refusal) => dispatch(tell, refusal.message, true),
  });
  question.want(null);
  subscribe(whenChanged((present) => [present.devices.link], (link) => link === 'there' && question.want(null), state()));
}
