// @ts-check
// The examples that the server has: asked for until they are there, and again when the server is back.

import { api } from '../../server/api.js';
import { examplesCame } from '../commands/answers.js';
import { tell } from '../commands/told.js';
import { begin } from '../commands/work.js';
import { whenChanged } from '../state.js';
import { createQuestion } from './question.js';

/** @param {import('../state.js').Store} store */
export function askForExamples({ state, dispatch, subscribe }) {
  const question = createQuestion({
    ask: () => api.examples(),
    take({ examples }) {
      dispatch(examplesCame, examples);
      // The first thing to work on, where nothing is kept from the last time.
      if (state().history === null && examples.length > 0) dispatch(begin, { axes: [examples[0].design], together: 'independent' });
    },
    refuse: (refusal) => dispatch(tell, refusal.message, true),
  });
  question.want(null);
  subscribe(whenChanged((present) => [present.devices.link], (link) => link === 'there' && question.want(null), state()));
}
