// @ts-check
// What a person works on: up to four designs as axes of one machine, one of them in hand, one design kept to compare
// with, and the history of all of it. Knows no page.

/** @typedef {import('./types.js').Design} Design */
/** @typedef {'independent' | 'line'} Together */
/** @typedef {{axes: Design[], together: Together}} Work   what is saved and shared */
/** @typedef {Work & {active: number, kept: Design | null}} State */

export const MOST_AXES = 4;
// As many steps back as anybody goes, and never so many that the browser's memory fills.
const MOST_STEPS_BACK = 500;

/** @param {State} one @param {State} other */
function areSame(one, other) {
  return JSON.stringify(one) === JSON.stringify(other);
}

/** @param {State} first @param {() => void} onChange */
export function createWorkbench(first, onChange) {
  let state = first;
  /** @type {State[]} */
  let past = [];
  /** @type {State[]} */
  let future = [];
  /** The gesture that the last change was a part of; '' when it stood alone. */
  let lastGesture = '';

  /** @param {State} next @param {string} [gesture] */
  function change(next, gesture = '') {
    const goesOn = gesture !== '' && gesture === lastGesture;
    if (!goesOn) past = [...past, state].slice(-MOST_STEPS_BACK);
    // A gesture that ends where it began, as a drag that is given up, was none.
    const isTakenBack = goesOn && areSame(next, past[past.length - 1]);
    state = isTakenBack ? /** @type {State} */ (past.pop()) : next;
    lastGesture = isTakenBack ? '' : gesture;
    future = [];
    onChange();
  }

  /** @param {State[]} from @param {State[]} to @returns {boolean} whether there was a step */
  function step(from, to) {
    const next = from.pop();
    if (next === undefined) return false;
    to.push(state);
    state = next;
    lastGesture = '';
    onChange();
    return true;
  }

  /** The machine as nobody has designed it yet is no state: there is at least one axis. */
  const within = (/** @type {number} */ axis, /** @type {number} */ count) => Math.min(Math.max(axis, 0), count - 1);

  return {
    state: () => state,
    design: () => state.axes[state.active],
    /** @returns {Work} */
    work: () => ({ axes: state.axes, together: state.together }),

    /** The design in hand becomes another. Changes in a row that are one gesture are undone as one.
     * @param {Design} design @param {string} [gesture] such as "slide:ramp.slew_speed_steps_per_s" */
    edit(design, gesture = '') {
      change({ ...state, axes: state.axes.with(state.active, design) }, gesture);
    },
    /** A gesture has ended: the next change is undone by itself, whatever it is. */
    endGesture() {
      lastGesture = '';
    },
    /** All axes at once: a file, a link, an example.
     * @param {Work} work */
    replace({ axes, together }) {
      change({ ...state, axes, together, active: 0 });
    },

    undo: () => step(past, future),
    redo: () => step(future, past),
    canUndo: () => past.length > 0,
    canRedo: () => future.length > 0,

    /** Another axis after the last one, alike the one in hand. Nothing happens when there are four. */
    addAxis() {
      if (state.axes.length === MOST_AXES) return;
      const copy = structuredClone(state.axes[state.active]);
      change({ ...state, axes: [...state.axes, copy], active: state.axes.length });
    },
    /** @param {number} axis the last one stays */
    removeAxis(axis) {
      if (state.axes.length === 1) return;
      const axes = state.axes.toSpliced(axis, 1);
      change({ ...state, axes, active: within(state.active - Number(axis < state.active), axes.length) });
    },
    /** Another axis in hand: no step of the history, as nothing is changed by it.
     * @param {number} axis */
    choose(axis) {
      state = { ...state, active: within(axis, state.axes.length) };
      lastGesture = '';
      onChange();
    },
    /** @param {Together} together */
    setTogether(together) {
      if (together !== state.together) change({ ...state, together });
    },
    /** The design in hand is kept, to compare the next ones with. */
    keep() {
      change({ ...state, kept: state.axes[state.active] });
    },
    /** Nothing is kept any more. */
    forget() {
      if (state.kept !== null) change({ ...state, kept: null });
    },
  };
}
