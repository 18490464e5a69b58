// @ts-check
// A file of a logic analyser, what is wanted of it, and what the server finds in it.

import { axisOf } from '../selectors.js';

/** @typedef {import('../../model/types.js').CaptureWish} CaptureWish */
/** @typedef {import('../state.js').Capture} Capture */
/** @typedef {import('../state.js').State} State */

/** @type {CaptureWish} */
const FIRST_WISH = {
  step_channel: null,
  direction_channel: null,
  edge: null,
  move_number: null,
  alignment: 'first_step',
  shortest_pulse_us: null,
  longest_wait_us: null,
};

/** @param {State} state @param {Partial<Capture>} known @returns {State} */
const knowing = (state, known) => (state.capture === null ? state : { ...state, capture: { ...state.capture, ...known } });

/** Another try is looked at as the one before was, but for what is of its file alone.
 * @param {State} state @param {File} file @returns {State} */
export function openCapture(state, file) {
  const { alignment, shortest_pulse_us, longest_wait_us } = state.capture?.wish ?? FIRST_WISH;
  /** @type {Capture} */
  const capture = {
    file,
    axis: axisOf(state) ?? 0,
    wish: { ...FIRST_WISH, alignment, shortest_pulse_us, longest_wait_us },
    stage: 'asked',
    sent: 0,
    answer: null,
    of: null,
    answered: null,
    rejections: [],
    before: state.capture?.answer ? { ...state.capture, before: null } : (state.capture?.before ?? null),
  };
  return { ...state, capture, isCaptureOpen: true };
}

/** A file that can't be read gives its place back to the one before once it has been looked at.
 * @param {State} state @param {boolean} isCaptureOpen whether the dialog is @returns {State} */
export function showCapture(state, isCaptureOpen) {
  if (state.isCaptureOpen === isCaptureOpen) return state;
  const { capture } = state;
  const isOver = !isCaptureOpen && capture?.stage === 'refused' && capture.answer === null;
  return { ...state, isCaptureOpen, capture: isOver ? (capture.before ?? capture) : capture };
}

/** Of other steps there are other moves.
 * @param {State} state @param {Partial<CaptureWish>} wanted @returns {State} */
export function wishCapture(state, wanted) {
  if (state.capture === null) return state;
  const move = 'alignment' in wanted || 'shortest_pulse_us' in wanted ? {} : { move_number: null };
  return knowing(state, { wish: { ...state.capture.wish, ...move, ...wanted } });
}

/** @param {State} state @returns {State} */
export const captureAsked = (state) => knowing(state, { stage: 'asked', sent: 0 });

/** @param {State} state @param {number} sent share of the file that the server has @returns {State} */
export const captureSent = (state, sent) => knowing(state, { sent });

/** @param {State} state @param {import('../../model/types.js').Captured} answer
 * @param {string | null} of the design; null: none could be computed @param {CaptureWish} answered what was wanted
 * @returns {State} */
export const captureCame = (state, answer, of, answered) =>
  knowing(state, { stage: 'answered', answer, of, answered, rejections: [] });

/** What was found before stays.
 * @param {State} state @param {import('../../model/types.js').Rejection[]} rejections @returns {State} */
export const captureRefused = (state, rejections) => knowing(state, { stage: 'refused', rejections });

/** Nobody answers: the same is asked again.
 * @param {State} state @returns {State} */
export const captureMissed = (state) => knowing(state, { stage: 'unanswered' });

/** A person doesn't want to wait: what was found before stays.
 * @param {State} state @returns {State} */
export const captureCancelled = (state) =>
  state.capture?.answer ? knowing(state, { stage: 'cancelled' }) : { ...state, capture: state.capture?.before ?? null };

/** A file in which nothing was found takes nothing of the one before along.
 * @param {State} state @returns {State} */
export const removeCapture = (state) => ({
  ...state,
  capture: state.capture?.answer ? null : (state.capture?.before ?? null),
});
