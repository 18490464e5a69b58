// @ts-check
// Pushing the ramps: what would change, how far it has come, what came of it, and the way back.

import { element, icon, messageLine } from '../../dom.js';
import { formatFixed } from '../../numbers.js';
import { figureHead, formatFigure, sizeText } from './figures.js';
import { createPushReport } from './push_report.js';
import { able, can } from './section.js';

/** @typedef {import('../../types.js').Device} Device */
/** @typedef {import('./section.js').Context} Context */

/** What part of a push is behind it when a stage begins, and when it ends. */
const STAGES = {
  planning: { text: 'Working out the segments', from: 0, to: 0.05 },
  sending: { text: 'Sending', from: 0.05, to: 0.4 },
  checking: { text: 'Checking', from: 0.4, to: 0.6 },
  storing: { text: 'Storing', from: 0.6, to: 0.8 },
  reading_back: { text: 'Reading back', from: 0.8, to: 1 },
};

/**
 * @param {{push: (device: Device, mode: 'keep' | 'try') => void,
 *   store: (device: Device, what: 'keep' | 'roll_back' | 'restore') => void}} handlers
 */
export function createPushSection(handlers) {
  /** @type {Device | null} */
  let device = null;
  const report = createPushReport();
  const push = button('push', 'button primary grow', () => device && handlers.push(device, device.capabilities.includes('keep') ? 'keep' : 'try'));
  push.append(icon('send'), element('span'));
  push.setAttribute('aria-describedby', 'push-reason');
  const trial = button('try', 'button', () => device && handlers.push(device, 'try'));
  trial.textContent = 'Try';
  trial.title = 'Use it without storing it';
  const keep = button('keep-ramp', 'button grow', () => device && handlers.store(device, 'keep'));
  keep.textContent = 'Keep it';
  const rollBack = button('roll-back', 'button grow', () => device && handlers.store(device, 'roll_back'));
  rollBack.textContent = 'Roll back';
  const restore = button('restore', 'button grow', () => device && handlers.store(device, 'restore'));
  restore.textContent = 'Restore the previous ramp';
  const onTrial = element(
    'div',
    { className: 'on-trial' },
    messageLine({ text: 'On trial: a reset brings the stored ramp and settings back.', isWarning: true }),
    element('div', { className: 'line' }, keep, rollBack),
  );
  const reason = element('p', { className: 'reason', id: 'push-reason' });
  const changes = element('div', { className: 'push-details', id: 'push-preview' });
  const problem = element('div', { className: 'problem', id: 'push-problem' });
  const filled = element('i');
  const bar = element('div', { className: 'progress', role: 'progressbar', 'aria-label': 'Push' }, filled);
  const stage = element('span');
  const progress = element('div', { className: 'push-progress', id: 'push-progress' }, bar, stage);

  /** @param {import('../../types.js').Progress} now */
  function showProgress({ stage: name, bytes_done, bytes_total }) {
    const { text, from, to } = STAGES[name];
    const part = bytes_total > 0 ? bytes_done / bytes_total : 0;
    const percent = Math.round(100 * (from + (to - from) * part));
    filled.style.width = `${percent}%`;
    bar.setAttribute('aria-valuenow', String(percent));
    bar.setAttribute('aria-valuetext', text);
    stage.textContent =
      bytes_total > 0 ? `${text}: ${formatFixed(bytes_done)} of ${formatFixed(bytes_total)} bytes` : `${text} …`;
  }

  /** @param {import('../../types.js').Preview} preview */
  function showChanges(preview) {
    const known = JSON.stringify(preview);
    if (changes.dataset.known === known) return;
    changes.dataset.known = known;
    const differing = preview.items.filter((item) => item.differs);
    const axes = new Set(preview.items.map((item) => item.axis)).size > 2;
    changes.replaceChildren(
      element(
        'div',
        { className: 'push-head' },
        element('b', { textContent: preview.same ? 'The device has this ramp' : 'A push would change' }),
        element('span', { textContent: sizeText(preview) }),
      ),
      ...(differing.length > 0 ? [changesTable(differing, axes)] : []),
      ...preview.warnings.map((text) => messageLine({ text, isWarning: true })),
    );
  }

  return {
    element: element(
      'div',
      { className: 'section' },
      changes,
      problem,
      element('div', { className: 'line' }, push, trial),
      reason,
      progress,
      onTrial,
      report.element,
      element('div', { className: 'line' }, restore),
    ),
    /** @param {Context} context */
    show({ device: present, known, situation, inTheWay, notAtRest }) {
      device = present;
      const blocked = inTheWay || notAtRest;
      const isInvalid = situation.isDesignValid ? '' : 'Correct the design first.';
      const isRefused = situation.previewProblem !== '';
      able([push, trial], reason, blocked || isInvalid, situation.isBusy || isRefused);
      for (const other of [keep, rollBack, restore]) other.disabled = blocked !== '' || situation.isBusy;
      restore.disabled ||= Boolean(present?.on_trial) || !present?.ramp || (present.ramp.sequence ?? 0) < 2;
      restore.hidden = !present?.ramp || !can(known, 'restore');
      onTrial.hidden = !present?.on_trial;
      keep.hidden = !present?.ramp || !can(known, 'keep');
      rollBack.hidden = !can(known, 'try');
      trial.hidden = !can(known, 'keep') || !can(known, 'try');
      const label = /** @type {HTMLElement} */ (push.lastElementChild);
      const isOther = situation.isChanged || (situation.preview !== null && !situation.preview.same);
      label.textContent = situation.isPushing ? 'Pushing…' : pushWords(situation, isOther && Boolean(present?.ramp));
      const now = present?.progress ?? null;
      progress.hidden = now === null;
      if (now) showProgress(now);
      changes.hidden = situation.preview === null || now !== null;
      if (situation.preview) showChanges(situation.preview);
      const text = situation.previewProblem;
      if (problem.textContent !== text) problem.replaceChildren(...(text ? [messageLine({ text, isWarning: false })] : []));
      report.show(present, situation);
    },
  };
}

