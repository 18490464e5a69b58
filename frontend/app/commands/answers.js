// @ts-check
// What the server answers, as it comes.

/** @typedef {import('../../model/types.js').Answer} Answer */
/** @typedef {import('../../model/types.js').Rejection} Rejection */
/** @typedef {import('../state.js').Answers} Answers */
/** @typedef {import('../state.js').State} State */

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

/** Nobody answers: the same is asked again.
 * @param {State} state @param {number} of the axis that was asked about @returns {State} */
export const curvesMissed = (state, of) => knowing(state, { about: of, staleness: 'unanswered', rejections: [] });

/** @param {State} state @param {import('../../model/types.js').Design} design that is pinned
 * @param {Answer | null} curves null: the server refuses it @returns {State} */
export const pinnedCame = (state, design, curves) => knowing(state, { pinned: { design, curves } });

/** @param {State} state @param {import('../state.js').AllAxes} allAxes @returns {State} */
export const allAxesCame = (state, allAxes) => knowing(state, { allAxes });

/** @param {State} state @param {import('../../model/types.js').Example[]} examples @returns {State} */
export const examplesCame = (state, examples) => ({ ...state, examples });
