// @ts-check
// One round of questions to the server: a profile of each method shown, and their errors against the exact ramp.

import { api, Refusal } from './api.js';
import { withMethod } from './design.js';
import { REFERENCE } from './methods.js';

/** @typedef {import('./types.js').Answer} Answer */
/** @typedef {import('./types.js').Design} Design */
/** @typedef {import('./types.js').MethodName} MethodName */

// As many points as a wide screen has pixels: more can't be seen.
const MAX_POINTS = 2000;

/**
 * Compute a design with its own method and the others shown.
 * Throws Refusal when the design itself is refused, ServerGone when nobody answers.
 * @param {Design} design
 * @param {MethodName[]} methods without double entries, the design's own and the reference among them
 * @returns {Promise<Answer>}
 */
export async function calculate(design, methods) {
  /** @type {Answer} */
  const answer = { design, profiles: {}, errors: {}, failures: {} };
  const compared = methods.filter((name) => name !== REFERENCE);
  const profiles = methods.map(async (name) => {
    try {
      answer.profiles[name] = await api.profile(withMethod(design, name), MAX_POINTS);
    } catch (error) {
      // Another method may fail where the chosen one works: then only its curve is missing.
      if (name === design.method.name || !(error instanceof Refusal)) throw error;
      answer.failures[name] = error.message;
    }
  });
  await Promise.all([...profiles, compare(answer, compared).catch(unlessRefused)]);
  // The design is sound, so a refusal was one method's: it must not hide the errors of the others.
  const missing = compared.filter((name) => !answer.errors[name]);
  await Promise.all(
    missing.map((name) =>
      compare(answer, [name]).catch((error) => {
        unlessRefused(error);
        answer.failures[name] ??= error.message;
      }),
    ),
  );
  return answer;
}

/** @param {Answer} answer @param {MethodName[]} methods */
async function compare(answer, methods) {
  if (methods.length === 0) return;
  const { methods: curves } = await api.errors(answer.design, methods, REFERENCE, MAX_POINTS);
  for (const curve of curves) answer.errors[curve.method] = curve;
}

/** @param {unknown} error */
function unlessRefused(error) {
  if (!(error instanceof Refusal)) throw error;
}