/** What a push is called: where the device can't have the ramps of all designs, the one in view is told from the others.
 * @param {import('../../types.js').Situation} situation @param {boolean} isChange */
function pushWords({ designs, toPush }, isChange) {
  if (toPush.length < designs.length) return 'Push the ramp in view';
  if (isChange) return 'Push the changes';
  return toPush.length > 1 ? `Push the ${toPush.length} ramps` : 'Push the ramp';
}

/** @param {import('../../types.js').PreviewItem[]} items @param {boolean} areOfSeveral */
function changesTable(items, areOfSeveral) {
  const heads = ['', 'on device', 'to send'].map((textContent) => element('th', { scope: 'col', textContent }));
  return element(
    'table',
    {},
    element('thead', {}, element('tr', {}, ...heads)),
    element('tbody', {}, ...items.map((item) => changeRow(item, areOfSeveral))),
  );
}

/** @param {import('../../types.js').PreviewItem} item @param {boolean} isOfSeveral */
function changeRow(item, isOfSeveral) {
  const name = isOfSeveral && item.axis !== null ? `${item.axis}: ${item.name}` : item.name;
  return element(
    'tr',
    {},
    figureHead(name, item.unit),
    element('td', { textContent: figureText(item.on_device, item.unit) }),
    element('td', { className: 'coming', textContent: figureText(item.to_send, item.unit) }),
  );
}

/** @param {number | null} value @param {string} unit */
function figureText(value, unit) {
  return value === null ? '–' : formatFigure(value, unit);
}

/** @param {string} id @param {string} className @param {() => void} onclick */
function button(id, className, onclick) {
  return element('button', { className, id, type: 'button', onclick });
}
