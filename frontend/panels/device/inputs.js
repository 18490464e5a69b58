// @ts-check
// What a controller's inputs are for and which are active, and that what stopped it has to be acknowledged.

import { element, icon, showText } from '../../ui/dom.js';
import { enable } from './section.js';

/** @typedef {import('../../model/types.js').Device} Device */
/** @typedef {import('../../model/types.js').DeviceInput} DeviceInput */

/** @param {{acknowledge: (device: Device) => void}} handlers */
export function createInputs(handlers) {
  /** @type {Device | null} */
  let now = null;
  const acknowledge = element('button', {
    className: 'button small',
    id: 'acknowledge',
    type: 'button',
    textContent: 'Acknowledge',
    title: 'Take motions again: nothing moves by it',
    onclick: () => now && handlers.acknowledge(now),
  });
  const stopped = element('span');
  const line = element(
    'div',
    { className: 'others', id: 'stopped-by', role: 'status' },
    element('p', { className: 'message warning' }, icon('warning'), stopped),
    acknowledge,
  );
  const list = element('ul');
  const summary = element('summary');
  const inputs = element('details', { id: 'inputs' }, summary, list);

  const all = element('div', { className: 'inputs', hidden: true }, line, inputs);

  return {
    element: all,
    /** @param {import('./section.js').Context} context */
    show({ device, inTheWay, situation }) {
      now = device;
      const causes = device?.stopped_by ?? [];
      const used = device?.inputs ?? [];
      showText(stopped, causes.length === 0 ? '' : `Stopped by ${causes.map((each) => CAUSES[each]).join(' and ')}.`);
      line.hidden = causes.length === 0;
      enable(acknowledge, inTheWay === '' && !situation.isBusy);
      showText(summary, summaryText(used));
      const told = used.map(inputText);
      if (list.dataset.told !== told.join('\n')) {
        list.dataset.told = told.join('\n');
        list.replaceChildren(...told.map((textContent) => element('li', { textContent })));
      }
      inputs.hidden = used.length === 0;
      all.hidden = inputs.hidden && line.hidden;
    },
  };
}

/** @type {Record<string, string>} */
const CAUSES = { emergency_stop: 'an emergency stop', driver_fault: 'a driver’s fault', stepped_late: 'steps that came late' };

/** @param {DeviceInput[]} inputs */
function summaryText(inputs) {
  const active = inputs.filter(({ is_active }) => is_active).map(({ input }) => input);
  return active.length === 0 ? 'Inputs: none is active' : `Inputs: ${active.join(', ')} ${active.length > 1 ? 'are' : 'is'} active`;
}

/** @param {DeviceInput} input */
function inputText({ input, role, axis, end, is_active }) {
  const what = role === 'limit' ? `limit switch at the ${end} end of axis ${axis}` : ROLES[role];
  return `${input}: ${what}, ${is_active ? 'active' : 'inactive'}`;
}

/** @type {Record<string, string>} */
const ROLES = { emergency_stop: 'emergency stop', driver_fault: 'driver’s fault' };
