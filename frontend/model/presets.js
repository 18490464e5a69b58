// @ts-check
// Motors, axes and timers that many people have: each sets what is a fact of it and leaves alone what is not, such as
// the microsteps, which the driver is set to, and the shortest delay, which is that of a program.

/** @typedef {import('./types.js').Design} Design */
/** @typedef {'axis' | 'timer'} Part */
/** @typedef {{name: string, values: Record<string, number | string>, help: string}} Preset */

/** @type {Record<Part, Preset[]>} */
export const PRESETS = {
  axis: [
    // NEMA 17, 1.8°: 200 full steps. T8 trapezoidal screws: pitch 2 mm, with four starts or one.
    {
      name: 'NEMA 17 · T8 screw, 8 mm',
      values: { full_steps_per_rev: 200, travel_per_rev: 8, travel_unit: 'mm' },
      help: '1.8° motor on a T8 screw with four starts: 2 mm pitch, 8 mm a turn. The microsteps stay as your driver is set.',
    },
    {
      name: 'NEMA 17 · T8 screw, 2 mm',
      values: { full_steps_per_rev: 200, travel_per_rev: 2, travel_unit: 'mm' },
      help: '1.8° motor on a T8 screw with one start: 2 mm a turn. The microsteps stay as your driver is set.',
    },
    // GT2 (2GT) timing belt: 2 mm pitch.
    {
      name: 'NEMA 17 · GT2 belt, 20 teeth',
      values: { full_steps_per_rev: 200, travel_per_rev: 40, travel_unit: 'mm' },
      help: '1.8° motor with a pulley of 20 teeth on a belt of 2 mm pitch: 40 mm a turn. The microsteps stay as your driver is set.',
    },
    {
      name: 'NEMA 17 · direct drive',
      values: { full_steps_per_rev: 200, travel_per_rev: 360, travel_unit: 'deg' },
      help: '1.8° motor with what it turns on its shaft, as a turntable, or nothing yet. The microsteps stay as your driver is set.',
    },
    // Data sheets Switec X25.xxx and Juken X27.xxx: gear 1:180, 315° between the stops; a full step of 1° is three partial
    // steps of 1/3°, what a pin pattern of six states makes; the driver X12.017 makes microsteps of 1/12°.
    {
      name: 'Gauge X25, X27 · ⅓°',
      values: { full_steps_per_rev: 1080, microsteps: 1, travel_per_rev: 360, travel_unit: 'deg' },
      help: 'Dashboard gauge on four pins: partial steps of ⅓°, 945 of them in the 315° between its stops.',
    },
    {
      name: 'Gauge X25, X27 · ¹⁄₁₂°',
      values: { full_steps_per_rev: 1080, microsteps: 4, travel_per_rev: 360, travel_unit: 'deg' },
      help: 'Dashboard gauge behind an X12.017 or AX1201728 driver: microsteps of ¹⁄₁₂°, 3,780 of them in the 315° between its stops.',
    },
    // Data sheet 28BYJ-48: 5.625° / 64 a half step. The teeth of its gear give 1:63.684 (32·22·26·31 / 9·11·9·10).
    {
      name: '28BYJ-48 · full steps',
      values: { full_steps_per_rev: 2048, microsteps: 1, travel_per_rev: 360, travel_unit: 'deg' },
      help: '2,048 full steps a turn of the output by the data sheet. Most gears are 1:63.68, not 1:64: a true turn is 2,037.9.',
    },
    {
      name: '28BYJ-48 · half steps',
      values: { full_steps_per_rev: 2048, microsteps: 2, travel_per_rev: 360, travel_unit: 'deg' },
      help: '4,096 half steps a turn of the output by the data sheet. Most gears are 1:63.68, not 1:64: a true turn is 4,075.8.',
    },
  ],
  timer: [
    // Data sheets ATmega328P and ATmega2560: 16-bit timers, prescaler 1 or 8; both boards run at 16 MHz.
    {
      name: 'Uno, Nano, Mega · 2 MHz',
      values: { frequency_hz: 2_000_000, counter_bits: 16 },
      help: '16 MHz through a prescaler of 8; the longest delay is 32.8 ms. One of the two clocks that StepRamp’s own controller plays.',
    },
    {
      name: 'Uno, Nano, Mega · 16 MHz',
      values: { frequency_hz: 16_000_000, counter_bits: 16 },
      help: 'Without prescaler: eight times as fine, but the longest delay is 4.1 ms. The other clock of StepRamp’s own controller.',
    },
    // i.MX RT1060 reference manual: PIT, 32 bits, from PERCLK, which Teensyduino takes from the 24 MHz crystal.
    {
      name: 'Teensy 4 · 24 MHz',
      values: { frequency_hz: 24_000_000, counter_bits: 32 },
      help: 'The periodic timer behind Teensy’s IntervalTimer: 32 bits, from the 24 MHz crystal.',
    },
    // ESP32 technical reference manual, timer groups: 64 bits, from the 80 MHz APB clock through a prescaler of 2 to 65,536.
    {
      name: 'ESP32 · 40 MHz',
      values: { frequency_hz: 40_000_000, counter_bits: 64 },
      help: 'A timer of the timer groups: 64 bits, from the 80 MHz bus clock through its least prescaler, 2.',
    },
    // RP2040 data sheet: PIO state machines count 32 bits at the system clock, 125 MHz unless changed; the timer’s alarms
    // compare 32 bits of microseconds.
    {
      name: 'Pico · PIO, 125 MHz',
      values: { frequency_hz: 125_000_000, counter_bits: 32 },
      help: 'A PIO state machine that counts 32 bits at the RP2040’s usual system clock.',
    },
    {
      name: 'Pico · timer, 1 MHz',
      values: { frequency_hz: 1_000_000, counter_bits: 32 },
      help: 'The alarms of the RP2040’s timer: whole microseconds, 32 bits.',
    },
  ],
};

/** The preset that a design has the values of.
 * @param {Design} design @param {Part} part */
export function presetOf(design, part) {
  const own = /** @type {Record<string, unknown>} */ (design[part]);
  return PRESETS[part].find(({ values }) => Object.entries(values).every(([name, value]) => own[name] === value));
}

/** The design with a preset's values.
 * @param {Design} design @param {Part} part @param {Preset} preset @returns {Design} */
export function withPreset(design, part, { name, values }) {
  return { ...design, name: isUnnamed(design) ? name : design.name, [part]: { ...design[part], ...values } };
}

/** Whether nobody gave it a name: it has none, or one that a preset gave it.
 * @param {Design} design */
function isUnnamed({ name }) {
  return name.trim() === '' || Object.values(PRESETS).some((presets) => presets.some((preset) => preset.name === name));
}
