// @ts-check
// A maker's torque curve, pasted or typed: it becomes the design's only as a whole.

import { CHOICES } from '../../model/fields.js';
import { torquePointsOf, torquePointsText } from '../../model/torque_points.js';
import { element, showMessage } from '../../ui/dom.js';

/** @typedef {import('../../model/types.js').Design} Design */

const CURVE = 'motor.torque_curve';

/** @param {import('./stall_point.js').OnMeasured} onMeasured */
export function createTorqueCurve(onMeasured) {
  const { label, help } = CHOICES[CURVE];
  const name = element('span', {}, label, element('small', { className: 'muted', textContent: ' a line each: rpm, Nm' }));
  const text = element('textarea', {
    id: 'torque-curve',
    rows: 4,
    spellcheck: false,
    autocomplete: 'off',
    placeholder: 'rpm, Nm\n100, 0.35\n600, 0.31',
    'aria-label': label,
    'aria-description': help,
    oninput: typed,
    onblur: () => problems.length === 0 && write(),
  });
  const box = element('div', { className: 'messages' });
  /** @type {string[]} */
  let problems = [];
  /** @type {import('../../model/types.js').MotorData['torque_curve']} */
  let present = null;
  /** @type {import('../../model/messages.js').Message | undefined} */
  let message;

  function typed() {
    const read = torquePointsOf(text.value);
    problems = read.problems;
    if (problems.length === 0) onMeasured('torque_curve', read.points.length === 0 ? undefined : read.points, `type:${CURVE}`);
    tell();
  }

  function write() {
    text.value = present ? torquePointsText(present) : '';
  }

  function tell() {
    const [first, ...others] = problems;
    const more = others.length === 0 ? '' : ` And ${others.length} more line${others.length === 1 ? '' : 's'}.`;
    const refused = first === undefined ? undefined : { text: `${first}${more} The curve stays as it was.`, isWarning: false };
    showMessage(text, box, refused ?? message);
  }

  return {
    name,
    element: element('div', { className: 'drawn-points motor-curve' }, name, text, box),
    /** @param {Design} design */
    show(design) {
      const now = design.motor?.torque_curve ?? null;
      if (now === present) return;
      present = now;
      // What is being typed stays as it is typed; another curve, as of an undo, takes its place.
      if (JSON.stringify(torquePointsOf(text.value).points) === JSON.stringify(now ?? [])) return;
      problems = [];
      write();
      tell();
    },
    /** @param {import('../../model/messages.js').Messages['fields']} messages */
    showMessage(messages) {
      message = messages.get(CURVE);
      tell();
    },
  };
}
