// @ts-check
// Stall maps: computed by the server as jobs, one at a time, asked about while they run, and kept over a reload. What is asked
// for no more is ended, also where its answer is still on its way.

import { keepMaps } from '../../documents/stall_maps.js';
import { mapKey } from '../../model/stall_map.js';
import { api, Ended, isForLater, Refusal, ServerGone } from '../../server/api.js';
import { stallMapCame } from '../commands/answers.js';
import { axisOf, designOf } from '../selectors.js';
import { whenChanged } from '../state.js';
import { laterText } from './question.js';

/** @typedef {import('../../model/types.js').Over} Over */
/** @typedef {import('../../model/types.js').StallMap} StallMap */
/** Whose map is computed; ended: nobody waits for it any more.
 * @typedef {{axis: number, over: Over, ended: AbortController}} Asked */

const ASKED_EACH_MS = 250;
const PAUSE_MS = 2_000;

/** @param {import('../state.js').Store} store @param {string} tab its id
 * @param {Pick<typeof api, 'beginMap' | 'job' | 'cancelJob'>} [ask] */
export function createStallMaps({ state, dispatch, subscribe }, tab, ask = api) {
  /** @type {Asked | null} */
  let present = null;

  /** Of what nobody waits for nothing is told.
   * @param {Asked} asked @param {import('../commands/answers.js').KnownOfMap} known */
  function tell({ axis, over, ended }, known) {
    if (!ended.signal.aborted) dispatch(stallMapCame, axis, over, known);
  }

  /** Nobody waits for the map any more: its picture stays as far as it is.
   * @param {number} axis @param {Over} over */
  function cancel(axis, over) {
    if (present?.axis !== axis || present.over !== over) return;
    tell(present, { stage: 'cancelled', waitsFor: '' });
    present.ended.abort();
    present = null;
  }

  /** Compute the map of the design in hand.
   * @param {Over} over */
  function compute(over) {
    const [design, axis] = [designOf(state()), axisOf(state())];
    if (design === null || axis === null) return;
    if (present) cancel(present.axis, present.over);
    const asked = begin(axis, over);
    tell(asked, { key: mapKey(design, over), over, id: null, stage: 'running', waitsFor: '', progress: 0, rejections: [] });
    follow(asked, () => ask.beginMap(design, over));
  }

  /** @param {number} axis @param {Over} over */
  function begin(axis, over) {
    present = { axis, over, ended: new AbortController() };
    return present;
  }

  /** Ask about a job until it has ended, or nobody waits for it. Its beginning isn't broken off: then nobody would know which
   * job to end.
   * @param {Asked} asked @param {() => Promise<{id: string}>} start */
  async function follow(asked, start) {
    const { signal } = asked.ended;
    /** @type {string | null} */
    let id = null;
    let isOver = false;
    while (!signal.aborted && !isOver) {
      try {
        if (id === null) {
          ({ id } = await start());
          tell(asked, { id, waitsFor: '' });
        } else {
          isOver = take(asked, await ask.job(id, signal));
          if (!isOver) await pause(ASKED_EACH_MS, signal);
        }
      } catch (error) {
        if (isForLater(error)) {
          tell(asked, { waitsFor: laterText(error) });
          await pause(PAUSE_MS, signal);
        } else if (error instanceof Refusal) {
          isOver = true;
          tell(asked, { stage: 'failed', waitsFor: '', rejections: error.rejections });
        } else if (!(error instanceof Ended)) throw error;
      }
    }
    if (present === asked) present = null;
    if (id !== null && !isOver) await end(id);
  }

  /** @param {Asked} asked @param {import('../../model/types.js').MapJob} job @returns {boolean} whether it has ended */
  function take(asked, { state: now, progress, result, errors }) {
    const isOver = now !== 'waiting' && now !== 'running';
    tell(asked, { progress, stage: isOver ? now : 'running', waitsFor: '', result, rejections: errors ?? [] });
    return isOver;
  }

  /** @param {string} id */
  async function end(id) {
    try {
      await ask.cancelJob(id);
    } catch (error) {
      // It ends by itself: nobody asks about it any more.
      if (!(error instanceof Refusal || error instanceof ServerGone)) throw error;
    }
  }

  subscribe(whenChanged((now) => [now.stallMaps], (maps) => keepMaps(tab, maps), state()));
  // What ran when the page was left goes on.
  for (const [key, { id, over, stage }] of Object.entries(state().stallMaps)) {
    if (stage !== 'running') continue;
    const axis = Number(key.split(' ')[0]);
    if (id === null) dispatch(stallMapCame, axis, over, { stage: 'cancelled' });
    else follow(begin(axis, over), async () => ({ id }));
  }
  return { computeMap: compute, cancelMap: cancel };
}

/** @param {number} ms @param {AbortSignal} ended before that */
function pause(ms, ended) {
  return new Promise((resolve) => {
    ended.addEventListener('abort', resolve);
    setTimeout(resolve, ms);
  });
}
