// @ts-check
// Pushing the ramps: what would change, how far it has come, what came of it, and the way back.

import { element, icon, messageLine, showText } from '../../ui/dom.js';
import { formatFixed } from '../../model/numbers.js';
import { figureCell, figureHead, figuresOf, sizeText, tableHead, unseen } from './figures.js';
import { mend } from '../../app/commands/work.js';
import { createProof } from './proof.js';
import { createPushReport } from './push_report.js';
import { createRefusals } from './push_refusals.js';
import { pushedParts, ratherLong, warningsOf } from './push_words.js';
import { able, can, enable, handOn } from './section.js';

/** @typedef {import('../../model/types.js').Device} Device */
/** @typedef {import('./section.js').Context} Context */
/** @typedef {import('../../model/types.js').Situation} Situation */

/** What part of a push is behind it when a stage begins, and when it ends. */
const STAGES = {
  planning: { text: 'Working out the segments', from: 0, to: 0.05 },
  sending: { text: 'Sending', from: 0.05, to: 0.4 },
  checking: { text: 'Checking', from: 0.4, to: 0.6 },
  storing: { text: 'Storing', from: 0.6, to: 0.8 },
  reading_back: { text: 'Reading back', from: 0.8, to: 1 },
};
/** What a push begins with to a controller that works its ramps out itself. */
const READING = 'Reading its settings';
const AWAITED = 'What a push would change is being worked out …';
/** From when on that is said. */
const AWAITED_MS = 500;

/**
 * @param {{push: (device: Device, mode: 'keep' | 'try') => void, prove: (device: Device) => void,
 *   store: (device: Device, what: 'keep' | 'roll_back' | 'restore') => void}} handlers
 * @param {import('../../app/state.js').Dispatch} dispatch
 */
