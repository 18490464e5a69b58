// @ts-check
// How old what is known of devices is, by the server's clock: it tells how old that was when it told of it, and the page
// adds the time since, and that until it is told again: it is never shown as younger than it is. What a controller at rest says is half a second old at most, and the server tells each second.

/** @typedef {import('../model/types.js').Device} Device */

/** From this age on what is known is old [s]. */
export const OLD_S = 2;
/** So often it is told anew [s]. */
export const TOLD_EACH_S = 0.25;
const MINUTE_S = 60;

export function createAges() {
  /** @type {{id: string, at_s: number}[]} */
  let heard = [];

  return {
    /** Take note of all devices, told of just now.
     * @param {Device[]} devices @param {number} now_s */
    hear(devices, now_s) {
      heard = devices.flatMap(({ id, state, age_s }) => {
        // What is being written is talked with all the time, and rests meanwhile.
        const age = state === 'writing' ? 0 : age_s;
        return age === null ? [] : [{ id, at_s: now_s - age }];
      });
    },
    /** Those of which nothing new is known, and for how long.
     * @param {number} now_s @returns {Record<string, number>} whole seconds, by device */
    old(now_s) {
      const old = heard.filter(({ at_s }) => now_s - at_s >= OLD_S);
      return Object.fromEntries(old.map(({ id, at_s }) => [id, Math.ceil(now_s - at_s + TOLD_EACH_S)]));
    },
  };
}

/** @param {number} seconds */
export function agoText(seconds) {
  return seconds < 2 * MINUTE_S ? `${seconds} s ago` : `${Math.ceil(seconds / MINUTE_S)} min ago`;
}
