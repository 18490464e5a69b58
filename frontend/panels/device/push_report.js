// @ts-check
// What the last push asked for, sent and read back, item by item, and what a start has shown of that.

import { shownState } from '../../devices/state_words.js';
import { closeButton, element, icon, messageLine } from '../../ui/dom.js';
import { formatFigures } from '../../model/numbers.js';
import { pushedWords, warningsOf } from './push_words.js';
import { figureCell, figureHead, figuresOf, sizeText, tableHead, unseen } from './figures.js';

/** @typedef {import('../../model/types.js').Device} Device */

const STAGES = ['requested', 'sent', 'read back', 'verified'];
/** Of a controller that shows it only by a start. */
const STORED = 'stored';

/** What is known of whether a device has stored what it was given.
 * @typedef {'none' | 'restarting' | 'pending' | 'stored' | 'others'} Standing */

/** @param {Device | null} device @returns {Standing} none: it isn't asked, or nothing was given */
function standingOf(device) {
  if (device === null) return 'none';
  if (shownState(device) === 'restarting') return 'restarting';
  if ((device.proof?.others.length ?? 0) > 0) return 'others';
  if (device.unproven.length > 0) return 'pending';
  return device.proof === null ? 'none' : 'stored';
}

/** Whether the device has another ramp than the one that was pushed last: it was rolled back, or restored.
 * @param {Device} device @param {import('../../model/types.js').Preview | null} preview  also tells what is there now */
export function hasAnotherRamp({ pushed, ramp }, preview) {
  const items = pushed?.items ?? [];
  const sent = items.find(({ unit }) => unit === 'CRC-16')?.sent;
  if (sent !== undefined) return (ramp?.crc ?? null) !== sent;
  const present = new Map(preview?.items.map(({ axis, own }) => [`${axis} ${own?.term}`, own?.on_device]));
  return items.some(({ axis, own }) => {
    const now = own && present.get(`${axis} ${own.term}`);
    return typeof now === 'number' && now !== own?.on_device;
  });
}

export function createPushReport() {
  const stages = STAGES.map((name) => element('div', { textContent: name }));
  const stored = element('div', { textContent: STORED });
  const bar = element('div', { className: 'stages', 'aria-hidden': 'true' }, ...stages, stored);
  const details = element('div', { className: 'push-details' });
  let known = '';
  /** The push, and what was proven of it, whose report was closed.
   * @type {string | null} */
  let closed = null;
  let reportable = '';
  const close = closeButton('Close the report', () => {
    closed = reportable;
    details.hidden = bar.hidden = true;
  });
  /** The push that is reported. */
  let shown = '';
  /** By device, the designs that its report is of: they are known no more once it has another ramp, but their scale is that of the
   * figures as long as it is shown.
   * @type {Map<string, {push: string, designs: import('../../model/types.js').Design[]}>} */
  const reported = new Map();

  /** @param {Device} device @param {import('../../model/types.js').Situation} situation */
  function reportedDesigns({ id }, { lastPushed, toPush }) {
    const before = reported.get(id);
    const designs = lastPushed ?? (before?.push === shown ? before.designs : toPush);
    reported.set(id, { push: shown, designs });
    return designs;
  }

  /** What a start has shown of what was given before it was connected: there is no push to tell of.
   * @param {Device} device @param {Standing} standing */
  function showProof({ proof }, standing) {
    const [className, textContent] = HEADS[standing];
    details.replaceChildren(
      element('div', { className: 'push-head' }, element('b', { className, textContent }), close),
      ...proofLines(proof),
    );
  }

  /** @param {import('../../model/types.js').Push} pushed @param {Device} device @param {Standing} standing
   * @param {string[]} warnings @param {boolean} isChanged
   * @param {import('../../model/types.js').Design[] | null} lastPushed  null: another page has pushed it
   * @param {boolean} isReplaced @param {import('../../model/units.js').Units} units
   * @param {import('../../model/types.js').Design[]} designs */
  function showDetails(pushed, { proof }, standing, warnings, isChanged, lastPushed, isReplaced, units, designs) {
    const what = [
      ...(lastPushed ? [pushedWords(lastPushed)] : []),
      ...(pushed.sequence === null ? [] : [`ramp ${pushed.sequence}`]),
    ].join(' · ');
    const rows = pushed.items.map((item) => reportRow(item, figuresOf(item, units, designs)));
    const [className, textContent] = pushed.verified ? HEADS[standing] : ['differs', 'Not as sent'];
    details.replaceChildren(
      element(
        'div',
        { className: 'push-head' },
        element('b', { className, textContent }),
        element('span', { textContent: sizeText(pushed) }),
        close,
      ),
      ...(isReplaced ? [element('p', { className: 'reason pushed-what', textContent: 'The device has another ramp since this push.' })] : []),
      ...(what === '' ? [] : [element('p', { className: 'reason pushed-what', textContent: what })]),
      element(
        'div',
        { className: 'push-rows', tabIndex: 0, role: 'region', 'aria-label': 'What was pushed' },
        element(
          'table',
          {},
          tableHead([unseen('item'), 'requested', 'sent', 'read back', unseen('the same')]),
          element('tbody', {}, ...rows),
        ),
      ),
      ...(pushed.largest_deviation_us !== null && pushed.largest_deviation_us > 0
        ? [
            element('p', {
              className: 'reason',
              textContent: `Largest deviation from the design: ${formatFigures(pushed.largest_deviation_us, 3)} µs`,
            }),
          ]
        : []),
      ...proofLines(proof),
      ...warnings.map((text) => messageLine({ text, isWarning: true })),
      ...(isChanged ? [element('p', { className: 'reason', textContent: 'The design has changed since this push.' })] : []),
    );
  }

  return {
    element: element('div', { className: 'push-report', id: 'push-report' }, bar, details),
    /** @param {Device | null} device @param {import('../../model/types.js').Situation} situation */
    show(device, situation) {
      const { isPushing, isChanged, preview, lastPushed, units } = situation;
      const [pushed, standing] = [device?.pushed ?? null, isPushing ? 'none' : standingOf(device)];
      const isShown = pushed !== null || standing === 'stored' || standing === 'others';
      const reached = isPushing ? 1 : !isShown ? 0 : pushed?.verified === false ? STAGES.length - 1 : STAGES.length;
      stages.forEach((stage, index) => {
        stage.className = index < reached ? 'done' : isPushing && index < STAGES.length - 1 ? 'doing' : '';
      });
      stored.hidden = !device?.capabilities.includes('prove');
      stored.className = STORED_CLASSES[standing];
      shown = JSON.stringify(pushed);
      reportable = JSON.stringify([pushed, device?.proof ?? null]);
      if (isPushing) closed = null;
      bar.hidden = reportable === closed;
      details.hidden = isPushing || !isShown || reportable === closed;
      // What is said of the next push is not said of the last one again.
      const designs = device === null ? [] : reportedDesigns(device, situation);
      const told = pushed ? warningsOf(pushed, units, designs) : [];
      const warnings = told.filter((_, place) => !preview?.warnings.includes(pushed?.warnings[place] ?? ''));
      // Where a start has shown that, it tells more of it.
      const isReplaced = device !== null && standing !== 'others' && hasAnotherRamp(device, preview);
      const state = JSON.stringify([pushed, device?.proof, standing, warnings, isChanged, lastPushed && pushedWords(lastPushed), isReplaced, units, designs.map(({ axis }) => axis)]);
      if (state === known) return;
      known = state;
      if (device && !pushed && isShown) showProof(device, standing);
      if (device && pushed) showDetails(pushed, device, standing, warnings, isChanged, lastPushed, isReplaced, units, designs);
    },
  };
}

