// @ts-check
// Jogging while a button is held, running at a speed, and saying where an axis is.

import { element, icon } from '../../dom.js';
import { memory } from '../../memory.js';
import { shownValue } from '../../units.js';
import { plainField } from './plain_field.js';
import { quantityField } from './quantity.js';
import { named, showAtPlaces } from './refusal.js';
import { able, can } from './section.js';

/** @typedef {import('../../types.js').Device} Device */
/** @typedef {import('./section.js').Context} Context */

/** A part of the slew speed that is slow enough to be looked at. */
const FIRST_PART_OF_SLEW = 0.25;
const WHOLE_DIAL_STEPS = 945;

/**
 * @param {{begin: (device: Device, axis: number, speed: unknown) => void, end: () => void}} jog
 * @param {{go: (device: Device, axis: number, what: 'run' | 'zero', body: unknown) => void,
 *   setPosition: (device: Device, axis: number, steps: unknown) => void}} handlers
 */
export function createJogSection(jog, handlers) {
  /** @type {Context | null} */
  let context = null;
  const speed = quantityField({ id: 'jog-speed', label: 'Speed', quantity: 'speed', start: '' });
  const seconds = plainField({
    id: 'run-for',
    label: 'How long a run lasts',
    unit: 's',
    value: memory.runSeconds(),
    onChange: memory.keepRunSeconds,
  });
  const [speedProblem, secondsProblem, placeProblem, dialProblem] = Array.from({ length: 4 }, () =>
    element('div', { className: 'problem' }),
  );
  const place = quantityField({ id: 'set-position', label: 'Position of this place', quantity: 'length', start: 0 });
  const dial = quantityField({ id: 'zero-steps', label: 'Whole range', quantity: 'length', start: WHOLE_DIAL_STEPS });
  const back = holdButton(-1, 'Jog backwards while held', 'left');
  const ahead = holdButton(1, 'Jog forwards while held', 'right');
  const runBack = button('run-back', 'Run back', () => run(-1));
  const runAhead = button('run-ahead', 'Run ahead', () => run(1));
  const set = button('set-position-button', 'Set', () => withDevice((one, axis) => handlers.setPosition(one, axis, place.value())));
  const zero = button('zero', 'Zero', () =>
    withDevice((one, axis) => handlers.go(one, axis, 'zero', { axes: [axis], steps: dial.value() })),
  );
  const reason = element('p', { className: 'reason', id: 'jog-reason' });
  const placeReason = element('p', { className: 'reason', id: 'place-reason' });

  /** @param {(device: Device, axis: number) => void} act */
  function withDevice(act) {
    if (context?.device) act(context.device, context.axis);
  }

  /** The speed with the sign of a direction; text stays as it is, and the server says what is wrong with it.
   * @param {1 | -1} direction */
  function signed(direction) {
    const value = speed.value();
    return typeof value === 'number' ? value * direction : value;
  }

  /** @param {1 | -1} direction */
  function run(direction) {
    withDevice((device, axis) =>
      handlers.go(device, axis, 'run', {
        axes: [{ axis, speed_steps_per_s: signed(direction) }],
        for_s: seconds.value(),
      }),
    );
  }

  /** Runs while it is pressed, by pointer or by key; whatever takes the press away ends it.
   * @param {1 | -1} direction @param {string} label @param {'left' | 'right'} drawing */
  function holdButton(direction, label, drawing) {
    const held = element(
      'button',
      { className: 'button hold', type: 'button', 'aria-label': label, 'aria-describedby': 'jog-reason' },
      drawing === 'left' && icon('left'),
      element('span', { textContent: 'Hold' }),
      drawing === 'right' && icon('right'),
    );
    held.id = `jog-${drawing}`;
    const begin = () => {
      if (held.disabled) return;
      held.dataset.held = '';
      withDevice((device, axis) => jog.begin(device, axis, signed(direction)));
    };
    const end = () => {
      if (!('held' in held.dataset)) return;
      delete held.dataset.held;
      jog.end();
    };
    held.addEventListener('pointerdown', (event) => {
      if (event.button !== 0) return;
      held.setPointerCapture(event.pointerId);
      begin();
    });
    for (const name of ['pointerup', 'pointercancel', 'lostpointercapture', 'blur']) held.addEventListener(name, end);
    held.addEventListener('contextmenu', (event) => event.preventDefault());
    held.addEventListener('keydown', (event) => {
      if (event.key === 'Escape') end();
      if (event.key !== ' ' && event.key !== 'Enter') return;
      event.preventDefault();
      if (!event.repeat) begin();
    });
    held.addEventListener('keyup', end);
    return held;
  }

  const gauge = labelled('Gauge', dial.element, zero);
  const gaugeExplained = element('p', {
    className: 'reason',
    textContent: 'Zero moves a gauge back by its whole range, against its stop.',
  });

  return {
    element: element(
      'div',
      { className: 'section' },
      labelled('Speed', speed.element),
      speedProblem,
      element('div', { className: 'line hold-line' }, back, ahead),
      element('div', { className: 'line run-line' }, runBack, runAhead, element('span', { textContent: 'for' }), seconds.element),
      secondsProblem,
      reason,
      element('p', {
        className: 'reason',
        id: 'run-explained',
        textContent: 'A run slows down after that, or when this page is closed. Run again in time, and it goes on.',
      }),
      element('div', { className: 'separator' }),
      labelled('It is at', place.element, set),
      placeProblem,
      gauge,
      dialProblem,
      placeReason,
      element('p', { className: 'reason', textContent: 'Set says what this place is called.' }),
      gaugeExplained,
    ),
    /** @param {Context} present */
    show(present) {
      context = present;
      const { device, known, situation, design, inTheWay, notAtRest } = present;
      if (speed.value() === '' && speed.input !== document.activeElement) {
        const slew = Number(design.ramp.slew_speed_steps_per_s);
        if (slew > 0) speed.set(Number(shownValue({ length: 'steps', time: 's' }, design, 'speed', slew * FIRST_PART_OF_SLEW).toPrecision(3)));
      }
      speed.show(situation.units, design);
      place.show(situation.units, design);
      dial.show(situation.units, design);
      const noRamp = device && !device.ramp ? 'Push a ramp first.' : '';
      const isHeld = 'held' in back.dataset || 'held' in ahead.dataset;
      able([runBack, runAhead], reason, inTheWay || noRamp, situation.isBusy);
      if (!isHeld) able([back, ahead], reason, inTheWay || noRamp, situation.isBusy);
      for (const one of [gauge, gaugeExplained]) one.hidden = !can(known, 'zero');
      able([set, zero], placeReason, inTheWay || notAtRest || noRamp, situation.isBusy);
      if (placeReason.textContent === reason.textContent) placeReason.hidden = true;
    },
    /** @param {import('../../types.js').Rejection[]} rejections */
    reject: (rejections) =>
      showAtPlaces(rejections, [
        {
          path: /(^|\.)speed_steps_per_s$/,
          input: speed.input,
          problem: speedProblem,
          text: (one) => speed.refusal(one, 'Speed'),
        },
        { path: /^for_s$/, input: seconds.input, problem: secondsProblem, text: (one) => named(one, 'The time') },
        {
          path: /(^|\.)position_steps$/,
          input: place.input,
          problem: placeProblem,
          text: (one) => place.refusal(one, 'Position'),
        },
        { path: /^steps$/, input: dial.input, problem: dialProblem, text: (one) => dial.refusal(one, 'Range') },
      ]),
  };
}

/** @param {string} id @param {string} textContent @param {() => void} onclick */
function button(id, textContent, onclick) {
  return element('button', { className: 'button', id, type: 'button', textContent, onclick });
}

/** @param {string} text @param {...HTMLElement} parts */
function labelled(text, ...parts) {
  return element('div', { className: 'line labelled' }, element('span', { textContent: text }), ...parts);
}
