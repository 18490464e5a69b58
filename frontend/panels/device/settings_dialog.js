// @ts-check
// The dialog for how the controller drives its pins, which is on trial until it is kept, and for the soft limits of axes,
// which the server keeps.

import { api, isNo, Refusal } from '../../server/api.js';
import { createDialog, dialogFoot } from '../../ui/dialog.js';
import { element, messageLine } from '../../ui/dom.js';
import { createLimitFields } from './limits.js';
import { withoutThatOf } from '../../ui/refusal.js';
import { createSettingFields } from './setting_fields.js';

/** @typedef {import('../../model/types.js').Device} Device */
/** @typedef {import('../../model/types.js').Rejection} Rejection */
/** A part of what is wanted.
 * @typedef {{name: string, send: () => Promise<void>, taken?: () => void}} Part   taken: called once it is */

/** tell: says what nothing else shows.
 * @param {{limit: (device: Device, axes: import('../../model/types.js').SoftLimits[]) => Promise<void>,
 *   useSettings: (device: Device, settings: unknown) => Promise<void>, tell: (text: string) => void}} handlers */
export function createSettingsDialog({ limit, useSettings, tell }) {
  /** @type {Device | null} */
  let device = null;
  /** What is wrong with what is wanted, and what came of its parts.
   * @type {Rejection[]} */
  let refused = [];
  let outcome = '';
  /** How often it was opened: what was sent before then is of another showing. */
  let opened = 0;
  let isSending = false;
  const limits = createLimitFields();
  const settings = createSettingFields();
  const problem = element('div', { className: 'problem', role: 'alert' });
  const pins = element(
    'div',
    { id: 'pin-settings' },
    element('h3', { textContent: 'How the controller drives its pins' }),
    element('p', { className: 'reason', textContent: 'On trial until it is kept, in the Push section.' }),
    ...settings.elements,
  );
  const dialog = createDialog(
    { id: 'settings-dialog', title: 'Settings', onSubmit: submitted },
    pins,
    element('h3', { textContent: 'Soft limits' }),
    element('p', {
      className: 'reason',
      textContent:
        'Positions that an axis is kept within: what leads beyond is refused, and a run slows down in time. Empty: none. ' +
        'The server keeps them until it ends; this page remembers them for the port.',
    }),
    limits.element,
    problem,
    dialogFoot(
      () => dialog.close(),
      element('button', { className: 'button primary', id: 'use-settings', type: 'submit', textContent: 'Use them' }),
    ),
  );

  dialog.element.addEventListener('input', ({ target }) => {
    const left = limits.withoutThatFor(target, withoutThatOf(target, refused));
    if (left !== refused) reject(left, outcome);
  });

  /** @param {string[]} texts */
  function showProblems(texts) {
    problem.replaceChildren(...texts.map((text) => messageLine({ text, isWarning: false })));
  }

  /** Each rejection at its field, those of none below, where it is also said what came of the parts.
   * @param {Rejection[]} rejections @param {string} [came] */
  function reject(rejections, came = '') {
    [refused, outcome] = [rejections, came];
    const others = settings.reject(limits.reject(rejections));
    showProblems([...others.map(({ message }) => message), ...(came === '' ? [] : [came])]);
  }

  const focusRefused = () => /** @type {HTMLElement | null} */ (dialog.element.querySelector('[aria-invalid="true"]'))?.focus();

  /** Nothing is sent while anything is refused; of the rest what is changed, and no more.
   * @param {SubmitEvent} event */
  async function submitted(event) {
    event.preventDefault();
    if (device === null || isSending) return;
    const [to, changed, axes] = [device, settings.changed(), limits.changed()];
    reject([...(changed ? settings.refusals(changed) : []), ...limits.refusals(axes)]);
    if (refused.length > 0) return focusRefused();
    /** @type {Part[]} */
    const parts = [];
    if (changed) parts.push({ name: 'settings of the pins', send: () => useSettings(to, changed), taken: () => settings.taken(changed) });
    if (axes.length > 0) parts.push({ name: 'soft limits', send: () => limit(to, axes) });
    await send(parts);
  }

  /** What comes of it is of the dialog that was shown then: it may be another device's by now, or closed.
   * @param {Part[]} parts one after the other, until one isn't taken */
  async function send(parts) {
    const then = opened;
    for (const [index, part] of parts.entries()) {
      isSending = true;
      try {
        await part.send();
        if (then === opened) part.taken?.();
      } catch (error) {
        if (then !== opened) return;
        const rejections = error instanceof Refusal ? error.rejections : [failure(error)];
        reject(rejections, parts.length > 1 ? outcomeOf(parts, index, isNo(error)) : '');
        return focusRefused();
      } finally {
        if (then === opened) isSending = false;
      }
    }
    if (then === opened) dialog.close();
  }

  /** @param {Device} present */
  async function showSettings(present) {
    try {
      const found = await api.settings(present.id);
      if (present !== device) return;
      settings.show(found);
      pins.hidden = false;
    } catch (error) {
      if (present === device) showProblems([failure(error).message]);
    }
  }

  const firstField = () => (pins.hidden ? limits.element.querySelector('input') : settings.first());

  return {
    /** What is typed for a device stays while it is asked for again.
     * @param {Device} present @param {import('../../model/types.js').Situation} situation */
    async open(present, situation) {
      if (dialog.isOpen() && present.id === device?.id) return dialog.open(firstField());
      dialog.entitle(`Settings of ${present.name}`);
      opened += 1;
      isSending = false;
      device = present;
      settings.forget();
      limits.show(present, situation);
      reject([]);
      // Of settings that are not known nothing can be used: their fields come with them.
      pins.hidden = true;
      if (present.capabilities.includes('settings')) await showSettings(present);
      if (present !== device) return;
      dialog.open(firstField());
    },
    /** Close it when its device can't be told from another any more: what was typed is for none but that.
     * @param {Device[]} told @param {import('../../model/types.js').Link} link */
    follow(told, link) {
      const gone = device && whyGone(device, told, link);
      if (!device || !gone) return;
      if (dialog.isOpen()) tell(`The settings of ${device.name} were closed, and what was not used yet is not: ${gone}.`);
      opened += 1;
      device = null;
      dialog.close();
    },
  };
}

/** Why what is told is of no such device any more; empty: it is. Another server gives its numbers anew.
 * @param {Device} device @param {Device[]} told @param {import('../../model/types.js').Link} link */
function whyGone({ id, port }, told, link) {
  const now = told.find((one) => one.id === id);
  if (link === 'gone' || link === 'unknown') return 'the server is gone';
  if (!now) return 'it is not connected any more';
  return now.port === port ? '' : `it was at ${port}, and what has its number now is at ${now.port}`;
}

/** @param {unknown} error @returns {Rejection} */
function failure(error) {
  return { field: null, value: null, allowed: null, message: error instanceof Error ? error.message : String(error) };
}

/** What came of parts that were sent one after the other.
 * @param {Part[]} parts @param {number} failed the one that was not taken @param {boolean} isKnown whether it was not */
function outcomeOf(parts, failed, isKnown) {
  const told = parts.map(({ name }, index) => {
    if (index === failed && !isKnown) return `Whether the ${name} were taken isn’t known.`;
    return `The ${name} were ${index < failed ? 'taken' : 'not taken'}.`;
  });
  return told.join(' ');
}
