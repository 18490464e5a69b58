// @ts-check
// One parameter: its name, a number that can be typed, and a slider. What is typed is passed on as it was typed; only
// the slider has a reach.

import { valueAt } from '../../design.js';
import { element, icon, picker, showMessage } from '../../dom.js';
import { SLIDER_POSITIONS, sliderPosition, sliderValue } from '../../fields.js';
import { formatEntry, parseEntry } from '../../numbers.js';

/** @typedef {import('../../types.js').Design} Design */

// The one parameter that may be left open: it then follows another.
const FOLLOWERS = /** @type {Record<string, string>} */ ({
  'ramp.deceleration_steps_per_s2': 'ramp.acceleration_steps_per_s2',
});
const TRAVEL = 'axis.travel_per_rev';

/**
 * @param {import('../../fields.js').Field} field
 * @param {{onEdit: (path: string, value: unknown) => void, onSliding: (isMoving: boolean) => void}} handlers
 */
export function createNumber(field, { onEdit, onSliding }) {
  const leader = FOLLOWERS[field.path];
  const id = `parameter-${field.path.replaceAll('.', '-')}`;
  /** @type {Design | null} */
  let shown = null;

  const input = element('input', {
    id,
    className: 'number',
    inputMode: 'decimal',
    autocomplete: 'off',
    spellcheck: false,
    oninput: typed,
    onblur: () => shown && show(shown),
  });
  const slider = element('input', {
    className: 'slider',
    type: 'range',
    min: '0',
    max: String(SLIDER_POSITIONS),
    step: 'any',
    'aria-label': `${field.label}, slider`,
    oninput: slid,
    onchange: () => onSliding(false),
    onkeydown: nudged,
  });
  const unit = field.path === TRAVEL ? picker('Travel unit', (value) => onEdit('axis.travel_unit', value)) : null;
  unit?.element.classList.add('quiet');
  const follow =
    leader === undefined
      ? null
      : element(
          'button',
          {
            className: 'follow',
            type: 'button',
            'aria-label': `${field.label} follows the acceleration`,
            title: 'Follow the acceleration',
            onclick: toggleFollow,
          },
          icon('link'),
        );
  const box = element('div', { className: 'messages' });
  const label = element(
    'label',
    { htmlFor: id },
    field.label,
    field.symbol !== '' && element('i', { textContent: field.symbol }),
  );
  const row = element(
    'div',
    { className: 'parameter', 'data-path': field.path },
    element('div', { className: 'name' }, label, follow),
    element(
      'span',
      { className: 'field' },
      input,
      unit?.element ?? element('span', { className: 'unit', textContent: field.unit }),
    ),
    slider,
    box,
  );

  function typed() {
    const entry = parseEntry(input.value);
    onEdit(field.path, leader !== undefined && entry === '' ? null : entry);
  }

  function slid() {
    onSliding(true);
    onEdit(field.path, sliderValue(field.slider, Number(slider.value), Number(current())));
  }

  /** Arrow keys move by what can be told apart: one for whole numbers, about one per cent of the way else.
   * @param {KeyboardEvent} event */
  function nudged(event) {
    const direction = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1 }[event.key];
    if (direction === undefined) return;
    event.preventDefault();
    const { scale, figures } = field.slider;
    const before = Number(current());
    const next = sliderValue(
      field.slider,
      Math.min(SLIDER_POSITIONS, Math.max(0, Number(slider.value) + direction * (event.shiftKey ? 50 : 10))),
      before,
    );
    const isStuck = figures === 0 && (scale === 'linear' || next === before);
    const whole = Math.min(
      field.slider.to,
      Math.max(field.slider.from, Math.abs(before) + direction * (event.shiftKey ? 10 : 1)),
    );
    onEdit(field.path, isStuck ? whole : next);
  }

  function toggleFollow() {
    if (shown === null || leader === undefined) return;
    onEdit(field.path, valueAt(shown, field.path) === null ? valueAt(shown, leader) : null);
  }

  /** The value that holds, its own or the one it follows. */
  function current() {
    if (shown === null) return 0;
    const own = valueAt(shown, field.path);
    return own === null && leader !== undefined ? valueAt(shown, leader) : own;
  }

  /** @param {Design} design */
  function show(design) {
    shown = design;
    const own = valueAt(design, field.path);
    const isOpen = own === null && leader !== undefined;
    // What is being typed stays as it is typed: "1." must not turn into "1" under the hand.
    const isTyping =
      document.activeElement === input && (isOpen ? input.value.trim() === '' : parseEntry(input.value) === own);
    if (!isTyping) input.value = isOpen ? '' : formatEntry(own);
    const value = Number(current());
    input.placeholder = isOpen ? formatEntry(current()) : '';
    row.classList.toggle('follows', isOpen);
    follow?.setAttribute('aria-pressed', String(isOpen));
    unit?.offer(
      [
        ['mm', 'mm'],
        ['deg', 'deg'],
      ],
      design.axis.travel_unit,
    );
    if (Number.isFinite(value)) {
      const position = sliderPosition(field.slider, value);
      slider.value = String(position);
      slider.style.setProperty('--filled', `${((position / SLIDER_POSITIONS) * 100).toFixed(2)}%`);
    }
    slider.setAttribute('aria-valuetext', `${formatEntry(current())} ${unit ? design.axis.travel_unit : field.unit}`);
  }

  return {
    field,
    element: row,
    show,
    /** @param {import('../../messages.js').Messages['fields']} messages */
    showMessage(messages) {
      showMessage(input, box, messages.get(field.path) ?? (unit ? messages.get('axis.travel_unit') : undefined));
    },
  };
}
