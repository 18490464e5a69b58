// @ts-check
// The dialog of the stall map: computed when it is asked for, kept with its axis, and grey when the design is another. The design
// is a point on it, which can be dragged.

import { endGesture, setValues } from '../../app/commands/work.js';
import { mayKeep } from '../../app/library.js';
import { axisOf, designOf, motorOf } from '../../app/selectors.js';
import { whenever } from '../../app/state.js';
import { textOf } from '../../model/messages.js';
import { NOT_COVERED, VERDICTS } from '../../model/motor_words.js';
import { changesTo, MAP_VERDICTS, mapKey, mapText, overOf, OVERS, pictureOf, placeOf, UNKNOWN, verdictAt } from '../../model/stall_map.js';
import { SLIDE_GESTURE, STEP_GESTURE } from '../../model/workbench.js';
import { createDialog, dialogFoot } from '../../ui/dialog.js';
import { element, icon, messageLine, segmented, showText } from '../../ui/dom.js';
import { createMapChart, legendSwatch, placeText } from './map_chart.js';

/** @typedef {import('../../model/types.js').Design} Design */
/** @typedef {import('../../model/types.js').MapResult} MapResult */
/** @typedef {import('../../model/types.js').Over} Over */
/** @typedef {import('../../model/types.js').StallMap} StallMap */
/** @typedef {import('../../app/state.js').State} State */

const POINT = 'stall-map';
/** Of each verdict, after its name. */
const MEANINGS = [': no step is lost', ': nearly lost, or too little torque kept back', ': steps are lost', ': refused, as beyond the timer'];

/** @param {import('../../app/state.js').Dispatch} dispatch
 * @param {{computeMap: (over: Over) => void, cancelMap: (axis: number, over: Over) => void}
 *   & Pick<import('../../app/effects/library.js').LibraryActions, 'keepRecord'>} act */
