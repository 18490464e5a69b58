// @ts-check
// Homing of a device that can be: the button, whether it is known where axes are, how it goes on and what came of it.

import { outcomeText } from '../../devices/homing.js';
import { lengthText } from '../../model/places.js';
import { element, messageLine, showText } from '../../ui/dom.js';
import { createHomeDialog } from './home_dialog.js';
import { enable } from './section.js';

/** @typedef {import('./section.js').Context} Context */

/** @param {Parameters<typeof createHomeDialog>[0]} handlers */
export function createHome(handlers) {
  /** @type {Context | null} */
  let context = null;
  const dialog = createHomeDialog(handlers);
  const button = element('button', {
    className: 'button small',
    id: 'home',
    type: 'button',
    textContent: 'Home…',
    title: 'Find limit switches, and know from then on where axes are',
    onclick: () => context && dialog.open(context),
  });
  const known = element('p', { className: 'reason', id: 'home-known' });
  const came = element('div', { id: 'home-outcome', role: 'status' });
  const whole = element('div', { className: 'homing' }, element('div', { className: 'line' }, known, button), came);

  return {
    element: whole,
    /** @param {Context} present */
    show(present) {
      context = present;
      const { device, inTheWay, situation } = present;
      whole.hidden = device === null || !device.capabilities.includes('inputs');
      enable(button, inTheWay === '' && !situation.isBusy);
      showText(known, device === null ? '' : knownText(device));
      showOutcome(present);
      dialog.follow(present);
    },
  };

  /** @param {Context} present */
  function showOutcome({ homing, situation: { units, scaled } }) {
    const told = (homing?.wish.axes ?? []).flatMap((one, at) => {
      const outcome = homing?.outcomes?.[at];
      const design = scaled[one.axis] ?? scaled[0];
      const length = (/** @type {number} */ steps) => lengthText(units, design, steps);
      return homing && outcome ? { text: outcomeText(outcome, one, homing.wish, length), isWarning: true, isGood: outcome === 'homed' } : [];
    });
    const text = told.map((one) => one.text).join('\n');
    if (came.dataset.told === text) return;
    came.dataset.told = text;
    came.replaceChildren(...told.map((one) => (one.isGood ? element('p', { className: 'reason', textContent: one.text }) : messageLine(one))));
  }
}

/** @param {import('../../model/types.js').Device} device */
function knownText({ axes }) {
  const under = axes.filter(({ homing }) => homing).map(({ axis }) => axis);
  if (under.length > 0) return `${axesText(under)} ${under.length > 1 ? 'are' : 'is'} being homed. STOP ends it.`;
  const unknown = axes.filter(({ position_known }) => position_known === false).map(({ axis }) => axis);
  if (unknown.length === 0) return 'It is known where its axes are.';
  return `Where ${axesText(unknown, false)} ${unknown.length > 1 ? 'are' : 'is'} isn’t known.`;
}

/** @param {number[]} axes @param {boolean} [isFirst] in its sentence */
function axesText(axes, isFirst = true) {
  const word = axes.length > 1 ? 'axes' : 'axis';
  return `${isFirst ? word.replace('a', 'A') : word} ${axes.join(', ')}`;
}
