// @ts-check
// The dialog of measured steps: the file that a logic analyser wrote, what is taken of it, and what it says of the ramp.

import { removeCapture, showCapture, wishCapture } from '../../app/commands/capture.js';
import { mayKeep } from '../../app/library.js';
import { isCaptureStale, machineOf, shownCaptureOf } from '../../app/selectors.js';
import { whenChanged } from '../../app/state.js';
import { formatBytes } from '../../documents/exports.js';
import { formatFixed } from '../../model/numbers.js';
import { createDialog, dialogFoot } from '../../ui/dialog.js';
import { element, messageLine, showText } from '../../ui/dom.js';
import { createCaptureFields } from './fields.js';
import { createCaptureFigures } from './figures.js';

/** @typedef {import('../../app/state.js').Capture} Capture */

const FORMATS = /** @type {Record<string, string>} */ ({
  saleae_csv: 'CSV of Saleae Logic 2',
  sigrok_csv: 'CSV of sigrok',
  sigrok_session: 'session of sigrok',
  vcd: 'VCD',
});

/** @param {import('../../app/state.js').Dispatch} dispatch @param {{openCaptureFile: () => void, cancel: () => void} & Pick<import('../../app/effects/library.js').LibraryActions, 'keepRecord'>} act */
export function createCapture(dispatch, act) {
  /** @type {import('../../app/state.js').State | null} */
  let state = null;
  const about = element('p', {
    className: 'muted',
    textContent:
      'Lays the steps that a logic analyser saw over the planned ones. It reads CSV of Saleae Logic 2 and sigrok, VCD, and .sr ' +
      'where sigrok-cli is installed. Open a file, or drop it on the page.',
  });
  const file = element('p', { className: 'capture-file', id: 'capture-file' });
  const kept = element('p', {
    className: 'muted',
    id: 'capture-kept',
    textContent: 'The page keeps no capture over a reload: open its file again then.',
  });
  const bar = element('progress', { max: 1, 'aria-label': 'Sending the file' });
  const doing = element('span');
  const cancel = element('button', {
    className: 'button small',
    id: 'capture-cancel',
    type: 'button',
    textContent: 'Cancel',
    onclick: act.cancel,
  });
  const progress = element('div', { className: 'capture-progress', id: 'capture-progress' }, bar, doing, cancel);
  const problems = element('div', { id: 'capture-problems', role: 'alert' });
  const note = element('p', { className: 'muted', id: 'capture-note', role: 'status' });
  const fields = createCaptureFields((wanted) => dispatch(wishCapture, wanted));
  const figures = createCaptureFigures();
  const open = element('button', { className: 'button', id: 'capture-open', type: 'button', onclick: act.openCaptureFile });
  const remove = element('button', {
    className: 'button',
    id: 'capture-remove',
    type: 'button',
    textContent: 'Remove capture',
    onclick: () => dispatch(removeCapture),
  });
  const close = element('button', { className: 'button primary', id: 'capture-close', type: 'button', onclick: () => dialog.close() });
  const keep = element('button', {
    className: 'button',
    id: 'capture-keep',
    type: 'button',
    textContent: 'Keep in library',
    title: 'With the design that it is held against',
    onclick: keepInLibrary,
  });
  const foot = dialogFoot(null, remove, keep, open, close);
  const dialog = createDialog(
    { id: 'capture-dialog', title: 'Measured steps' },
    about,
    file,
    kept,
    progress,
    problems,
    fields.element,
    figures.element,
    note,
    foot,
  );
  dialog.element.addEventListener('close', () => dispatch(showCapture, false));

  /** What was found, with the design that it is of, as it is now: an answer of an earlier one is not offered. */
  function keepInLibrary() {
    const capture = state?.capture;
    if (!state || !capture?.answer) return;
    const { answer, axis, file } = capture;
    const machine = machineOf(state);
    const place = machine ? machine.ids.indexOf(axis) : -1;
    act.keepRecord('capture', answer, { axis: place < 0 ? null : axis, design: machine?.axes[place] ?? null, note: file.name });
  }

  /** @param {Capture} capture */
  function showFile({ file: { name, size }, answer }) {
    const kind = answer && FORMATS[answer.format];
    const rate = answer?.sample_rate_hz ? `, ${formatFixed(answer.sample_rate_hz / 1000)} kHz` : '';
    file.replaceChildren(
      element('b', { textContent: name }),
      element('span', { className: 'muted', textContent: ` ${formatBytes(size)}${kind ? `, ${kind}${rate}` : ''}` }),
    );
  }

  /** @param {Capture} capture */
  function showProgress({ stage, sent }) {
    progress.hidden = stage !== 'asked' && stage !== 'unanswered';
    const isSent = sent >= 1;
    if (isSent || stage === 'unanswered') bar.removeAttribute('value');
    else bar.value = sent;
    const words = isSent ? 'being read …' : `${formatFixed(sent * 100)} % sent`;
    showText(doing, stage === 'unanswered' ? 'The server can’t read it now: tried again.' : words);
  }

  /** What is between the file and what it says of the present design.
   * @param {Capture} capture @param {boolean} isStale */
  function noteOf({ stage, answer, of }, isStale) {
    if (stage === 'cancelled') return 'Cancelled: what is shown was found before. A change asks again.';
    if (of === null && stage === 'answered')
      return 'The design can’t be computed now. Correct what is marked, and these steps are held against it.';
    if (isStale && stage === 'answered') return 'The design can’t be computed now: what is shown was held against an earlier one.';
    if (answer && answer.move === null) return 'There is no step in it: choose another channel.';
    return answer?.remarks.join(' ') ?? '';
  }

  /** @param {Capture | null} capture @param {boolean} isStale @param {boolean} isShown whether the plots show it
   * @param {boolean} isKept whether this page may write to the library */
  function show(capture, isStale, isShown, isKept) {
    const answer = capture?.answer ?? null;
    about.hidden = capture !== null;
    for (const part of [file, remove, close]) part.hidden = capture === null;
    open.textContent = capture === null ? 'Open a file …' : 'Open another file …';
    kept.hidden = !isShown;
    keep.hidden = !isKept || isStale || !answer?.move;
    close.textContent = isShown ? 'Show the plots' : 'Close';
    fields.element.hidden = answer === null;
    figures.element.hidden = !answer?.move;
    progress.hidden = note.hidden = true;
    if (capture === null) {
      problems.replaceChildren();
      return;
    }
    showFile(capture);
    showProgress(capture);
    const others = fields.show(capture);
    problems.replaceChildren(...others.map((text) => messageLine({ text, isWarning: false })));
    if (answer) figures.show(answer, isStale);
    showText(note, noteOf(capture, isStale));
    note.hidden = note.textContent === '';
  }

  const shows = [
    whenChanged(
      (/** @type {import('../../app/state.js').State} */ state) => [state.capture, isCaptureStale(state), shownCaptureOf(state) !== null, mayKeep(state)],
      show,
    ),
    whenChanged(
      ({ isCaptureOpen, capture }) => [isCaptureOpen, capture?.file ?? null],
      (isOpen, present) => {
        if (isOpen && !dialog.isOpen()) dialog.open(present === null ? open : close);
        else if (!isOpen && dialog.isOpen()) dialog.close();
      },
    ),
  ];
  return {
    /** @param {import('../../app/state.js').State} now */
    show(now) {
      state = now;
      for (const one of shows) one(now);
    },
  };
}
