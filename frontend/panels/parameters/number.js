// @ts-check
// One parameter: its name, a number that can be typed, and a slider. What is typed is passed on as it was typed; only
// the slider has a reach. It is shown in the unit that is chosen; the design stays in its own.

import { valueAt } from '../../model/design.js';
import { element, icon, picker, showMessage } from '../../ui/dom.js';
import { selectOnFocus } from '../../ui/select_on_focus.js';
import { formatEntry } from '../../model/numbers.js';
import { inShownUnit } from '../../model/rejection_text.js';
import { factorOf, isNothing, readEntry, roundingText, shownEntry, tooShortText, unitOf } from '../../model/shown_entry.js';
import { SLIDER_POSITIONS, sliderPosition, sliderValue, stepped } from './stepping.js';
import { watchWheel } from './wheel.js';

/** @typedef {import('../../model/types.js').Design} Design */
/** @typedef {import('../../model/types.js').Entry} Entry */
/** @typedef {import('../../model/units.js').Units} Units */
/** @typedef {import('./stepping.js').Stride} Stride */
/** @typedef {{onEdit: (path: string, value: unknown, gesture?: string) => void,
 *   onSlid: () => void}} Handlers  onSlid: a slider was let go */

// The parameters that may be left open: each then follows another.
const FOLLOWERS = /** @type {Record<string, string>} */ ({
  'ramp.deceleration_steps_per_s2': 'ramp.acceleration_steps_per_s2',
  'ramp.shape.deceleration_jerk_steps_per_s3': 'ramp.shape.jerk_steps_per_s3',
});
const TRAVEL = 'axis.travel_per_rev';
/** @type {Record<string, [1 | -1, Stride | null]>} */
const STEP_KEYS = { ArrowUp: [1, null], ArrowDown: [-1, null], PageUp: [1, 'coarse'], PageDown: [-1, 'coarse'] };
/** In a field these move the caret.
 * @type {typeof STEP_KEYS} */
const SLIDER_KEYS = { ...STEP_KEYS, ArrowRight: [1, null], ArrowLeft: [-1, null] };
const END_KEYS = /** @type {Record<string, number>} */ ({ Home: 0, End: SLIDER_POSITIONS });