/** How the head of a report is written, and what it says.
 * @type {Record<Standing, [string, string]>} */
const HEADS = {
  none: ['verified', 'Read back as sent'],
  restarting: ['', 'Restarts to prove it is stored'],
  pending: ['verified', 'Read back as sent'],
  stored: ['verified', 'Stored, as a start has shown'],
  others: ['differs', 'Not as written since its start'],
};
/** @type {Record<Standing, string>} */
const STORED_CLASSES = { none: '', restarting: 'doing', pending: '', stored: 'done', others: 'failed' };

/** What a start has shown: what was stored, and what is another, with both values in the controller's own terms.
 * @param {import('../../model/types.js').Proof | null} proof @returns {HTMLElement[]} */
function proofLines(proof) {
  if (proof === null) return [];
  const rows = proof.others.map(({ name, written, now }) =>
    element('tr', {}, figureHead(name, ''), figureCell(written), figureCell(now ?? 'not there', null, 'differs')),
  );
  const head = tableHead([unseen('setting'), 'written', 'since its start']);
  return [
    ...(rows.length === 0 ? [] : [element('table', { className: 'others-found' }, head, element('tbody', {}, ...rows))]),
    ...(proof.stored === null ? [] : [element('p', { className: 'reason', textContent: proof.stored })]),
  ];
}

/** @param {import('../../model/types.js').PushItem} item @param {ReturnType<typeof figuresOf>} figures */
function reportRow(item, { unit, write }) {
  const isSame = item.sent === item.read_back;
  return element(
    'tr',
    {},
    figureHead(item.name, unit, item.own),
    figureCell(write(item.requested)),
    figureCell(write(item.sent), item.own?.sent),
    figureCell(item.read_back === null ? 'unreadable' : write(item.read_back), item.own?.on_device),
    element(
      'td',
      { className: isSame ? 'same' : 'differs' },
      icon(isSame ? 'ok' : 'error'),
      element('span', { className: 'unseen', textContent: isSame ? 'as sent' : 'not as sent' }),
    ),
  );
}
