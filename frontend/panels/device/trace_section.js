// @ts-check
// The trace: whether moves are measured, and what the last one says in figures. The plots show the rest.

import { element } from '../../ui/dom.js';
import { formatFigures, formatFixed } from '../../model/numbers.js';
import { can } from './section.js';

/** @typedef {import('../../model/types.js').Device} Device */
/** @typedef {import('./section.js').Context} Context */

/** @param {(wanted: boolean) => void} onTrace @param {{saveTrace: (device: Device) => void, keepTrace: (trace: import('../../model/types.js').Trace) => void}} act */
export function createTraceSection(onTrace, act) {
  /** @type {Device | null} */
  let device = null;
  const box = element('input', { type: 'checkbox', id: 'trace', onchange: () => onTrace(box.checked) });
  const figures = element('dl', { className: 'trace-figures', id: 'trace-figures' });
  const note = element('p', { className: 'reason', id: 'trace-note' });
  const save = element('button', {
    className: 'button small',
    id: 'trace-save',
    type: 'button',
    textContent: 'Save as CSV',
    title: 'When each step was made, as logic analysers save it: it can be opened here, too',
    onclick: () => device && act.saveTrace(device),
  });

  /** @type {import('../../model/types.js').Trace | null} */
  let present = null;
  const keep = element('button', {
    className: 'button small',
    id: 'trace-keep',
    type: 'button',
    textContent: 'Keep in library',
    title: 'With the design that was moved',
    onclick: () => present && act.keepTrace(present),
  });

  /** @param {import('../../model/types.js').Trace} trace */
  function figuresOf(trace) {
    const last = trace.measured_ticks.length - 1;
    const duration = last < 0 ? 0 : trace.measured_ticks[last] / trace.timer_hz;
    const latest = Math.max(0, ...trace.deviation_us);
    const earliest = Math.min(0, ...trace.deviation_us);
    return [
      ['Axis', String(trace.traced_axis)],
      ['Steps measured', `${formatFixed(trace.step.length)}, ${everyWord(trace.every_steps)}`],
      ['From first to last', `${formatFigures(duration, 5)} s`],
      ['Latest', `${formatFigures(latest, 3)} µs`],
      ['Earliest', `${formatFigures(earliest, 3)} µs`],
    ];
  }

  return {
    element: element(
      'div',
      { className: 'section' },
      element('label', { className: 'line check' }, box, element('span', { textContent: 'Measure moves begun here' })),
      figures,
      element('div', { className: 'line' }, save, keep),
      note,
    ),
    /** @param {Context} context */
    show(context) {
      const { known, situation } = context;
      device = known;
      box.disabled = !can(context, 'trace');
      box.checked = situation.isTracing && !box.disabled;
      const { trace } = situation;
      const shown = trace ? figuresOf(trace) : [];
      present = trace;
      save.hidden = trace === null;
      keep.hidden = trace === null || !situation.mayAct;
      save.disabled = situation.isBusy;
      const text = JSON.stringify(shown);
      if (figures.dataset.known !== text) {
        figures.dataset.known = text;
        figures.replaceChildren(
          ...shown.flatMap(([name, value]) => [
            element('dt', { textContent: name }),
            element('dd', { textContent: value }),
          ]),
        );
      }
      note.textContent = box.disabled
        ? 'This controller can’t tell when it made its steps.'
        : !trace
          ? 'The controller tells when it made each step of a move that begins at rest; the plots lay that over the plan.'
          : trace.changed
            ? 'The move was changed on its way: the trace ends there.'
            : trace.complete
              ? ''
              : 'The end of the trace did not come.';
      note.hidden = note.textContent === '';
    },
  };
}

/** @param {number} every */
function everyWord(every) {
  return every === 1 ? 'every one' : `one of ${formatFixed(every)}`;
}