/** @param {import('../../model/fields.js').Field} field @param {Handlers} handlers */
export function createNumber(field, { onEdit, onSlid }) {
  const { path } = field;
  const leader = FOLLOWERS[path];
  const mayBeOpen = leader !== undefined || field.usual !== undefined;
  /** What says that it is left open: what follows another says so, all else says nothing. */
  const open = leader === undefined ? undefined : null;
  /** @type {{design: Design, units: Units, factor: number} | null} */
  let shown = null;
  /** What was typed last, to be shown again as it was typed.
   * @type {{text: string, entry: Entry, exact: number | null, factor: number} | null} */
  let typed = null;
  /** What is said of it, in the server's units.
   * @type {import('../../model/messages.js').Message | undefined} */
  let message;

  const parts = buildRow(field, mayBeOpen, (unit) => onEdit('axis.travel_unit', unit));
  const { input, slider, note } = parts;
  selectOnFocus(input);
  input.addEventListener('input', type);
  input.addEventListener('blur', () => showText());
  input.addEventListener('keydown', (event) => pressed(event, STEP_KEYS, step));
  slider.addEventListener('input', slide);
  slider.addEventListener('change', onSlid);
  // One that comes back to where it was taken up tells no change.
  slider.addEventListener('pointerdown', () => {
    for (const name of ['pointerup', 'pointercancel']) addEventListener(name, onSlid, { capture: true, once: true });
  });
  slider.addEventListener('keydown', (event) => pressed(event, SLIDER_KEYS, stepSlider));
  parts.follow?.addEventListener('click', toggleFollow);
  const hasFocus = () => document.activeElement === input || document.activeElement === slider;
  watchWheel(input, hasFocus, (direction, event) => step(direction, strideOf(event)));
  watchWheel(slider, hasFocus, (direction, event) => stepSlider(direction, strideOf(event)));

  function type() {
    if (shown === null) return;
    const { design, units, factor } = shown;
    const { entry, exact } = readEntry(field, input.value, factor);
    typed = { text: input.value, entry, exact, factor };
    const between = betweenSteps();
    note.textContent = between === null ? '' : roundingText(between, Number(entry), unitOf(units, design, field), factor);
    onEdit(path, mayBeOpen && entry === '' ? open : entry, `type:${path}`);
    // Nothing is asked anew where another text becomes the same steps.
    tell();
  }

  function slide() {
    if (shown === null) return;
    onEdit(path, sliderValue(field, Number(slider.value), Number(current()), shown.factor), `slide:${path}`);
  }

  /** @param {KeyboardEvent} event @param {typeof STEP_KEYS} keys @param {typeof step} toNext */
  function pressed(event, keys, toNext) {
    if (event.ctrlKey || event.metaKey) return;
    const end = keys === SLIDER_KEYS ? END_KEYS[event.key] : undefined;
    const [direction, stride] = keys[event.key] ?? [null, null];
    if (end === undefined && direction === null) return;
    event.preventDefault();
    if (end !== undefined) onEdit(path, sliderValue(field, end, Number(current())), `step:${path}`);
    else if (direction !== null) toNext(direction, stride ?? strideOf(event));
  }

  /** Text that is no number has no neighbour: it stays.
   * @param {1 | -1} direction @param {Stride} stride */
  function step(direction, stride) {
    const value = Number(current());
    if (shown === null || !Number.isFinite(value)) return;
    onEdit(path, stepped(field, value, direction, stride, shown.factor), `step:${path}`);
  }

  /** A slider has no sign: it moves away from 0 and back towards it, and ends there.
   * @param {1 | -1} direction @param {Stride} stride */
  function stepSlider(direction, stride) {
    const value = Number(current());
    if (shown === null || !Number.isFinite(value)) return;
    const next = stepped(field, Math.abs(value), direction, stride, shown.factor);
    if (next >= 0) onEdit(path, value < 0 ? -next : next, `step:${path}`);
  }

  function toggleFollow() {
    if (shown === null) return;
    onEdit(path, ownOf(shown.design) === null ? openValue(shown.design) : open);
  }

  /** The value that holds, its own or what stands for it.
   * @returns {Entry} */
  function current() {
    if (shown === null) return 0;
    return ownOf(shown.design) ?? openValue(shown.design);
  }

  /** What holds while it is left open: the one that it follows, or a usual one.
   * @param {Design} design @returns {Entry} */
  function openValue(design) {
    return leader === undefined ? (field.usual?.(design) ?? '') : valueAt(design, leader);
  }

  /** What the design has here; null where it is left open, or left out.
   * @param {Design} design @returns {Entry | null} */
  function ownOf(design) {
    return valueAt(design, path) ?? null;
  }

  /** What is typed, where it is no whole number of steps.
   * @returns {import('../../model/shown_entry.js').Between | null} */
  function betweenSteps() {
    return typed === null || typed.exact === null ? null : { text: typed.text.trim(), exact: typed.exact };
  }

  /** What is refused, in the unit that is shown; as it was typed, where nothing is left of that. */
  function told() {
    if (shown === null) return undefined;
    const { design, units, factor } = shown;
    const between = typed?.factor === factor && Number(typed.entry) === 0 ? betweenSteps() : null;
    if (message === undefined || between === null || !isNothing(message.refused)) return inShownUnit(message, units, design, field);
    return { ...message, text: tooShortText(between, unitOf(units, design, field), factor) };
  }

  function tell() {
    const own = told();
    // What is refused says what it was taken for.
    note.hidden = own !== undefined && !own.isWarning;
    showMessage(input, parts.box, own);
  }

  function showText() {
    if (shown === null) return;
    const { design, factor } = shown;
    const own = ownOf(design);
    const isOpen = own === null && mayBeOpen;
    const isAsTyped = typed !== null && typed.entry === own && typed.factor === factor;
    if (!isAsTyped) note.textContent = '';
    input.placeholder = isOpen ? shownEntry(current(), factor) : '';
    // What is being typed stays as it is typed: "1." must not turn into "1" under the hand.
    const isHere = document.activeElement === input;
    if (isHere && (isOpen ? input.value.trim() === '' : readEntry(field, input.value, factor).entry === own)) return;
    const isKept = isAsTyped && typed !== null && note.textContent === '';
    const value = isKept ? readEntry({ ...field, isWhole: false }, typed?.text ?? '', 1).entry : null;
    input.value = isOpen || own === null ? '' : value === null ? shownEntry(own, factor) : formatEntry(value);
  }

  function showSlider() {
    if (shown === null) return;
    const value = Number(current());
    if (Number.isFinite(value)) {
      const position = sliderPosition(field.slider, value);
      slider.value = String(position);
      slider.style.setProperty('--filled', `${((position / SLIDER_POSITIONS) * 100).toFixed(2)}%`);
    }
    slider.setAttribute('aria-valuetext', `${shownEntry(current(), shown.factor)} ${unitText()}`);
  }

  function unitText() {
    if (shown === null) return '';
    return path === TRAVEL ? shown.design.axis.travel_unit : unitOf(shown.units, shown.design, field);
  }

  return {
    field,
    element: parts.row,
    label: parts.label,
    /** @param {Design} design @param {Units} units */
    show(design, units) {
      const before = shown && JSON.stringify([valueAt(shown.design, path), current(), shown.factor, unitText()]);
      shown = { design, units, factor: factorOf(units, design, field) };
      const now = JSON.stringify([valueAt(design, path), current(), shown.factor, unitText()]);
      // A slider under the hand changes one number of many, many times a second.
      if (now === before && !hasFocus()) return;
      const isOpen = mayBeOpen && ownOf(design) === null;
      parts.row.classList.toggle('follows', isOpen);
      parts.follow?.setAttribute('aria-pressed', String(isOpen));
      parts.showUnit(unitText());
      showText();
      showSlider();
    },
    /** @param {import('../../model/messages.js').Messages['fields']} messages */
    showMessage(messages) {
      message = messages.get(path) ?? (path === TRAVEL ? messages.get('axis.travel_unit') : undefined);
      tell();
    },
  };
}

