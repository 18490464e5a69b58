// @ts-check
// What a motor moves something with, and what that begins with. Forces and masses there become torques and inertias at the
// shaft where the server computes.

/** @typedef {import('./types.js').Design} Design */
/** @typedef {import('./types.js').Entry} Entry */
/** A mechanism as the page offers it.
 * fields: those of its own besides its name; begins: with what those do that have to be there.
 * @typedef {{name: string, label: string, fields: string[], begins: (design: Design) => Record<string, Entry>}} Mechanism */

const USUAL_LEAD_MM = 8;
const USUAL_PULLEY_MM = 12.73;
const USUAL_MASS_KG = 1;
const POINTER_G_CM2 = 2;
const FIGURES = 4;

/** @type {Mechanism[]} */
export const MECHANISMS = [
  {
    name: 'screw',
    label: 'a screw',
    fields: ['lead_mm', 'mass_kg', 'friction_n', 'efficiency', 'incline_deg'],
    begins: (design) => ({ lead_mm: wayOfATurn(design) ?? USUAL_LEAD_MM, mass_kg: USUAL_MASS_KG }),
  },
  {
    name: 'belt',
    label: 'a belt',
    fields: ['pulley_mm', 'mass_kg', 'friction_n', 'incline_deg'],
    begins: (design) => ({ pulley_mm: tidied((wayOfATurn(design) ?? 0) / Math.PI) || USUAL_PULLEY_MM, mass_kg: USUAL_MASS_KG }),
  },
  { name: 'pointer', label: 'a pointer', fields: ['inertia_g_cm2'], begins: () => ({ inertia_g_cm2: POINTER_G_CM2 }) },
];

/** @param {string | undefined} name @returns {string[]} none where there is no such mechanism */
export const fieldsOfMechanism = (name) => MECHANISMS.find((one) => one.name === name)?.fields ?? [];

/** The design with another mechanism, which keeps what both have; '': what is moved is at the shaft itself.
 * @param {Design} design @param {string} name @returns {Design} */
export function withMechanism(design, name) {
  const { mechanism: before, ...load } = design.load ?? {};
  if (name === (before?.name ?? '')) return design;
  const chosen = MECHANISMS.find((one) => one.name === name);
  if (chosen === undefined) return { ...design, load };
  const kept = Object.fromEntries(Object.entries(before ?? {}).filter(([field]) => chosen.fields.includes(field)));
  return { ...design, load: { ...load, mechanism: { name, ...chosen.begins(design), ...kept } } };
}

/** How far the axis goes in a turn of the motor [mm]; null: that isn't known in millimetres.
 * @param {Design} design */
function wayOfATurn({ axis: { travel_per_rev, travel_unit } }) {
  return travel_unit === 'mm' && Number(travel_per_rev) > 0 ? Number(travel_per_rev) : null;
}

/** @param {number} value */
const tidied = (value) => Number(value.toPrecision(FIGURES));
