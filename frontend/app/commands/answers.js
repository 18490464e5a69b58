// @ts-check
// What the server answers, as it comes.

/** @typedef {import('../../model/types.js').Answer} Answer */
/** @typedef {import('../../model/types.js').Rejection} Rejection */
/** @typedef {import('../state.js').Answers} Answers */
/** @typedef {import('../state.js').State} State */

/** So many pictures of an axis are kept over one thing: what is undone, or tried in turn, has its own back. */
const MOST_PICTURES = 4;
/** So many maps are kept; the one that nothing has come of for longest is forgotten. */
const MOST_MAPS = 12;

/** @param {State} state @param {Partial<Answers>} known @returns {State} */
const knowing = (state, known) => ({ ...state, answers: { ...state.answers, ...known } });

/** @param {State} state @param {Answer} curves @param {number} of the axis that they are of @returns {State} */
export function curvesCame(state, curves, of) {
  const { [of]: _, ...refused } = state.answers.refused;
  return knowing(state, { curves, of, about: of, staleness: null, rejections: [], refused });
}

/** The design is refused: the curves are those of an earlier one.
 * @param {State} state @param {Rejection[]} rejections @param {import('../../model/types.js').Design} design that is refused
 * @param {number} of the axis that it is of @returns {State} */
export const curvesRefused = (state, rejections, design, of) =>
  knowing(state, { about: of, staleness: 'refused', rejections, refused: { ...state.answers.refused, [of]: design } });

/** The answer about the design in hand keeps us waiting: what is shown is of an earlier one.
 * @param {State} state @returns {State} */
export const curvesAwaited = (state) => knowing(state, { about: null });

/** Nobody answers, or the server can't just now: the same is asked again.
 * @param {State} state @param {number} of the axis that was asked about @param {Rejection[]} [rejections] why it can't
 * @returns {State} */
export const curvesMissed = (state, of, rejections = []) => knowing(state, { about: of, staleness: 'unanswered', rejections });

/** @param {State} state @param {import('../../model/types.js').Design} design that is pinned
 * @param {Answer | null} curves null: the server refuses it @returns {State} */
export const pinnedCame = (state, design, curves) => knowing(state, { pinned: { design, curves } });

/** @param {State} state @param {import('../state.js').AllAxes} allAxes @returns {State} */
export const allAxesCame = (state, allAxes) => knowing(state, { allAxes, axesStaleness: null });

/** The answer about all axes keeps us waiting: what is shown of them is of earlier designs.
 * @param {State} state @returns {State} */
export const allAxesAwaited = (state) => knowing(state, { axesStaleness: 'awaited' });

/** Nobody answers about all axes: the same is asked again.
 * @param {State} state @returns {State} */
export const allAxesMissed = (state) => knowing(state, { axesStaleness: 'unanswered' });

/** What a controller of a family really plays of a design.
 * @param {State} state @param {Answers['ownRamp']} ownRamp  null: it plays what is planned, or nobody knows
 * @returns {State} */
export const ownRampCame = (state, ownRamp) => (state.answers.ownRamp === ownRamp ? state : knowing(state, { ownRamp }));

/** What the motor does with a design; null: it can't be told, the design is refused or nobody answers.
 * @param {State} state @param {import('../../model/types.js').Design} design @param {import('../../model/types.js').MotorAnswer | null} answer
 * @param {Rejection[]} rejections @param {number} of the axis that it is of @returns {State} */
export const motorCame = (state, design, answer, rejections, of) => knowing(state, { motor: { design, of, answer, rejections } });

/** What is known anew of a stall map; result: of the design that is asked about now.
 * @typedef {Partial<import('../../model/types.js').StallMap> & {result?: import('../../model/types.js').MapResult | null}} KnownOfMap */

/** What is known anew of the stall map of an axis: a picture takes the place of the one of the same design.
 * @param {State} state @param {number} axis its id @param {import('../../model/types.js').Over} over
 * @param {KnownOfMap} known the first time all of it @returns {State} */
export function stallMapCame(state, axis, over, { result, ...known }) {
  const name = `${axis} ${over}`;
  const { [name]: before, ...others } = state.stallMaps;
  const map = { ...before, ...known };
  const pictures = before?.pictures ?? [];
  map.pictures = result ? [{ key: map.key, result }, ...pictures.filter(({ key }) => key !== map.key)].slice(0, MOST_PICTURES) : pictures;
  return { ...state, stallMaps: Object.fromEntries([...Object.entries(others), [name, map]].slice(-MOST_MAPS)) };
}

/** @param {State} state @param {import('../../model/types.js').Example[]} examples @returns {State} */
export const examplesCame = (state, examples) => ({ ...state, examples });
