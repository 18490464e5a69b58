// @ts-check
// Jogging while a button is held, running at a speed, and saying where an axis is.

import { directedSpeed, ofUndirected } from '../../devices/directed_speed.js';
import { element, icon, showText } from '../../ui/dom.js';
import { memory } from '../../documents/memory.js';
import { shownValue } from '../../model/units.js';
import { refusalText } from '../../model/messages.js';
import { plainField } from '../../ui/plain_field.js';
import { quantityField } from '../../ui/quantity_field.js';
import { showAtPlaces } from '../../ui/refusal.js';
import { able, can, scaleText } from './section.js';

/** @typedef {import('../../model/types.js').Device} Device */
/** @typedef {import('./section.js').Context} Context */

/** A part of the slew speed that is slow enough to be looked at. */
const FIRST_PART_OF_SLEW = 0.25;
const WHOLE_DIAL_STEPS = 945;

/**
 * @param {{begin: (device: Device, axis: number, speed: unknown) => void, end: () => void}} jog
 * @param {{go: (device: Device, axis: number, what: 'run' | 'zero', body: unknown) => void,
 *   setPosition: (device: Device, axis: number, steps: unknown) => void,
 *   refuse: (rejections: import('../../model/types.js').Rejection[]) => void}} handlers
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
  const place = quantityField({ id: 'set-position', label: 'Current position', quantity: 'length', start: 0 });
  const dial = quantityField({ id: 'zero-steps', label: 'Whole range', quantity: 'length', start: WHOLE_DIAL_STEPS });
  const back = holdButton(-1, 'left');
  const ahead = holdButton(1, 'right');
  const runBack = button('run-back', 'Run \u2212', () => run(-1));
  const runAhead = button('run-ahead', 'Run +', () => run(1));
  const set = button('set-position-button', 'Set position', () => withDevice((one, axis) => handlers.setPosition(one, axis, place.value())));
  const zero = button('zero', 'Zero', () =>
    withDevice((one, axis) => handlers.go(one, axis, 'zero', { axes: [axis], steps: dial.value() })),
  );
  const [placeNote, dialNote] = [place, dial].map(({ input }) =>
    element('p', { className: 'reason', id: `${input.id}-note`, role: 'status', hidden: true }),
  );
  const reason = element('p', { className: 'reason', id: 'jog-reason' });
  const scale = element('p', { className: 'reason', id: 'jog-scale' });
  const placeReason = element('p', { className: 'reason', id: 'place-reason' });

  /** What a length becomes that is no whole number of steps. */
  function showRounding() {
    for (const [field, note] of /** @type {const} */ ([[place, placeNote], [dial, dialNote]])) { // prettier-ignore
      showText(note, field.rounding());
      note.hidden = note.textContent === '' || field.input.getAttribute('aria-invalid') === 'true';
    }
  }

  /** @param {(device: Device, axis: number) => void} act */
  function withDevice(act) {
    if (context?.device) act(context.device, context.axis);
  }

  /** Do something at the speed of the field with the sign of a direction.
   * @param {1 | -1} direction @param {(device: Device, axis: number, speed: unknown) => void} act */
  function withSpeed(direction, act) {
    const { speed: directed, rejections } = directedSpeed(speed.value(), direction);
    if (rejections.length > 0) handlers.refuse(rejections);
    else withDevice((device, axis) => act(device, axis, directed));
  }

  /** @param {1 | -1} direction */
  function run(direction) {
    withSpeed(direction, (device, axis, directed) =>
      handlers.go(device, axis, 'run', { axes: [{ axis, speed_steps_per_s: directed }], for_s: seconds.value() }),
    );
  }

  /** Runs while it is pressed, by pointer or by key; whatever takes the press away ends it.
   * @param {1 | -1} direction @param {'left' | 'right'} drawing */
  function holdButton(direction, drawing) {
    const text = direction > 0 ? 'Jog +' : 'Jog \u2212';
    const held = element(
      'button',
      { className: 'button hold', type: 'button', 'aria-label': `${text} while held`, title: 'Moves while it is held', 'aria-describedby': 'jog-reason' },
      drawing === 'left' && icon('left'),
      element('span', { textContent: text }),
      drawing === 'right' && icon('right'),
    );
    held.id = `jog-${drawing}`;
    const begin = () => {
      if (held.disabled) return;
      held.dataset.held = '';
      withSpeed(direction, jog.begin);
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
      { className: 'section', oninput: showRounding },
      labelled('Speed', speed.element),
      speedProblem,
      element('div', { className: 'line hold-line' }, back, ahead),
      element('div', { className: 'line run-line' }, runBack, runAhead, element('span', { textContent: 'for' }), seconds.element),
      secondsProblem,
      scale,
      reason,
      element('p', {
        className: 'reason',
        id: 'run-explained',
        textContent: 'A run slows down after that, or when this page is closed. Run again in time, and it goes on.',
      }),
      element('div', { className: 'separator' }),
      labelled('It is at', place.element, set),
      placeProblem,
      placeNote,
      gauge,
      dialProblem,
      dialNote,
      placeReason,
      element('p', { className: 'reason', textContent: 'Set position says what the current position is called: nothing moves.' }),
      gaugeExplained,
    ),
    /** @param {Context} present */
    show(present) {
      context = present;
      const { device, known, situation, axis, inTheWay, notAtRest } = present;
      const [units, design] = [situation.units, situation.scaled[axis]];
      if (speed.value() === '' && speed.input !== document.activeElement) {
        const slew = Number(design.ramp.slew_speed_steps_per_s);
        if (slew > 0) speed.set(Number(shownValue({ length: 'steps', time: 's' }, design, 'speed', slew * FIRST_PART_OF_SLEW).toPrecision(3)));
      }
      for (const field of [speed, place, dial]) field.show(units, design);
      showText(scale, scaleText(present, [axis]));
      scale.hidden = scale.textContent === '';
      showRounding();
      const noRamp = device && !device.ramp ? 'Push a ramp first.' : '';
      const isHeld = 'held' in back.dataset || 'held' in ahead.dataset;
      able([runBack, runAhead], reason, inTheWay || noRamp, situation.isBusy);
      if (!isHeld) able([back, ahead], reason, inTheWay || noRamp, situation.isBusy);
      // A gauge is a pointer that turns.
      const isGauge = known !== null && can(present, 'zero') && design.axis.travel_unit === 'deg';
      for (const one of [gauge, gaugeExplained, dialProblem]) one.hidden = !isGauge;
      if (!isGauge) dialNote.hidden = true;
      able([set, zero], placeReason, inTheWay || notAtRest || noRamp, situation.isBusy);
      if (placeReason.textContent === reason.textContent) placeReason.hidden = true;
    },
    /** @param {import('../../model/types.js').Rejection[]} rejections */
    reject: (rejections) =>
      showAtPlaces(rejections, [
        {
          path: /(^|\.)speed_steps_per_s$/,
          input: speed.input,
          problem: speedProblem,
          text: (one) => speed.refusal(ofUndirected(one), 'Speed'),
        },
        { path: /^for_s$/, input: seconds.input, problem: secondsProblem, text: (one) => refusalText(one, 'The time') },
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