/** @param {MouseEvent | KeyboardEvent} event @returns {Stride} */
function strideOf({ shiftKey, altKey }) {
  return shiftKey ? 'coarse' : altKey ? 'fine' : 'usual';
}

/**
 * The elements of a row.
 * @param {import('../../model/fields.js').Field} field
 * @param {boolean} canFollow
 * @param {(unit: string) => void} onTravelUnit
 */
function buildRow(field, canFollow, onTravelUnit) {
  const id = `parameter-${field.path.replaceAll('.', '-')}`;
  const input = element('input', {
    id,
    className: 'number',
    inputMode: 'decimal',
    autocomplete: 'off',
    spellcheck: false,
    'aria-description': field.help,
  });
  const slider = element('input', {
    className: 'slider',
    type: 'range',
    min: '0',
    max: String(SLIDER_POSITIONS),
    // Until a number is known it stands where its track begins, not where a browser puts it.
    value: '0',
    step: 'any',
    'aria-label': `${field.label}, slider`,
  });
  const travelUnit = field.path === TRAVEL ? picker('Travel unit', onTravelUnit) : null;
  travelUnit?.element.classList.add('quiet');
  const unit = element('span', { className: 'unit' });
  const follow = canFollow ? followButton(field) : null;
  const box = element('div', { className: 'messages' });
  const note = element('p', { className: 'note', role: 'status' });
  const symbol = field.symbol !== '' && element('i', { textContent: field.symbol });
  const label = element('label', { htmlFor: id }, field.label, symbol);
  const row = element(
    'div',
    { className: 'parameter', 'data-path': field.path },
    element('div', { className: 'name' }, label, follow),
    element('span', { className: 'field' }, input, travelUnit?.element ?? unit),
    slider,
    element('div', { className: 'remarks' }, note, box),
  );
  return {
    row,
    label,
    input,
    slider,
    follow,
    box,
    note,
    /** @param {string} word */
    showUnit(word) {
      unit.textContent = word;
      travelUnit?.offer(
        [
          ['mm', 'mm'],
          ['deg', 'deg'],
        ],
        word,
      );
    },
  };
}

/** @param {import('../../model/fields.js').Field} field */
function followButton({ label, quantity, usual }) {
  return element(
    'button',
    {
      className: 'follow',
      type: 'button',
      'aria-label': usual ? `${label} is left open` : `${label} follows the ${quantity}`,
      title: usual ? 'Left open: the usual value stands for it' : `Follow the ${quantity}`,
    },
    icon('link'),
  );
}
