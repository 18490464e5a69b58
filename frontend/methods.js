// @ts-check
// The ramp methods that the page knows, in the order of the legend, and the arithmetic each can be computed in.

/** @typedef {import('./types.js').MethodName} MethodName */

/** @type {{name: MethodName, label: string, formula: string, arithmetic: string[], help: string}[]} */
export const METHODS = [
  {
    name: 'exact',
    label: 'Exact',
    formula: '9',
    arithmetic: ['float64', 'float32'],
    help: 'Every interval from the square root: the reference that the others are held against. Dear on a small chip.',
  },
  {
    name: 'first_order',
    label: '1st order',
    formula: '20',
    arithmetic: ['float32', 'float64'],
    help: 'Each interval from the one before with three multiplications. From rest it errs most in its first steps.',
  },
  {
    name: 'table',
    label: 'Table',
    formula: '',
    arithmetic: ['float64', 'float32'],
    help: 'The lookup table: the delay of a step is that of the first row that reaches it. Cheapest on the chip.',
  },
];

/** The method that the others are held against. @type {MethodName} */
export const REFERENCE = 'exact';

/** @param {MethodName} name */
export function methodOf(name) {
  return METHODS.find((method) => method.name === name) ?? METHODS[0];
}
