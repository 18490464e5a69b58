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
import { whenChanged, whenever } from '../state.js';
import { createQuestion } from './question.js';

/** @typedef {import('../../model/types.js').CaptureWish} CaptureWish */
/** design: null where the one in hand can't be computed.
 * @typedef {{file: File, wish: CaptureWish, design: string | null}} Question */

// A whole file is sent for each answer: not for each of the many designs while a slider moves.
const STANDS_MS = 300;

/** Whether what is found of a file is what is asked for.
 * @param {import('../state.js').Capture} capture @param {string | null} design */
const isAnswered = ({ stage, of, wish, answered }, design) => stage === 'answered' && of === design && answered === wish;

/** @param {Pick<import('../state.js').Store, 'dispatch' | 'subscribe'>} store @param {typeof api.capture} [send] */
export function askForCapture({ dispatch, subscribe }, send = api.capture) {
  let sending = new AbortController();
  /** The file that is in hand.
   * @type {File | undefined} */
  let inHand;
  /** The design that it was asked about last.
   * @type {string | null} */
  let heldAgainst = null;
  const question = createQuestion({
    ask: ({ file, wish, design }) => {
      const { signal } = sending;
      return send(file, { ...wish, design }, signal, (sent) => signal.aborted || dispatch(captureSent, sent));
    },
    take: (answer, /** @type {Question} */ { design, wish }) => dispatch(captureCame, answer, design, wish),
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

  /** @param {import('../state.js').State} state */
  function ask(state) {
    const { capture } = state;
    const design = capture && comparedDesignOf(state);
    // Until the design is sound again, what is found for the last sound one counts, but not for another file.
    if (capture !== null && capture.file === inHand && design === null && heldAgainst !== null) return;
    [inHand, heldAgainst] = [capture?.file, design];
    end();
    // One that has its place back, after another file was looked at in vain, has its answer.
    if (capture === null || isAnswered(capture, design)) return;
    dispatch(captureAsked);
    question.want({ file: capture.file, wish: capture.wish, design });
  }

  subscribe(whenever((state) => [state.capture?.file, state.capture?.wish, state.capture && comparedDesignOf(state)], ask));
  subscribe(whenChanged((state) => [state.devices.link], (link) => link === 'there' && question.again()));

  return {
    cancel() {
      end();
      dispatch(captureCancelled);
    },
  };
}
