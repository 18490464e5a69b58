// @ts-check
// Whether the motor makes the move and why not, what to change, each as a button, and the ways to look closer.

import { mend } from '../../app/commands/work.js';
import { textOf } from '../../model/messages.js';
import { causeText, marginText, notCoveredText, VERDICTS } from '../../model/motor_words.js';
import { remedyWords } from '../../model/told.js';
import { element, icon, showText } from '../../ui/dom.js';
import { createTorqueChart } from './torque_chart.js';

/** @typedef {import('../../model/types.js').Design} Design */
/** What opens the dialogs about the motor.
 * @typedef {{openRotor: () => void, openMap: () => void, openFastest: () => void}} Looks */

/** @param {import('../../app/state.js').Dispatch} dispatch @param {Looks} looks */
export function createMotorFound(dispatch, { openRotor, openMap, openFastest }) {
  const verdict = element('p', { className: 'verdict', id: 'motor-verdict', role: 'status' });
  const details = element('p', { className: 'muted', id: 'motor-details' });
  const notCovered = element('p', { className: 'muted', id: 'motor-not-covered' });
  const proposals = element('div', { className: 'remedies', id: 'motor-proposals' });
  const closer = element(
    'div',
    { className: 'remedies' },
    button('What the rotor does', openRotor, 'open-rotor'),
    button('Stall map', openMap, 'open-map'),
    button('Fastest safe ramp', openFastest, 'open-fastest'),
  );
  const chart = createTorqueChart();
  const box = element('div', { className: 'motor-found', hidden: true }, verdict, proposals, closer, chart.element, details, notCovered);
  let shownProposals = '';

  return {
    element: box,
    /** @param {ReturnType<typeof import('../../app/selectors.js').motorOf>} known @param {import('../../model/units.js').Units} units
     * @param {Design | null} design @param {number | null} axis */
    show(known, units, design, axis) {
      box.hidden = known === null;
      if (known === null || design === null) return;
      const { answer, rejections } = known;
      box.classList.toggle('stale', known.design !== design || answer === null);
      const said = answer ? `${VERDICTS[answer.verdict]}${causeText(answer)}` : textOf(rejections) || 'Nothing is known yet of what the motor does.';
      if (verdict.textContent !== said || verdict.dataset.verdict !== (answer?.verdict ?? 'unknown')) {
        verdict.dataset.verdict = answer?.verdict ?? 'unknown';
        verdict.replaceChildren(...(answer ? [icon(answer.verdict === 'safe' ? 'ok' : 'warning')] : []), element('span', { textContent: said }));
      }
      showText(details, answer ? marginText(answer, units, design) : '');
      showText(notCovered, answer ? notCoveredText(answer) : '');
      // While a slider moves none are looked for: those that stand there are of before.
      const named = (answer?.proposals ?? []).map((remedy) => ({ remedy, text: remedyWords(units, design, remedy) }));
      const offered = JSON.stringify([named, axis]);
      if (offered !== shownProposals) proposals.replaceChildren(...named.map((one) => proposal(one, axis)));
      proposals.hidden = proposals.childElementCount === 0;
      shownProposals = offered;
      chart.show(answer, units, design);
    },
  };

  /** @param {{remedy: import('../../model/types.js').Remedy, text: string}} named @param {number | null} axis */
  function proposal({ remedy, text }, axis) {
    return button(text, () => axis !== null && dispatch(mend, axis, remedy));
  }
}

/** @param {string} textContent @param {() => void} onclick @param {string} [id] */
const button = (textContent, onclick, id) => element('button', { className: 'button small', type: 'button', textContent, onclick, ...(id && { id }) });
