// @ts-check
// The curves of the design in hand: asked for whenever they would be others.

import { methodsToCompute } from '../../model/design.js';
import { calculate } from '../../server/calculation.js';
import { curvesAwaited, curvesCame, curvesMissed, curvesRefused } from '../commands/answers.js';
import { isOfMotion } from '../../plotting/plots.js';
import { axisOf, designOf, isSliding, pinnedOf, viewOf } from '../selectors.js';
import { whenChanged } from '../state.js';
import { createQuestion } from './question.js';

/** @typedef {import('../state.js').Store} Store */

// What is older than that is shown to be: sooner it would flicker under a slider.
const LATE_AFTER_MS = 300;

/** @param {Pick<Store, 'dispatch' | 'subscribe'>} store @param {typeof calculate} [ask] */
export function askForCurves({ dispatch, subscribe }, ask = calculate) {
  const question = createQuestion({
    ask: (/** @type {Question} */ { design, methods, details }, ended) => ask(design, methods, details, ended),
    take(curves, asked) {
      answered(asked);
      dispatch(curvesCame, curves, asked.axis);
    },
    refuse({ rejections }, asked) {
      answered(asked);
      dispatch(curvesRefused, rejections, asked.design, asked.axis);
    },
    miss(asked) {
      answered(asked);
      dispatch(curvesMissed, asked.axis);
    },
  });
  /** The design that was asked about last, and the one of the newest answer.
   * @type {{asked: Design | null, told: Design | null}} */
  const about = { asked: null, told: null };
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  let late;

  /** Finer points of a design that is shown already are waited for in silence. */
  function wait() {
    if (about.asked !== about.told) late ??= setTimeout(() => dispatch(curvesAwaited), LATE_AFTER_MS);
  }

  /** @param {Question} question */
  function answered({ design }) {
    clearTimeout(late);
    late = undefined;
    about.told = design;
    wait();
  }

  /** @typedef {import('../../model/types.js').Design} Design */
  /** @typedef {{axis: number, design: Design, methods: string[],
   *   details: import('../../server/calculation.js').Details}} Question */
  /** @type {number | null} */
  let present = null;

  subscribe(
    whenChanged(
      (state) => {
        const { range, acceleration, third } = viewOf(state);
        const design = designOf(state);
        // As a text: methods that are shown in another order, or can't be computed, ask nothing anew.
        const methods = design === null ? '' : methodsToCompute(design, new Set(state.shown)).join(' ');
        // The pinned design is compared by it in words, too.
        const motion = isOfMotion(third) || pinnedOf(state) !== null;
        return [axisOf(state), design, methods, range, acceleration, third === 'parts', motion, isSliding(state)];
      },
      (axis, design, methods, range, acceleration, parts, motion, isMoving) => {
        if (axis === null || design === null) return;
        // What is on its way is of another axis.
        if (axis !== present) question.cancel();
        present = axis;
        const details = { range, acceleration, parts, motion, isMoving };
        about.asked = design;
        wait();
        question.want({ axis, design, methods: methods.split(' '), details });
      },
    ),
  );
  subscribe(whenChanged((state) => [state.devices.link], (link) => link === 'there' && question.again()));
}
