// @ts-check
// The dialog that asks how axes are to be homed, and says what will move before anything does.

import { isNo, Refusal } from '../../server/api.js';
import { farthestSteps } from '../../devices/homing.js';
import { memory } from '../../documents/memory.js';
import { refusalText } from '../../model/messages.js';
import { lengthText } from '../../model/places.js';
import { createDialog, dialogFoot } from '../../ui/dialog.js';
import { element, messageLine, showText } from '../../ui/dom.js';
import { plainField } from '../../ui/plain_field.js';
import { quantityField } from '../../ui/quantity_field.js';
import { showAtPlaces, withoutThatOf } from '../../ui/refusal.js';
import { createHomeAxis } from './home_axis.js';
import { able, speedText } from './section.js';

/** @typedef {import('../../model/types.js').Device} Device */
/** @typedef {import('../../model/types.js').Rejection} Rejection */
/** @typedef {import('../../devices/homing.js').HomeWish} HomeWish */
/** @typedef {import('./section.js').Context} Context */

const MOST_AXES = 4;
const SECONDS = '60';
const NO_SWITCH = 'No input is a limit switch yet: say in the settings of the device, by the button at its head, which one is, and at which end.';

/** @param {{home: (device: Device, wish: HomeWish) => Promise<boolean>}} handlers  home: false where it was not asked for */
export function createHomeDialog({ home }) {
  /** @type {Context | null} */
  let context = null;
  /** Of the device that it is opened for.
   * @type {string | null} */
  let id = null;
  /** @type {Rejection[]} */
  let refused = [];
  const axes = Array.from({ length: MOST_AXES }, (_, axis) => createHomeAxis(axis));
  const slow = quantityField({ id: 'home-slow', label: 'Slow speed', quantity: 'speed', start: 50 });
  const backOff = quantityField({ id: 'home-back-off', label: 'Back-off', quantity: 'length', start: 50 });
  const seconds = plainField({ id: 'home-for', label: 'Time at most', unit: 's', value: SECONDS });
  const [slowProblem, backOffProblem, secondsProblem] = [slow, backOff, seconds].map(() => element('div', { className: 'problem' }));
  const common = element(
    'div',
    { className: 'home-details' },
    element('span', { textContent: 'Slow' }),
    slow.element,
    slowProblem,
    element('span', { textContent: 'Back-off' }),
    backOff.element,
    backOffProblem,
    element('span', { textContent: 'Time at most' }),
    seconds.element,
    secondsProblem,
    element('p', {
      className: 'reason',
      textContent: 'Each goes fast to its switch, slowly off it and on by the back-off, and slowly back: there its position is set.',
    }),
  );
  const moves = element('ul', { id: 'home-moves' });
  const reason = element('p', { className: 'reason warns', id: 'home-reason' });
  const problem = element('div', { className: 'problem', role: 'alert' });
  const go = element('button', { className: 'button primary', id: 'home-go', type: 'submit', textContent: 'Home', 'aria-describedby': 'home-reason' });
  const dialog = createDialog(
    { id: 'home-dialog', title: 'Home', onSubmit: submitted },
    ...axes.map((one) => one.element),
    common,
    element('h3', { textContent: 'What will move' }),
    moves,
    reason,
    problem,
    dialogFoot(() => dialog.close(), go),
  );
  dialog.element.addEventListener('input', ({ target }) => {
    const left = withoutThatOf(target, refused);
    if (left !== refused) reject(left);
    follow();
  });

  const chosen = () => axes.filter((one) => one.isChosen());
  /** As it is asked for: the server refuses what is no number. */
  const wish = () =>
    /** @type {HomeWish} */ ({
      axes: chosen().map((one) => one.wish()),
      slow_steps_per_s: slow.value(),
      back_off_steps: backOff.value(),
      for_s: seconds.value(),
    });

  /** @param {Rejection[]} rejections */
  function reject(rejections) {
    refused = rejections;
    const asked = chosen();
    const others = showAtPlaces(rejections, [
      ...axes.flatMap((one) => one.places(asked.indexOf(one))),
      { path: /^slow_steps_per_s$/, input: slow.input, problem: slowProblem, text: (one) => slow.refusal(one, 'Slow speed') },
      { path: /^back_off_steps$/, input: backOff.input, problem: backOffProblem, text: (one) => backOff.refusal(one, 'Back-off') },
      { path: /^for_s$/, input: seconds.input, problem: secondsProblem, text: (one) => refusalText(one, 'The time') },
    ]);
    problem.replaceChildren(...others.map(({ message }) => messageLine({ text: message, isWarning: false })));
  }

  /** What follows from what is typed, and from what the device does. */
  function follow() {
    if (context === null) return;
    const { device, situation, inTheWay, notAtRest } = context;
    const { units, scaled } = situation;
    const places = chosen();
    for (const one of axes) one.show(units, scaled[one.axis] ?? scaled[0]);
    // They are steps of all: shown as those of the first that is homed.
    const first = scaled[places[0]?.axis ?? 0] ?? scaled[0];
    slow.show(units, first);
    backOff.show(units, first);
    common.hidden = axes.every((one) => one.element.hidden);
    const isWrong = places.some((one, at) => one.refused(at).length > 0);
    const told = places.length === 0 || isWrong ? [] : movesText(wish(), context);
    if (moves.dataset.told !== told.join('\n')) {
      moves.dataset.told = told.join('\n');
      moves.replaceChildren(...told.map((textContent) => element('li', { textContent })));
    }
    showText(go, places.length === 0 ? 'Home' : `Home ${places.length > 1 ? 'axes' : 'axis'} ${places.map(({ axis }) => axis).join(', ')}`);
    const noRamp = device && !device.ramp ? 'Push a ramp first: it is moved with that.' : '';
    const stopped = (device?.stopped_by ?? []).length > 0 ? 'Something has stopped it: release that, then acknowledge it in the panel.' : '';
    const none = common.hidden ? NO_SWITCH : places.length === 0 ? 'Choose an axis.' : '';
    able([go], reason, inTheWay || notAtRest || stopped || noRamp || none, situation.isBusy);
  }

  /** @param {SubmitEvent} event */
  async function submitted(event) {
    event.preventDefault();
    const device = context?.device;
    if (!device || device.id !== id || go.disabled) return;
    const { slow_steps_per_s, back_off_steps, for_s } = wish();
    memory.keepHoming(device.port, { axes: axes.map((one) => one.kept()), slow: slow_steps_per_s, backOff: back_off_steps, seconds: for_s });
    const wrong = chosen().flatMap((one, at) => one.refused(at));
    reject(wrong);
    if (wrong.length > 0) return showWrong();
    try {
      if (await home(device, wish())) dialog.close();
    } catch (error) {
      if (id !== device.id) return;
      const unknown = isNo(error) ? '' : ' Whether it moves isn’t known: press STOP if it may.';
      const message = `${error instanceof Error ? error.message : error}${unknown}`;
      reject(error instanceof Refusal && unknown === '' ? error.rejections : [{ field: null, value: null, allowed: null, message }]);
      showWrong();
    }
  }

  function showWrong() {
    /** @type {HTMLElement | null} */ (dialog.element.querySelector('[aria-invalid="true"]'))?.focus();
  }

  return {
    /** @param {Context} present */
    open(present) {
      const { device } = present;
      if (!device) return;
      [context, id] = [present, device.id];
      const kept = memory.homing(device.port);
      for (const one of axes) one.fill(device, kept?.axes.find(({ axis }) => axis === one.axis), one.axis === present.axis);
      if (kept) {
        slow.set(kept.slow);
        backOff.set(kept.backOff);
        seconds.input.value = String(kept.seconds);
      } else {
        for (const field of [slow, backOff]) field.reset();
        seconds.input.value = SECONDS;
      }
      dialog.entitle(`Home ${device.name}`);
      reject([]);
      follow();
      dialog.open(axes.find((one) => !one.element.hidden)?.element.querySelector('input') ?? undefined);
    },
    /** What is told of the device while it is open; it closes with it.
     * @param {Context} present */
    follow(present) {
      if (!dialog.isOpen()) return;
      if (present.device?.id !== id) return dialog.close();
      context = present;
      follow();
    },
  };
}

