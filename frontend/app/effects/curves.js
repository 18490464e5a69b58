// @ts-check
// The curves of the design in hand: asked for whenever they would be others.

import { methodsToCompute } from '../../model/design.js';
import { calculate } from '../../server/calculation.js';
import { curvesAwaited, curvesCame, curvesMissed, curvesRefused } from '../commands/answers.js';
import { isOfMotion } from '../../plotting/plots.js';
import { axisOf, designOf, isSliding, pinnedOf, viewOf } from '../selectors.js';
import { whenChanged } from '../state.js';
import { createLateness } from './lateness.js';
import { createQuestion, whyLater } from './question.js';

/** @typedef {import('../state.js').Store} Store */

/** @param {Pick<Store, 'dispatch' | 'subscribe'>} store @param {typeof calculate} [ask] */
export function askForCurves({ dispatch, subscribe }, ask = calculate) {
  const question = createQuestion({
    ask: (/** @type {Question} */ { design, methods, details }, ended) => ask(design, methods, details, ended),
    take(curves, asked) {
      lateness.answered(asked.design);
      dispatch(curvesCame, curves, asked.axis);
    },
    refuse({ rejections }, asked) {
      lateness.answered(asked.design);
      dispatch(curvesRefused, rejections, asked.design, asked.axis);
    },
    miss(asked, error) {
      lateness.answered(asked.design);
      dispatch(curvesMissed, asked.axis, whyLater(error));
    },
  });
  // By the design: finer points of one that is shown already are waited for in silence.
  const lateness = createLateness(() => dispatch(curvesAwaited));

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
        lateness.asked(design);
        question.want({ axis, design, methods: methods.split(' '), details });
      },
    ),
  );
  subscribe(whenChanged((state) => [state.devices.link], (link) => link === 'there' && question.again()));
}