export function createMap(dispatch, { computeMap, cancelMap, keepRecord }) {
  /** @type {State | null} */
  let state = null;
  /** @type {Over} */
  let over = 'slew_speed';
  const choice = segmented('Other axis', OVERS.map(({ name, label }) => [name, label]), choose); // prettier-ignore
  const progress = element('progress', { max: 1, 'aria-label': 'Computed so far' });
  const cancel = element('button', { className: 'button small', type: 'button', textContent: 'Cancel', onclick: stop });
  const running = element('span', { className: 'map-running', hidden: true }, progress, cancel);
  const stale = element('span', { className: 'message warning', role: 'status', hidden: true }, icon('warning'), element('span', { textContent: 'Of an earlier design' }));
  const compute = element('button', { className: 'button small', id: 'compute-map', type: 'button', textContent: 'Compute', onclick: () => computeMap(over) });
  const problem = element('div', { role: 'status' });
  const chart = createMapChart({
    onMove: (place, isStep) => {
      const design = state && designOf(state);
      if (design) dispatch(setValues, changesTo(design, over, place), `${isStep ? STEP_GESTURE : SLIDE_GESTURE}${POINT}`, performance.now());
    },
    onEnd: () => dispatch(endGesture),
  });
  const unknown = element('li', { hidden: true }, legendSwatch(UNKNOWN), element('span', { textContent: 'Not known yet' }));
  const legend = element(
    'ul',
    { className: 'map-legend' },
    ...MAP_VERDICTS.map((text, verdict) => element('li', {}, legendSwatch(verdict), element('span', {}, element('b', { textContent: text }), MEANINGS[verdict]))),
    unknown,
  );
  const readOut = element('p', { className: 'map-read', id: 'map-read', role: 'status' });
  const summary = element('p', { className: 'muted', id: 'map-summary' });
  const close = element('button', { className: 'button', type: 'button', textContent: 'Close', onclick: () => dialog.close() });
  const keep = element('button', {
    className: 'button',
    id: 'map-keep',
    type: 'button',
    textContent: 'Keep in library',
    title: 'With the design that it is of',
    onclick: keepInLibrary,
  });
  const dialog = createDialog(
    { id: 'map-dialog', title: 'Stall map' },
    element('p', {
      className: 'muted',
      textContent:
        'Whether the motor makes the move with other accelerations, and with another speed, load or supply. The ring is the design: drag it, or move it by the arrow keys. Computed only; no device moves.',
    }),
    element('div', { className: 'dialog-row' }, choice.element, element('span', { className: 'map-acts' }, stale, compute, running)),
    problem,
    chart.element,
    legend,
    element('div', { className: 'dialog-row' }, readOut, summary),
    element('p', { className: 'muted', textContent: NOT_COVERED }),
    dialogFoot(null, keep, close),
  );

  function keepInLibrary() {
    const design = state && designOf(state);
    if (!state || !design) return;
    const { result, isOld } = pictureOf(present(), mapKey(design, over));
    if (result && !isOld) keepRecord('stall_map', result, { axis: axisOf(state), design, note: `Over ${overOf(over).label.toLowerCase()}` });
  }

  /** @param {Over} chosen */
  function choose(chosen) {
    over = chosen;
    draw();
    begin();
  }

  function stop() {
    const axis = state && axisOf(state);
    if (axis !== null) cancelMap(axis, over);
    compute.focus();
  }

  /** @returns {StallMap | undefined} */
  const present = () => (state ? state.stallMaps[`${axisOf(state)} ${over}`] : undefined);

  /** Who opens the dialog wants a map: the first one is computed unasked. */
  function begin() {
    if (present() === undefined && state && designOf(state)?.motor !== undefined) computeMap(over);
  }

  function draw() {
    if (state === null || !dialog.isOpen()) return;
    const [design, map] = [designOf(state), present()];
    choice.press(over);
    if (design === null) return;
    const key = mapKey(design, over);
    const isRunning = map?.stage === 'running';
    const { result, isOld } = pictureOf(map, key);
    // Pressed, it gives way to the one that cancels, which gets the focus.
    const hadFocus = document.activeElement === compute;
    running.hidden = !isRunning;
    // One that runs for another design can be left for this one's.
    compute.hidden = isRunning && map.key === key;
    if (compute.hidden && hadFocus) cancel.focus();
    if (isRunning) progress.value = map.progress;
    showText(compute, result && !isOld ? 'Refresh' : 'Compute');
    compute.classList.toggle('primary', isOld || result === null);
    stale.hidden = !isOld;
    keep.hidden = !mayKeep(state) || isOld || result === null || isRunning;
    tellProblem(map?.key === key ? map : undefined, design);
    chart.show(result, isOld, placeOf(design, over), state.units, design, over);
    unknown.hidden = !result?.verdicts.some((row) => row.includes(UNKNOWN));
    tellPoint(result, isOld, design);
  }

  /** @param {StallMap | undefined} map of the design @param {Design} design */
  function tellProblem(map, design) {
    const text =
      design.motor === undefined
        ? 'The design has no motor.'
        : map?.stage === 'failed'
          ? textOf(map.rejections) || 'The map could not be computed.'
          : map?.stage === 'cancelled'
            ? `Cancelled: ${map.pictures.some((one) => one.key === map.key) ? 'what was computed until then is shown' : 'nothing was computed until then'}.`
            : (map?.waitsFor ?? '');
    if (problem.textContent !== text) problem.replaceChildren(...(text === '' ? [] : [messageLine({ text, isWarning: map?.stage === 'cancelled' })]));
  }

  /** @param {MapResult | null} result @param {boolean} isOld @param {Design} design */
  function tellPoint(result, isOld, design) {
    if (state === null) return;
    const at = placeText(placeOf(design, over), over, state.units, design);
    const played = motorOf(state);
    const now = played?.answer && played.design === design ? VERDICTS[played.answer.verdict] : null;
    const onMap = result ? verdictAt(result, placeOf(design, over)) : null;
    const said = now ?? (isOld || onMap === null || onMap === UNKNOWN ? '…' : MAP_VERDICTS[onMap]);
    showText(readOut, `${said} at ${at}`);
    readOut.dataset.verdict = said.toLowerCase();
    showText(summary, result ? mapText(result.verdicts, isOld) : '');
  }

  const shows = [whenever((now) => [now.stallMaps, designOf(now), axisOf(now), now.units, motorOf(now), mayKeep(now)], draw)];

  return {
    /** @param {Over} [wanted] */
    open(wanted = over) {
      over = wanted;
      dialog.open();
      draw();
      begin();
    },
    /** @param {State} now */
    show(now) {
      state = now;
      for (const show of shows) show(now);
    },
  };
}