/** Which axis moves, which way, how fast and how far at most; of what is no number nothing.
 * @param {HomeWish} wish @param {Context} context */
function movesText(wish, { device, situation: { units, scaled } }) {
  const told = wish.axes.map((one) => {
    const design = scaled[one.axis] ?? scaled[0];
    const way = Number(one.fast_steps_per_s) < 0 ? 'backwards' : 'forwards';
    const numbers = [one.fast_steps_per_s, wish.slow_steps_per_s, wish.for_s].map((value) => (typeof value === 'number' ? value : NaN));
    const far = farthestSteps(wish, one);
    if (numbers.some(Number.isNaN)) return `Axis ${one.axis}: ${way}, towards its switch.`;
    const speed = speedText(units, design, Math.abs(numbers[0]));
    return `Axis ${one.axis}: ${way} at ${speed} to its switch. Should that never come, it goes on for ${wish.for_s} s: ${lengthText(units, design, far)} at most, and what it takes to slow down.`;
  });
  const isLimited = device?.axes.some((axis) => wish.axes.some((one) => one.axis === axis.axis) && (axis.lowest_steps !== null || axis.highest_steps !== null));
  return [...told, ...(isLimited ? ['Soft limits don’t hold meanwhile.'] : []), 'STOP ends it at any time.'];
}
