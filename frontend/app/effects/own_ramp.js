// @ts-check
// What the controller in view, or the machine chosen, really plays of the design in hand: asked for where it works its
// intervals out itself.

import { api } from '../../server/api.js';
import { ownRampCame } from '../commands/answers.js';
import { ownPlayerOf } from '../devices.js';
import { curvesOf, isDesignValid } from '../selectors.js';
import { whenChanged } from '../state.js';
import { createQuestion } from './question.js';

/** @typedef {import('../../model/types.js').Design} Design */
/** @typedef {{player: string, design: Design, stepsPerMm: number | null}} Question */

/** @param {Pick<import('../state.js').Store, 'dispatch' | 'subscribe'>} store @param {typeof api.ownRamp} [ask] */
export function askForOwnRamp({ dispatch, subscribe }, ask = api.ownRamp) {
  const question = createQuestion({
    ask: (/** @type {Question} */ { player, design, stepsPerMm }, ended) => ask(player, design, stepsPerMm, ended),
    take: (ramp, { player, design }) => dispatch(ownRampCame, { player, design, ramp }),
    refuse: (_, { player, design }) => dispatch(ownRampCame, { player, design, ramp: null }),
  });

  subscribe(
    whenChanged(
      (state) => {
        const player = ownPlayerOf(state);
        return [player?.route ?? null, player?.stepsPerMm ?? null, curvesOf(state)?.design ?? null, isDesignValid(state)];
      },
      (player, stepsPerMm, design, isValid) => {
        if (player !== null && design !== null && isValid) return question.want({ player, design, stepsPerMm });
        question.cancel();
        dispatch(ownRampCame, null);
      },
    ),
  );
  subscribe(whenChanged((state) => [state.devices.link], (link) => link === 'there' && question.again()));
}
