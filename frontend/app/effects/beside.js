// @ts-check
// What is shown beside the design in hand: the pinned design's curves, and all axes of the machine over one time.

import { api } from '../../server/api.js';
import { calculate, NO_DETAILS } from '../../server/calculation.js';
import { allAxesAwaited, allAxesCame, allAxesMissed, pinnedCame } from '../commands/answers.js';
import { areAxesShown, machineOf } from '../selectors.js';
import { whenChanged } from '../state.js';
import { createLateness } from './lateness.js';
import { createQuestion } from './question.js';

/** @typedef {import('../../model/types.js').Design} Design */
/** @typedef {import('../../model/workbench.js').Work} Work */

// As many points as a wide screen has pixels.
const MAX_POINTS = 1500;

/** @param {Pick<import('../state.js').Store, 'dispatch' | 'subscribe'>} store @param {typeof api.schedule} [schedule] */
export function askForBeside({ dispatch, subscribe }, schedule = api.schedule) {
  const pinned = createQuestion({
    ask: (/** @type {Design} */ design, ended) => 
      calculate(design, [design.method.name], { ...NO_DETAILS, motion: true }, ended),
    take: (curves, design) => dispatch(pinnedCame, design, curves),
    refuse: (_, design) => dispatch(pinnedCame, design, null),
  });
  const allAxes = createQuestion({
    ask: (/** @type {Work} */ { axes, together }, ended) => schedule(axes, together, MAX_POINTS, ended),
    take(planned, work) {
      lateness.answered(work);
      dispatch(allAxesCame, { ...work, planned, rejections: [] });
    },
    refuse({ rejections }, work) {
      lateness.answered(work);
      dispatch(allAxesCame, { ...work, planned: null, rejections });
    },
    miss(work) {
      lateness.answered(work);
      dispatch(allAxesMissed);
    },
  });
  const lateness = createLateness(() => dispatch(allAxesAwaited));
  let wereShown = false;

  subscribe(
    whenChanged(
      (state) => [machineOf(state)?.kept ?? null],
      (design) => (design === null ? pinned.cancel() : pinned.want(design)),
    ),
  );
  subscribe(
    whenChanged(
      (state) => [areAxesShown(state), machineOf(state)?.axes, machineOf(state)?.together],
      (areShown, axes, together) => {
        if (areShown && axes && together) {
          const work = { axes, together };
          lateness.asked(work);
          // What was answered before may be of anything.
          if (!wereShown) dispatch(allAxesAwaited);
          allAxes.want(work);
        } else {
          lateness.forget();
          allAxes.cancel();
        }
        wereShown = areShown;
      },
    ),
  );
  subscribe(
    whenChanged(
      (state) => [state.devices.link],
      (link) => {
        if (link !== 'there') return;
        pinned.again();
        allAxes.again();
      },
    ),
  );
}
