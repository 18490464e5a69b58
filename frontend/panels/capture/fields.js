// @ts-check
// What is taken of a captured file: channels, edge, move, alignment, and what is too short or too long.

import { refusalText } from '../../model/messages.js';
import { counted, formatEntry, formatFigures, formatFixed, parseEntry } from '../../model/numbers.js';
import { element, picker, segmented, showMessage } from '../../ui/dom.js';

/** @typedef {import('../../model/types.js').CaptureWish} CaptureWish */
/** @typedef {import('../../model/types.js').Captured} Captured */
/** @typedef {import('../../app/state.js').Capture} Capture */

/** @type {[NonNullable<CaptureWish['edge']>, string][]} */
const EDGES = [
  ['rising', 'Rising'],
  ['falling', 'Falling'],
  ['both', 'Both'],
];
/** @type {[CaptureWish['alignment'], string][]} */
const ALIGNMENTS = [
  ['first_step', 'First step'],
  ['best_fit', 'Best fit'],
];
/** The likeliest; no channel is called so. */
const AUTOMATIC = '\0';

/** @param {(wanted: Partial<CaptureWish>) => void} onWish */
export function createCaptureFields(onWish) {
  const step = picker('Step channel', (value) => onWish({ step_channel: value }));
  const direction = picker('Direction channel', (value) => onWish({ direction_channel: value }));
  const edge = segmented('Edge', EDGES, (value) => onWish({ edge: value }));
  const move = picker('Move', (value) => onWish({ move_number: value === AUTOMATIC ? null : Number(value) }));
  const alignment = segmented('Align by', ALIGNMENTS, (value) => onWish({ alignment: value }));
  const beyond = entry('capture-move-number', '', (value) => onWish({ move_number: value }));
  const shortest = entry('capture-shortest', 'none', (value) => onWish({ shortest_pulse_us: value }));
  const longest = entry('capture-longest', 'as the design', (value) => onWish({ longest_wait_us: value }));
  step.select.id = 'capture-step';
  direction.select.id = 'capture-direction';
  move.select.id = 'capture-move';
  edge.element.id = 'capture-edge';
  alignment.element.id = 'capture-alignment';
  for (const one of [edge, alignment]) one.element.classList.add('fill');
  const fields = [
    { name: 'step_channel', label: 'Step channel', control: step.element, marked: step.select },
    { name: 'edge', label: 'Edge', control: edge.element, marked: edge.element },
    { name: 'direction_channel', label: 'Direction channel', control: direction.element, marked: direction.select },
    { name: 'longest_wait_us', label: 'Longest wait', control: longest.element, marked: longest.input },
    {
      name: 'move_number',
      label: 'Move',
      control: element('span', { className: 'capture-move' }, move.element, beyond.element),
      marked: move.select,
    },
    { name: 'shortest_pulse_us', label: 'Shortest pulse', control: shortest.element, marked: shortest.input },
    { name: 'alignment', label: 'Align by', control: alignment.element, marked: alignment.element },
  ].map((field) => ({ ...field, problem: element('div', { className: 'capture-problem' }) }));

  longest.input.title = 'A longer wait is between two moves';
  shortest.input.title = 'Shorter pulses are marked: a driver may miss them';

  /** @param {Captured} answer @param {CaptureWish} wish */
  function offer(answer, wish) {
    const channels = answer.channels.map(({ name, edges }) => /** @type {[string, string]} */ ([name, `${name} (${counted(edges, 'edge')})`]));
    step.offer(channels, wish.step_channel ?? answer.step_channel);
    direction.offer([['', 'none'], ...channels], wish.direction_channel ?? answer.direction_channel ?? '');
    edge.press(wish.edge ?? answer.edge);
    alignment.press(wish.alignment);
    const own = answer.move ? `Nearest to the design: ${answer.move.move}` : 'None';
    const listed = answer.moves.map((one) => /** @type {[string, string]} */ ([String(one.move), moveText(one)]));
    const chosen = String(wish.move_number ?? AUTOMATIC);
    const isListed = wish.move_number === null || listed.some(([number]) => number === chosen);
    const moves = isListed ? listed : [...listed, /** @type {[string, string]} */ ([chosen, `Move ${chosen}`])];
    move.offer([[AUTOMATIC, wish.move_number === null ? own : 'Nearest to the design'], ...moves], chosen);
    const more = answer.move_count - answer.moves.length;
    beyond.element.hidden = more <= 0;
    beyond.input.placeholder = `or its number, up to ${formatFixed(answer.move_count)}`;
    beyond.show(isListed ? null : wish.move_number);
    shortest.show(wish.shortest_pulse_us);
    longest.show(wish.longest_wait_us);
    longest.input.placeholder = formatEntry(Number(answer.longest_wait_us.toPrecision(6)));
  }

  return {
    element: element(
      'div',
      { className: 'capture-fields' },
      ...fields.map(({ label, control, problem }) =>
        element('div', { className: 'capture-field' }, element('span', { className: 'muted', textContent: label }), control, problem),
      ),
    ),
    /** Show what is taken, and what is refused of it.
     * @param {Capture} capture @returns {string[]} what is refused otherwise */
    show({ answer, wish, stage, rejections }) {
      if (answer) offer(answer, wish);
      const refused = stage === 'refused' ? rejections : [];
      for (const { name, label, marked, problem } of fields) {
        const found = answer && refused.find(({ field }) => field === name);
        showMessage(marked, problem, found ? { text: refusalText(found, label), isWarning: false } : undefined);
      }
      const others = refused.filter(({ field }) => answer === null || !fields.some(({ name }) => name === field));
      return others.map(({ message }) => message);
    },
  };
}

/** @param {import('../../model/types.js').CapturedMove} move */
function moveText({ move, steps, begin_s, direction_level }) {
  // Which way that is, only the wiring knows.
  const direction = direction_level === null ? '' : `, direction ${direction_level ? 'high' : 'low'}`;
  return `${formatFixed(move)}: ${counted(steps, 'step')} at ${formatFigures(begin_s)} s${direction}`;
}

/** What the entries are called to those who don't see them, and their unit. */
const ENTRIES = {
  'capture-shortest': { label: 'Shortest pulse, µs', unit: 'µs' },
  'capture-longest': { label: 'Longest wait, µs', unit: 'µs' },
  'capture-move-number': { label: 'Number of the move', unit: '' },
};

/** A field for a number that may be empty.
 * @param {keyof typeof ENTRIES} id @param {string} placeholder
 * @param {(value: import('../../model/types.js').Entry | null) => void} onValue */
function entry(id, placeholder, onValue) {
  const { label, unit } = ENTRIES[id];
  const input = element('input', {
    id,
    placeholder,
    inputMode: 'decimal',
    autocomplete: 'off',
    'aria-label': label,
    // Once it is finished: each answer needs the whole file.
    onchange: () => onValue(input.value.trim() === '' ? null : parseEntry(input.value)),
  });
  return {
    input,
    element: element('span', { className: 'field' }, input, element('span', { className: 'unit', textContent: unit })),
    /** @param {import('../../model/types.js').Entry | null} value */
    show(value) {
      const text = value === null ? '' : formatEntry(value);
      if (input !== document.activeElement && input.value !== text) input.value = text;
    },
  };
}
