// @ts-check
// A number that the guide asks for: its name, its unit, where to find it, and what is wrong with it.

import { valueAt } from '../../model/design.js';
import { GROUPS } from '../../model/fields.js';
import { refusalText } from '../../model/messages.js';
import { inUnit } from '../../model/rejection_text.js';
import { factorOf, isNothing, readEntry, shownEntry, tooShortText, unitOf } from '../../model/shown_entry.js';
import { element, showMessage, showText } from '../../ui/dom.js';
import { selectOnFocus } from '../../ui/select_on_focus.js';

/** @typedef {import('../../model/types.js').Design} Design */
/** @typedef {import('../../model/units.js').Units} Units */
/** @typedef {ReturnType<typeof createGuideNumber>} GuideNumber */
/** How a number is told: what it is called, its unit, and how many of that one of the design's is.
 * @typedef {{label: string, unit: string, factor: number}} Manner */

const FIELDS = GROUPS.flatMap((group) => group.fields);

/** The message, with the field called what the guide calls it.
 * @param {import('../../model/messages.js').Message} message @param {string} label */
const called = (message, label) => (message.refused ? { ...message, text: refusalText(message.refused, label) } : message);

/** @param {string} path in the design @param {string} hint where to find it
 * @param {(path: string, value: unknown) => void} onAnswer
 * @param {string} [ending] of its id, where a path is asked for in several ways */
export function createGuideNumber(path, hint, onAnswer, ending = '') {
  const field = /** @type {import('../../model/fields.js').Field} */ (FIELDS.find((one) => one.path === path));
  const id = `guide-${path.replaceAll('.', '-')}${ending}`;
  /** @type {Manner} */
  let manner = { label: field.label, unit: field.unit, factor: 1 };
  /** What is said of it.
   * @type {import('../../model/messages.js').Message | undefined} */
  let own;
  const input = element('input', {
    id,
    className: 'number',
    inputMode: 'decimal',
    autocomplete: 'off',
    spellcheck: false,
    oninput: type,
  });
  /** What was typed, where that is no whole number of steps.
   * @type {import('../../model/shown_entry.js').Between & {factor: number} | null} */
  let between = null;

  function type() {
    const { factor } = manner;
    const { entry, exact } = readEntry(field, input.value, factor);
    between = exact === null ? null : { text: input.value.trim(), exact, factor };
    onAnswer(path, entry);
  }

  /** @param {import('../../model/messages.js').Message} message @param {number} factor of what it is said in */
  function inWords(message, factor) {
    if (between?.factor !== factor || !isNothing(message.refused)) {
      return inUnit(called(message, manner.label), { label: manner.label }, manner.unit, factor);
    }
    return { ...message, text: tooShortText(between, manner.unit, factor) };
  }

  selectOnFocus(input);
  const label = element('label', { htmlFor: id });
  const unit = element('span', { className: 'unit' });
  const box = element('div', { className: 'messages' });
  const note = element('p', { className: 'guide-hint', textContent: hint });
  const whole = element('div', { className: 'guide-number' }, label, element('span', { className: 'field' }, input, unit), note, box);

  return {
    path,
    element: whole,
    focus: () => input.focus(),
    /** What it is called and why it is refused; null where it isn't, or isn't asked for. */
    refused: () => (own === undefined || own.isWarning || whole.hidden ? null : { label: manner.label, text: own.text }),
    /** @param {Design} design @param {Units} units @param {import('../../model/messages.js').Messages['fields']} messages
     * @param {Partial<Manner>} [told] otherwise than the field is */
    show(design, units, messages, told = {}) {
      manner = { label: field.label, unit: unitOf(units, design, field), factor: factorOf(units, design, field), ...told };
      showText(label, manner.label);
      showText(unit, manner.unit);
      const value = valueAt(design, path);
      // What is being typed stays as it is typed.
      const isHere = document.activeElement === input && readEntry(field, input.value, manner.factor).entry === value;
      if (!isHere) input.value = shownEntry(value, manner.factor);
      const message = messages.get(path);
      const factor = told.factor ?? factorOf(units, message?.design ?? design, field);
      own = message && inWords(message, factor);
      showMessage(input, box, own);
    },
  };
}
