// @ts-check
// The bar at the foot: what the cursor reads, how to zoom, and whether the server is there.

import { curvesOf } from '../../app/selectors.js';
import { whenChanged } from '../../app/state.js';
import { element } from '../../ui/dom.js';
import { formatFigures, formatFixed } from '../../model/numbers.js';
import { shownValue, unitWord } from '../../model/units.js';

const SERVER_WORDS = {
  there: 'server connected',
  silent: 'Server silent: what is shown is old',
  gone: 'Server gone: trying again…',
  unknown: 'Server started anew: open the link that it printed',
};

const KEEPING_WORDS = {
  kept: 'saved in this browser',
  full: 'not saved: this browser has no room left',
  refused: 'not saved: this browser keeps nothing',
};

/** @param {HTMLElement} root */
export function createStatus(root) {
  const reading = element('span', { className: 'reading' });
  const kept = element('span', { className: 'kept not-short' });
  const server = element('span', { className: 'server', id: 'server-state', role: 'status' });
  root.replaceChildren(
    reading,
    element('span', { className: 'grow' }),
    element('span', { className: 'wide-only', textContent: 'Wheel zooms, drag selects, double-click shows all, or adds a row in the delay plot' }),
    element('span', { className: 'grow wide-only' }),
    kept,
    server,
  );

  /** @param {string} label @param {string} value */
  const part = (label, value) => element('span', {}, `${label} `, element('b', { textContent: value }));

  /** @param {import('../../plotting/curves.js').Reading | null} at @param {import('../../model/types.js').Design | null} design
   * @param {import('../../model/units.js').Units} units */
  function showReading(at, design, units) {
    const own = at?.methods.find((one) => one.method === design?.method.name);
    if (!at || !own || !design) {
      reading.replaceChildren('Point at a plot to read it');
      return;
    }
    const error = Number.isFinite(own.percent) ? [part('error', `${formatFixed(own.percent, 2)} %`)] : [];
    reading.replaceChildren(
      part('Step', formatFixed(at.step)),
      part('t', `${formatFixed(at.time_s * 1e3, 2)} ms`),
      part('delay', `${formatFixed(own.ticks)} ticks = ${formatFixed(own.delay_us, 1)} µs`),
      part('', `${formatFigures(shownValue(units, design, 'speed', own.speed))} ${unitWord(units, design, 'speed')}`),
      ...error,
    );
  }

  const shows = [
    whenChanged((state) => [state.reading, curvesOf(state)?.design ?? null, state.units], showReading),
    whenChanged(
      ({ devices }) => [devices.link],
      (link) => {
        server.classList.toggle('gone', link !== 'there');
        server.textContent = SERVER_WORDS[link];
      },
    ),
    whenChanged(
      ({ told }) => [told.keeping],
      (keeping) => {
        if (keeping !== null) kept.textContent = KEEPING_WORDS[keeping];
      },
    ),
  ];

  return {
    /** @param {import('../../app/state.js').State} state */
    show(state) {
      for (const show of shows) show(state);
    },
  };
}
