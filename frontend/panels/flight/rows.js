// @ts-check
// What the motor is told, one row each: when, and a target or a speed.

import { refusalText } from '../../model/messages.js';
import { inUnit } from '../../model/rejection_text.js';
import { MS_PER_S } from '../../model/flight.js';
import { closeButton, element, picker } from '../../ui/dom.js';
import { plainField } from '../../ui/plain_field.js';
import { quantityField } from '../../ui/quantity_field.js';
import { showAtPlaces } from '../../ui/refusal.js';

/** @typedef {import('../../model/flight.js').Told} Told */
/** @typedef {import('../../model/types.js').Design} Design */
/** @typedef {import('../../model/types.js').Rejection} Rejection */
/** @typedef {import('../../model/units.js').Units} Units */
/** @typedef {ReturnType<typeof createRow>} Row */

/** @type {[Told['kind'], string][]} */
const KINDS = [
  ['target', 'go to'],
  ['speed', 'go on with'],
];
const NAMES = { target: 'Target', speed: 'Speed' };
const BACKWARDS = 'Negative: backwards; 0: slow down to rest';

/** @param {() => void} onChange */
export function createRows(onChange) {
  /** @type {Row[]} */
  let rows = [];
  /** Of all rows that there were: ids are not given twice. */
  let made = 0;
  /** @type {[Units, Design] | null} */
  let shown = null;
  const list = element('ol', { className: 'flight-rows', id: 'flight-rows' });

  /** @param {Told} told */
  function add(told) {
    const row = createRow(made, told, {
      onChange,
      onRemove() {
        const place = rows.indexOf(row);
        rows = rows.filter((one) => one !== row);
        arrange();
        rows[Math.min(place, rows.length - 1)].input.focus();
        onChange();
      },
    });
    made += 1;
    rows.push(row);
    if (shown) row.show(...shown);
    arrange();
    return row;
  }

  function arrange() {
    list.replaceChildren(...rows.map(({ element: item }) => item));
    rows.forEach((row, at) => row.number(at + 1, rows.length === 1));
  }

  return {
    element: list,
    told: () => rows.map((row) => row.told()),
    add,
    /** @param {Told[]} told */
    set(told) {
      rows = [];
      for (const one of told) add(one);
    },
    /** @param {Units} units @param {Design} design */
    show(units, design) {
      shown = [units, design];
      for (const row of rows) row.show(units, design);
    },
    /** Say at their rows what was refused.
     * @param {Rejection[]} rejections @returns {Rejection[]} those of no row */
    reject: (rejections) => showAtPlaces(rejections, rows.flatMap((row, at) => row.places(at))),
  };
}

/** @param {number} id @param {Told} first @param {{onChange: () => void, onRemove: () => void}} handlers */
function createRow(id, first, { onChange, onRemove }) {
  let kind = first.kind;
  const time = plainField({ id: `flight-time-${id}`, label: 'Time', unit: 'ms', value: String(first.atMs) });
  const values = {
    target: quantityField({ id: `flight-target-${id}`, label: 'Target', quantity: 'length', start: first.kind === 'target' ? first.value : 0 }),
    speed: quantityField({ id: `flight-speed-${id}`, label: 'Speed', quantity: 'speed', start: first.kind === 'speed' ? first.value : 0 }),
  };
  values.speed.input.title = BACKWARDS;
  const kinds = picker('What the motor is told', (value) => {
    kind = /** @type {Told['kind']} */ (value);
    arrange();
    onChange();
  });
  const remove = closeButton('Remove', onRemove);
  const problems = { time: element('div', { className: 'problem' }), value: element('div', { className: 'problem' }) };
  const boxes = [time.element, values.target.element, values.speed.element];
  for (const box of boxes) box.addEventListener('input', onChange);
  const item = element(
    'li',
    { className: 'flight-row' },
    element('span', { className: 'muted', textContent: 'At' }),
    ...[time.element, kinds.element, values.target.element, values.speed.element, remove, problems.time, problems.value],
  );

  function arrange() {
    kinds.offer(KINDS, kind);
    for (const [name] of KINDS) values[name].element.hidden = name !== kind;
  }
  arrange();

  return {
    element: item,
    input: time.input,
    /** @returns {Told} */
    told: () => ({ atMs: time.value(), kind, value: values[kind].value() }),
    /** @param {number} place from 1 @param {boolean} isAlone the last one can't be removed */
    number(place, isAlone) {
      time.input.setAttribute('aria-label', `Time of command ${place}`);
      kinds.select.setAttribute('aria-label', `What command ${place} is`);
      for (const [name] of KINDS) values[name].input.setAttribute('aria-label', `${NAMES[name]} of command ${place}`);
      remove.setAttribute('aria-label', `Remove command ${place}`);
      remove.disabled = isAlone;
    },
    /** @param {Units} units @param {Design} design */
    show(units, design) {
      for (const [name] of KINDS) values[name].show(units, design);
    },
    /** @param {number} at place from 0 */
    places: (at) => [
      { path: new RegExp(`^commands\\.${at}\\.at_s$`), input: time.input, problem: problems.time, text: timeText },
      {
        path: new RegExp(`^commands\\.${at}\\.(?:target_steps|speed_steps_per_s)$`),
        input: values[kind].input,
        problem: problems.value,
        text: (/** @type {Rejection} */ rejection) => values[kind].refusal(rejection, NAMES[kind]),
      },
    ],
  };
}

/** @param {Rejection} refused */
function timeText(refused) {
  const label = 'Time';
  return inUnit({ text: refusalText(refused, label), isWarning: false, refused }, { label }, 'ms', MS_PER_S).text;
}
