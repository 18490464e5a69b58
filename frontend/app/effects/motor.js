// @ts-check
// What the motor does with the design in hand: asked for while the design has a motor, once the server has found it sound.

import { api } from '../../server/api.js';
import { motorCame } from '../commands/answers.js';
import { axisOf, curvesOf, isDesignValid, isSliding } from '../selectors.js';
import { whenChanged } from '../state.js';
import { createQuestion, whyLater } from './question.js';

/** @typedef {import('../../model/types.js').Design} Design */

/** @param {Pick<import('../state.js').Store, 'dispatch' | 'subscribe'>} store @param {typeof api.simulateMotor} [ask] */
export function askForMotor({ dispatch, subscribe }, ask = api.simulateMotor) {
  const question = createQuestion({
    ask: (/** @type {{design: Design, axis: number, isMoving: boolean}} */ { design, isMoving }, ended) => ask(design, !isMoving, ended),
    take: (answer, { design, axis }) => dispatch(motorCame, design, answer, [], axis),
    refuse: ({ rejections }, { design, axis }) => dispatch(motorCame, design, null, rejections, axis),
    miss: ({ design, axis }, error) => dispatch(motorCame, design, null, whyLater(error), axis),
  });
  let wasMoving = false;

  subscribe(
    whenChanged(
      (state) => [axisOf(state), curvesOf(state)?.design, isDesignValid(state), isSliding(state)],
      (axis, design, isValid, isMoving) => {
        // What looks for proposals takes a while: what comes after it doesn't wait for that.
        if (!isMoving || !wasMoving) question.cancel();
        wasMoving = isMoving;
        if (axis === null || design?.motor === undefined || !isValid) return;
        question.want({ design, axis, isMoving });
      },
    ),
  );
  subscribe(whenChanged((state) => [state.devices.link], (link) => link === 'there' && question.again()));
}
