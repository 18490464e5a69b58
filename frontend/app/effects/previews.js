// @ts-check
// What a push would change: asked of the device in view, once a design has stood for a moment.

import { api, UNPROCESSABLE } from '../../server/api.js';
import { previewCame } from '../commands/device.js';
import { areSameQuestions, deviceOf, previewQuestionOf } from '../devices.js';
import { isDesignValid, machineOf } from '../selectors.js';
import { whenChanged, whenever } from '../state.js';
import { createQuestion } from './question.js';

/** @typedef {import('../../model/types.js').Design} Design */
/** @typedef {import('../../model/types.js').Pushed} Pushed */
/** @typedef {import('../devices.js').PreviewQuestion} PreviewQuestion */

/** A design that is still being changed is not asked about. */
const STANDS_MS = 250;

/** What a push sends: one design goes to one axis, several are those of all axes.
 * @param {Design[]} designs @param {number} toAxis @returns {Pushed} */
export function pushOf(designs, toAxis) {
  return designs.length === 1 ? { design: designs[0], to_axis: toAxis } : { axes: designs };
}

/** @param {import('../state.js').Store} store */
export function askForPreviews({ dispatch, subscribe }) {
  /** The last that was asked; null: none, or the answer to it was that it can't be told now.
   * @type {PreviewQuestion | null} */
  let asked = null;
  const question = createQuestion({
    ask: (/** @type {PreviewQuestion} */ { id, axis, designs }, ended) => api.preview(id, pushOf(designs, axis), ended),
    take: (preview, about) => dispatch(previewCame, { question: about, preview, rejections: [] }),
    refuse: ({ status, rejections }, about) => {
      if (status === UNPROCESSABLE) dispatch(previewCame, { question: about, preview: null, rejections });
      else asked = null; // Not now: asked again when there is news of the device.
    },
    afterMs: STANDS_MS,
  });

  /** Nothing that is on its way counts: it is asked anew when there is news. */
  function forget() {
    question.cancel();
    asked = null;
  }

  subscribe(
    whenever(
      (present) => [present.devices, machineOf(present), isDesignValid(present)],
      (present) => {
        const wanted = previewQuestionOf(present);
        if (asked !== null && asked.id !== deviceOf(present)?.id) forget();
        if (wanted === null || (asked !== null && areSameQuestions(wanted, asked))) return;
        asked = wanted;
        question.want(wanted);
      },
    ),
  );
  subscribe(whenChanged((present) => [present.devices.link], (link) => link === 'there' && question.again()));
  return {
    forget,
    /** The controller is another now than what was said of it. */
    outdate() {
      forget();
      dispatch(previewCame, null);
    },
  };
}