export function createPushSection(handlers, dispatch) {
  /** @type {Device | null} */
  let device = null;
  const report = createPushReport();
  const proof = createProof(handlers);
  const push = button('push', 'button primary grow', () => device && handlers.push(device, device.capabilities.includes('keep') ? 'keep' : 'try'));
  // Where there is no room for both, the name of the design is cut, and the method is read.
  const [what, by] = [element('span'), element('span', { className: 'by' })];
  push.append(icon('send'), element('span', { className: 'words' }, what, by));
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
  const awaited = element('p', { className: 'reason', id: 'push-awaited', role: 'status', textContent: AWAITED });
  const awaitsLong = ratherLong(AWAITED_MS);
  const changes = element('div', { className: 'push-details', id: 'push-preview' });
  const refusals = createRefusals((axis, remedy) => dispatch(mend, axis, remedy));
  const filled = element('i');
  const bar = element('div', { className: 'progress', role: 'progressbar', 'aria-label': 'Push' }, filled);
  const stage = element('span');
  const waitsLong = ratherLong();
  const progress = element('div', { className: 'push-progress', id: 'push-progress' }, bar, stage);

  /** @param {import('../../model/types.js').Progress} now @param {boolean} takesSegments */
  function showProgress(now, takesSegments) {
    const { stage: name, bytes_done, bytes_total } = now;
    const isPlanning = name === 'planning';
    const isLong = waitsLong.isSo(isPlanning && takesSegments, () => showProgress(now, takesSegments));
    const { text: usual, from, to } = STAGES[name];
    const text = isPlanning && !takesSegments ? READING : usual;
    const part = bytes_total > 0 ? bytes_done / bytes_total : 0;
    const percent = Math.round(100 * (from + (to - from) * part));
    filled.style.width = `${percent}%`;
    bar.setAttribute('aria-valuenow', String(percent));
    bar.setAttribute('aria-valuetext', text);
    stage.textContent =
      bytes_total > 0
        ? `${text}: ${formatFixed(bytes_done)} of ${formatFixed(bytes_total)} bytes`
        : isLong
          ? `${text}: the first time, what computes ramps is made ready, which takes some seconds. STOP ends it.`
          : `${text} …`;
  }

  /** What comes soon is not announced: at each edit the line would come and go.
   * @param {boolean} isAwaited */
  function showAwaited(isAwaited) {
    awaited.hidden = !awaitsLong.isSo(isAwaited, () => (awaited.hidden = false));
  }

  /** @param {import('../../model/types.js').Preview} preview @param {Situation} situation */
  function showChanges(preview, { units, toPush }) {
    const known = JSON.stringify([preview, units, toPush.map(({ axis }) => axis)]);
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
      ...(differing.length > 0
        ? [
            element(
              'div',
              { className: 'push-rows', tabIndex: 0, role: 'region', 'aria-label': 'What would change' },
              changesTable(differing, axes, units, toPush),
            ),
          ]
        : []),
      ...warningsOf(preview, units, toPush).map((text) => messageLine({ text, isWarning: true })),
    );
  }

  return {
    element: element(
      'div',
      { className: 'section' },
      // What comes and goes stands beneath the buttons: nobody presses where one has just been.
      element('div', { className: 'line' }, push, trial),
      reason,
      progress,
      refusals.element,
      awaited,
      changes,
      onTrial,
      report.element,
      proof.element,
      element('div', { className: 'line' }, restore),
    ),
    /** @param {Context} context */
    show(context) {
      const { device: present, situation, inTheWay, notAtRest } = context;
      device = present;
      const blocked = inTheWay || notAtRest;
      const isInvalid = situation.isDesignValid || situation.isAwaited ? '' : ['Correct the design first.', situation.nameProblem].filter(Boolean).join(' ');
      const isRefused = situation.refusals.length > 0;
      able([push, trial], reason, blocked || isInvalid, situation.isBusy || situation.isAwaited || isRefused);
      const isFree = blocked === '' && !situation.isBusy;
      onTrial.hidden = !present?.on_trial;
      if (onTrial.hidden) handOn([keep, rollBack], push);
      for (const other of [keep, rollBack]) enable(other, isFree);
      enable(restore, isFree && !present?.on_trial && (present?.ramp?.sequence ?? 0) >= 2);
      restore.hidden = !present?.ramp || !can(context, 'restore');
      keep.hidden = !present?.ramp || !can(context, 'keep');
      rollBack.hidden = !can(context, 'try');
      trial.hidden = !can(context, 'keep') || !can(context, 'try');
      const [design, methods] = pushedParts(situation.toPush);
      showText(what, situation.isPushing ? 'Pushing…' : `Push ${design}`);
      showText(by, situation.isPushing ? '' : ` ${methods}`);
      const now = present?.progress ?? null;
      progress.hidden = now === null;
      // Those without a step timer are given no segments.
      if (now) showProgress(now, (present?.timer_hz ?? null) !== null);
      else waitsLong.end();
      changes.hidden = situation.preview === null || now !== null;
      if (situation.preview) showChanges(situation.preview, situation);
      showAwaited(situation.isPreviewAwaited && blocked === '' && !situation.isBusy && now === null);
      refusals.show(situation);
      report.show(present, situation);
      proof.show(context);
    },
  };
}

/** @param {import('../../model/types.js').PreviewItem[]} items @param {boolean} areOfSeveral
 * @param {Situation['units']} units @param {Situation['toPush']} designs */
function changesTable(items, areOfSeveral, units, designs) {
  const rows = items.map((item) => changeRow(item, areOfSeveral, figuresOf(item, units, designs)));
  const head = tableHead([unseen('item'), 'on device', 'to send']);
  return element('table', {}, head, element('tbody', {}, ...rows));
}

/** @param {import('../../model/types.js').PreviewItem} item @param {boolean} isOfSeveral
 * @param {ReturnType<typeof figuresOf>} figures */
function changeRow(item, isOfSeveral, { unit, write }) {
  const text = (/** @type {number | null} */ value) => (value === null ? '–' : write(value));
  const name = isOfSeveral && item.axis !== null ? `${item.axis}: ${item.name}` : item.name;
  return element(
    'tr',
    {},
    figureHead(name, unit, item.own),
    figureCell(text(item.on_device), item.own?.on_device),
    figureCell(text(item.to_send), item.own?.sent, 'coming'),
  );
}

/** @param {string} id @param {string} className @param {() => void} onclick */
function button(id, className, onclick) {
  return element('button', { className, id, type: 'button', onclick });
}
