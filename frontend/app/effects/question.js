// @ts-check
// A question to the server that is asked anew as things change. One is under way at a time, and of those that wait only
// the newest counts. What is cancelled is never heard of again; what nobody answered, or the server could not answer just
// then, is asked again after a while.

import { isForLater, Refusal, ServerGone } from '../../server/api.js';

const FIRST_PAUSE_MS = 1_000;
const LONGEST_PAUSE_MS = 15_000;

/** What a dialog says until something is asked again.
 * @param {Refusal | ServerGone} error */
export const laterText = (error) =>
  error instanceof Refusal ? `${error.message} The page asks again by itself.` : 'The server does not answer. It is asked again until it does.';

/** What is wrong with the server then; nothing where it is not there.
 * @param {Refusal | ServerGone} error */
export const whyLater = (error) => (error instanceof Refusal ? error.rejections : []);

/**
 * @template Question, Found
 * @param {object} handlers  called only while the question has not been cancelled
 * @param {(question: Question, ended: AbortSignal) => Promise<Found>} handlers.ask  ended: it has been cancelled
 * @param {(found: Found, question: Question) => void} handlers.take
 * @param {(refusal: Refusal, question: Question) => void} handlers.refuse
 * @param {(question: Question, error: Refusal | ServerGone) => void} [handlers.miss]  nobody answered, or the server could not
 * @param {number} [handlers.afterMs]  how long a question has to stand before it is asked
 * @param {boolean} [handlers.isOnlyNewest]  an answer isn't heard while a newer question waits
 */
export function createQuestion({ ask, take, refuse, miss = () => {}, afterMs = 0, isOnlyNewest = false }) {
  /** isDue: it has stood long enough.
   * @type {{question: Question, isDue: boolean} | null} */
  let next = null;
  /** What nobody answered.
   * @type {{question: Question} | null} */
  let missed = null;
  let isUnderWay = false;
  /** What ends the questions since the last cancelling. */
  let present = new AbortController();
  let pauseMs = FIRST_PAUSE_MS;
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  let waiting;

  /** @param {AbortSignal} ended */
  const isOver = (ended) => ended.aborted || (isOnlyNewest && next !== null);

  /** @param {Question} question @param {AbortSignal} ended */
  async function askOne(question, ended) {
    try {
      const found = await ask(question, ended);
      if (isOver(ended)) return;
      pauseMs = FIRST_PAUSE_MS;
      take(found, question);
    } catch (error) {
      if (isOver(ended)) return;
      if (isForLater(error)) later(question, error);
      else if (error instanceof Refusal) {
        pauseMs = FIRST_PAUSE_MS;
        refuse(error, question);
      }
      else throw error;
    }
  }

  async function work() {
    if (isUnderWay || !next?.isDue) return;
    const ended = present.signal;
    const { question } = next;
    [next, isUnderWay] = [null, true];
    try {
      await askOne(question, ended);
    } finally {
      // Also when what took the answer has failed.
      if (!ended.aborted) {
        isUnderWay = false;
        work();
      }
    }
  }

  /** @param {Question} question @param {Refusal | ServerGone} error */
  function later(question, error) {
    miss(question, error);
    if (next !== null) return;
    missed = { question };
    clearTimeout(waiting);
    waiting = setTimeout(again, pauseMs);
    pauseMs = Math.min(LONGEST_PAUSE_MS, 2 * pauseMs);
  }

  /** What nobody answered is asked again at once: the server is back. */
  function again() {
    if (missed !== null) want(missed.question, 0);
  }

  /** @param {Question} question @param {number} [standsMs] */
  function want(question, standsMs = afterMs) {
    const wanted = { question, isDue: standsMs === 0 };
    [next, missed] = [wanted, null];
    clearTimeout(waiting);
    if (wanted.isDue) work();
    else {
      waiting = setTimeout(() => {
        wanted.isDue = true;
        work();
      }, standsMs);
    }
  }

  return {
    want: (/** @type {Question} */ question) => want(question),
    again,
    /** Nothing is asked any more; what is on its way is ended, and not heard. */
    cancel() {
      present.abort();
      present = new AbortController();
      [next, missed, isUnderWay, pauseMs] = [null, null, false, FIRST_PAUSE_MS];
      clearTimeout(waiting);
    },
  };
}
