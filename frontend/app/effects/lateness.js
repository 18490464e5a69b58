// @ts-check
// When an answer keeps us waiting: what is shown until it comes is of something earlier.

// What is older than that is shown to be: sooner it would flicker under a slider.
const LATE_AFTER_MS = 300;

/** @param {() => void} tell what was asked about last is not answered in time */
export function createLateness(tell) {
  /** What was asked about last, and what the newest answer is about.
   * @type {{asked: unknown, told: unknown}} */
  const about = { asked: null, told: null };
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  let late;

  /** What is answered already, and asked for in another way, is waited for in silence. */
  function wait() {
    if (about.asked !== about.told) late ??= setTimeout(tell, LATE_AFTER_MS);
  }

  function end() {
    clearTimeout(late);
    late = undefined;
  }

  return {
    /** @param {unknown} what */
    asked(what) {
      about.asked = what;
      wait();
    },
    /** @param {unknown} what */
    answered(what) {
      end();
      about.told = what;
      wait();
    },
    /** Nothing is waited for any more. */
    forget() {
      end();
      [about.asked, about.told] = [null, null];
    },
  };
}
