// @ts-check
// The ramp methods that the page knows, in the order of the legend, and the arithmetic each can be computed in.

/** @typedef {import('./types.js').MethodName} MethodName */

// Arithmetics with the usual one first: step by step, errors add up, and the target most often has C float.
const CLOSED_FORM = ['float64', 'float32'];
const STEP_BY_STEP = ['float32', 'float64', 'fixed'];
// Austin's recurrence divides at each step, which the integers of a small chip do without.
const WITH_DIVISION = ['float32', 'float64'];

/** @type {{name: MethodName, label: string, formula: string, arithmetic: string[], help: string}[]} */
export const METHODS = [
  {
    name: 'exact',
    label: 'Exact',
    formula: '9',
    arithmetic: CLOSED_FORM,
    help: 'Every interval from the square root: the reference that the others are held against. Dear on a small chip.',
  },
  {
    name: 'ideal',
    label: 'Ideal',
    formula: '',
    arithmetic: CLOSED_FORM,
    help: 'The true instants of constant acceleration. From rest its first interval is twice that of the exact formula.',
  },
  {
    name: 'midpoint',
    label: 'Midpoint',
    formula: '',
    arithmetic: CLOSED_FORM,
    help: 'Each interval from the speed at the centre of its step. From the second step on it is close to ideal.',
  },
  {
    name: 'first_order',
    label: '1st order',
    formula: '20',
    arithmetic: STEP_BY_STEP,
    help: 'Each interval from the one before with three multiplications. From rest it errs most in its first steps.',
  },
  {
    name: 'second_order',
    label: '2nd order',
    formula: '22',
    arithmetic: STEP_BY_STEP,
    help: 'As 1st order with one term more: p (1 + q + 1.5 q²). From rest its first intervals come out too long.',
  },
  {
    name: 'compromise',
    label: 'Compromise',
    formula: '23',
    arithmetic: STEP_BY_STEP,
    help: 'As 2nd order without the factor 1.5: p (1 + q + q²). It errs between 1st and 2nd order.',
  },
  {
    name: 'tuned',
    label: 'Tuned',
    formula: '',
    arithmetic: STEP_BY_STEP,
    help: 'p (1 + q + c q²) with the c that suits this ramp, found anew for each: a constant to the chip.',
  },
  {
    name: 'newton',
    label: 'Newton',
    formula: '',
    arithmetic: STEP_BY_STEP,
    help: 'Keeps w = v² by addition and corrects p with one Newton step. Errors shrink from step to step.',
  },
  {
    name: 'austin',
    label: 'Austin',
    formula: '',
    arithmetic: WITH_DIVISION,
    help: 'The ramp of Atmel’s application note AVR446: each interval from the one before with one division.',
  },
  {
    name: 'table',
    label: 'Table',
    formula: '',
    arithmetic: CLOSED_FORM,
    help: 'The lookup table: the delay of a step is that of the first row that reaches it. Cheapest on the chip.',
  },
];

/** The method that the others are held against.
 * @type {MethodName} */
export const REFERENCE = 'exact';

/** What is shown until a person chooses.
 * @type {MethodName[]} */
export const SHOWN_AT_FIRST = ['exact', 'first_order', 'second_order', 'compromise', 'newton', 'table'];

/** @param {MethodName} name */
export function methodOf(name) {
  return METHODS.find((method) => method.name === name) ?? METHODS[0];
}
