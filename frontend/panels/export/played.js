// @ts-check
// What a machine that ramps by itself really plays of the design: in words, and, if wanted, as a curve of the plots.

import { createQuestion, laterText } from '../../app/effects/question.js';
import { drawMachine } from '../../app/commands/view.js';
import { api } from '../../server/api.js';
import { element, showText } from '../../ui/dom.js';
import { playedText } from '../../documents/exports.js';

/** @typedef {import('../../documents/exports.js').ExportFormat} ExportFormat */
/** @typedef {import('../../model/types.js').Design} Design */

/** @param {Pick<import('../../app/state.js').Store, 'state' | 'dispatch'>} store @param {typeof api.ownRamp} [ask] */
export function createPlayed({ state, dispatch }, ask = api.ownRamp) {
  /** @type {ExportFormat | null} */
  let machine = null;
  const words = element('span', { id: 'export-played' });
  const box = element('input', {
    type: 'checkbox',
    id: 'export-draw',
    onchange: () => dispatch(drawMachine, box.checked && machine ? { name: machine.name, title: machine.title ?? machine.label } : null),
  });
  const draw = element('label', {}, box, element('span', { textContent: 'Draw it beside the design' }));
  const whole = element('div', { className: 'export-played', hidden: true }, words, draw);

  const question = createQuestion({
    ask: (/** @type {{format: ExportFormat, design: Design}} */ { format, design }, ended) => ask(`machine/${format.name}`, design, null, ended),
    take: (ramp, { format }) => say(playedText(ramp, format.title ?? format.label), true),
    refuse: ({ message }) => say(message, false),
    miss: (_, error) => say(laterText(error), false),
    isOnlyNewest: true,
  });

  /** @param {string} text @param {boolean} canBeDrawn */
  function say(text, canBeDrawn) {
    showText(words, text);
    draw.hidden = !canBeDrawn;
    box.checked = state().ownMachine?.name === machine?.name;
    whole.hidden = text === '';
  }

  return {
    element: whole,
    /** @param {ExportFormat} format @param {Design} design @param {string | null} unplayed  why it isn't known; null: it is */
    show(format, design, unplayed) {
      machine = format;
      question.cancel();
      if (unplayed === null) question.want({ format, design });
      else say(unplayed, false);
    },
    hide() {
      question.cancel();
      say('', false);
    },
    again: question.again,
  };
}
