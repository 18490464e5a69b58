// @ts-check
// The third step: what makes the steps, how far they go, and what comes of it. The plots beside it show the move.

import { answer, lengthenMove, setPlayer } from '../../app/commands/guide.js';
import { curvesOf, designOf, isDesignValid, messagesOf } from '../../app/selectors.js';
import { leastSteps, PLAYERS } from '../../model/guide.js';
import { formatEntry } from '../../model/numbers.js';
import { shownValue, unitWord } from '../../model/units.js';
import { activeProfile } from '../../plotting/curves.js';
import { element, messageLine } from '../../ui/dom.js';
import { createChoices } from './choices.js';
import { createGuideNumber } from './number.js';

/** @typedef {import('../../model/guide.js').Player} Player */

// What rounding to whole ticks may leave of the speed that was asked for.
const REACHED = 0.99;
/** @type {import('../../model/messages.js').Messages['fields']} */
const NO_MESSAGES = new Map();

/** @param {import('../../app/state.js').Dispatch} dispatch */
export function createRampStep(dispatch) {
  const players = createChoices(
    'guide-player',
    'What makes the steps?',
    Object.entries(PLAYERS).map(([player, told]) => /** @type {[Player, typeof told]} */ ([player, told])),
    (player) => dispatch(setPlayer, player),
  );
  const distance = createGuideNumber('move.steps', 'Of one move; the ramp holds for moves of any length.', (path, value) =>
    dispatch(answer, path, value),
  );
  const result = element('div', { className: 'guide-result', id: 'guide-outcome', role: 'status' });
  const lengthen = element('button', {
    className: 'button',
    id: 'guide-lengthen',
    type: 'button',
    textContent: 'Make it long enough',
    onclick: () => dispatch(lengthenMove),
  });

  return {
    element: element('div', {}, distance.element, result, lengthen, players.element),
    numbers: [distance],
    /** @param {import('../../app/state.js').State} state */
    show(state) {
      const design = designOf(state);
      if (design === null) return;
      players.press(state.guide.player);
      const outcome = outcomeOf(state);
      // That a move is too short is told below, in the units that are shown.
      distance.show(design, state.units, outcome ? NO_MESSAGES : messagesOf(state).fields);
      lengthen.hidden = !outcome?.isShort;
      if (result.textContent === (outcome?.text ?? '')) return;
      result.replaceChildren(...(outcome === null ? [] : [outcomeLine(outcome)]));
    },
  };
}

/** @param {{isShort: boolean, text: string}} outcome */
const outcomeLine = ({ isShort, text }) => (isShort ? messageLine({ text, isWarning: true }) : element('p', { textContent: text }));

/** @param {number} value */
const inFigures = (value) => formatEntry(Math.abs(value) >= 1000 ? Math.round(value) : Number(value.toPrecision(3)));

/** What comes of the move; null while the server hasn't said so of the present design.
 * @param {import('../../app/state.js').State} state */
function outcomeOf(state) {
  const { units } = state;
  const curves = curvesOf(state);
  if (curves === null || !isDesignValid(state)) return null;
  const { design } = curves;
  const told = (/** @type {import('../../model/units.js').Quantity} */ quantity, /** @type {number} */ value) =>
    `${inFigures(shownValue(units, design, quantity, value))} ${unitWord(units, design, quantity)}`;
  const { peak_speed_steps_per_s: peak, duration_s, accelerate_steps } = activeProfile(curves).summary;
  const asked = Number(design.ramp.slew_speed_steps_per_s);
  if (peak < REACHED * asked) {
    const least = told('length', leastSteps(design));
    return { isShort: true, text: `Too short: it reaches ${told('speed', peak)} of ${told('speed', asked)}, and needs about ${least} for that.` };
  }
  const text = `It reaches ${told('speed', peak)} after ${told('length', accelerate_steps)}, and takes ${inFigures(duration_s)} s in all.`;
  return { isShort: false, text };
}
