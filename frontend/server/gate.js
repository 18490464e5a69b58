// @ts-check
// A gate that only so many pass at a time; the others stand in line before it.

/** @param {number} most how many may be under way */
export function createGate(most) {
  let underWay = 0;
  /** @type {(() => void)[]} */
  const line = [];

  /** @returns {Promise<void>} */
  function enter() {
    if (underWay === most) return new Promise((resolve) => line.push(resolve));
    underWay += 1;
    return Promise.resolve();
  }

  function leave() {
    const next = line.shift();
    if (next) next();
    else underWay -= 1;
  }

  /** Do a job as soon as it may pass.
   * @template T @param {() => Promise<T>} job @returns {Promise<T>} */
  return async (job) => {
    await enter();
    try {
      return await job();
    } finally {
      leave();
    }
  };
}
