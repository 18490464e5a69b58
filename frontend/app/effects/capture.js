// @ts-check
// The captured file: sent and asked about whenever something else is wanted of it, or the design is another. The page
// keeps the file, the server doesn't.

import { api } from '../../server/api.js';
import {
  captureAsked,
  captureCame,
  captureCancelled,
  captureMissed,
  captureRefused,
  captureSent,
} from '../commands/capture.js';
import { comparedDesignOf } from '../selectors.js';
import { whenChanged } from '../state.js';
import { createQuestion } from './question.js';

/** @typedef {import('../../model/types.js').CaptureWish} CaptureWish */
/** @typedef {{file: File, wish: CaptureWish, design: string}} Question */

// A whole file is sent for each answer: not for each of the many designs while a slider moves.
const STANDS_MS = 300;

/** @param {Pick<import('../state.js').Store, 'dispatch' | 'subscribe'>} store @param {typeof api.capture} [send] */
export function askForCapture({ dispatch, subscribe }, send = api.capture) {
  let sending = new AbortController();
  /** The file that is in hand.
   * @type {File | undefined} */
  let inHand;
  const question = createQuestion({
    ask: ({ file, wish, design }) => {
      const { signal } = sending;
      return send(file, { ...wish, design }, signal, (sent) => signal.aborted || dispatch(captureSent, sent));
    },
    take: (answer, /** @type {Question} */ { design }) => dispatch(captureCame, answer, design),
    refuse: ({ rejections }) => dispatch(captureRefused, rejections),
    miss: () => dispatch(captureMissed),
    afterMs: STANDS_MS,
  });

  /** What is on its way isn't wanted any more. */
  function end() {
    sending.abort();
    sending = new AbortController();
    question.cancel();
  }

  subscribe(
    whenChanged(
      (state) => [state.capture?.file, state.capture?.wish, state.capture && comparedDesignOf(state)],
      (file, wish, design) => {
        // Until the design is sound again, what is found for the last sound one counts, but not for another file.
        if (file === inHand && design === null) return;
        inHand = file;
        end();
        if (file === undefined || wish === undefined || design === null) return;
        dispatch(captureAsked);
        question.want({ file, wish, design });
      },
    ),
  );
  subscribe(whenChanged((state) => [state.devices.link], (link) => link === 'there' && question.again()));

  return {
    cancel() {
      end();
      dispatch(captureCancelled);
    },
  };
}
