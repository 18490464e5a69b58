// @ts-check
// The table of parameters: what each is called, its unit, the reach of its slider, its formula and what it does.

/** @typedef {object} Slider
 * @property {number} from
 * @property {number} to
 * @property {'linear' | 'log'} scale   log where the reach spans decades
 * @property {number} figures           significant figures that the slider sets; 0: whole numbers */

/** @typedef {object} Field
 * @property {string} path       where it stands in the design document
 * @property {string} label
 * @property {string} symbol
 * @property {string} unit
 * @property {Slider} slider
 * @property {string} formula    numbers of its formulas; empty: none
 * @property {string} help */

/** @type {{title: string, fields: Field[]}[]} */
export const GROUPS = [
  {
    title: 'Axis',
    fields: [
      {
        path: 'axis.full_steps_per_rev',
        label: 'Steps a turn',
        symbol: '',
        unit: 'full steps',
        slider: { from: 20, to: 800, scale: 'linear', figures: 0 },
        formula: '',
        help: 'Full steps of one turn of the motor, before microstepping: 200 for the usual 1.8° motor.',
      },
      {
        path: 'axis.microsteps',
        label: 'Microsteps',
        symbol: '',
        unit: 'per step',
        slider: { from: 1, to: 256, scale: 'log', figures: 0 },
        formula: '',
        help: 'Driver pulses for one full step. Every step in the plots is one pulse.',
      },
      {
        path: 'axis.travel_per_rev',
        label: 'Travel a turn',
        symbol: '',
        unit: '',
        slider: { from: 0.5, to: 400, scale: 'log', figures: 2 },
        formula: '',
        help: 'Distance the axis covers in one turn of the motor. It scales the position axis, not the ramp.',
      },
    ],
  },
  {
    title: 'Timer',
    fields: [
      {
        path: 'timer.frequency_hz',
        label: 'Frequency',
        symbol: 'F',
        unit: 'Hz',
        slider: { from: 1e4, to: 1e8, scale: 'log', figures: 3 },
        formula: '7',
        help: 'Ticks a second of the step timer. Delays are whole ticks, so a low F coarsens the top speeds.',
      },
      {
        path: 'timer.counter_bits',
        label: 'Counter',
        symbol: '',
        unit: 'bits',
        slider: { from: 8, to: 32, scale: 'linear', figures: 0 },
        formula: '',
        help: 'Width of the timer’s counter. The longest delay, that of the first step, has to fit into it.',
      },
      {
        path: 'timer.shortest_interval_us',
        label: 'Shortest delay',
        symbol: '',
        unit: 'µs',
        slider: { from: 1, to: 1000, scale: 'log', figures: 3 },
        formula: '',
        help: 'The least time that the firmware needs between two pulses. It sets the highest slew speed.',
      },
    ],
  },
  {
    title: 'Ramp',
    fields: [
      {
        path: 'ramp.base_speed_steps_per_s',
        label: 'Base speed',
        symbol: 'v₀',
        unit: 'steps/s',
        slider: { from: 0, to: 1000, scale: 'linear', figures: 0 },
        formula: '17',
        help: 'Speed at which the ramp begins and ends. Sets the first delay; from rest (0) the methods differ most.',
      },
      {
        path: 'ramp.slew_speed_steps_per_s',
        label: 'Slew speed',
        symbol: 'v',
        unit: 'steps/s',
        slider: { from: 50, to: 50000, scale: 'log', figures: 3 },
        formula: '18',
        help: 'Speed that the ramp leads to. Its delay is F / v, rounded to whole ticks.',
      },
      {
        path: 'ramp.acceleration_steps_per_s2',
        label: 'Acceleration',
        symbol: 'a',
        unit: 'steps/s²',
        slider: { from: 100, to: 1e6, scale: 'log', figures: 3 },
        formula: '4, 16',
        help: 'Gain of speed each second. The ramp takes (v² − v₀²) / 2a steps.',
      },
      {
        path: 'ramp.deceleration_steps_per_s2',
        label: 'Deceleration',
        symbol: 'd',
        unit: 'steps/s²',
        slider: { from: 100, to: 1e6, scale: 'log', figures: 3 },
        formula: '4, 16',
        help: 'Loss of speed each second. It follows the acceleration until it is set; emptied, it follows again.',
      },
    ],
  },
  {
    title: 'Move',
    fields: [
      {
        path: 'move.steps',
        label: 'Distance',
        symbol: 'N',
        unit: 'steps',
        slider: { from: 1, to: 1e6, scale: 'log', figures: 3 },
        formula: '',
        help: 'Length of the plotted move; negative moves backward. Too short for the slew speed, it is a triangle.',
      },
    ],
  },
];

/** Explanations of what is no number. @type {Record<string, {label: string, formula: string, help: string}>} */
export const CHOICES = {
  'method.arithmetic': {
    label: 'Arithmetic',
    formula: '',
    help: 'How the target computes: float32 is what C float gives, operation for operation, float64 what double gives, fixed the integers of a chip without either.',
  },
  'method.rounding': {
    label: 'Rounding',
    formula: '',
    help: 'How a delay becomes whole ticks: nearest, down (floor), or down with the rest carried into the next delay.',
  },
  'axis.travel_unit': {
    label: 'Travel unit',
    formula: '',
    help: 'mm for a screw or a belt, degrees for a turntable or a gauge.',
  },
};

/** Positions of a slider: enough that neighbouring ones differ by less than anyone can set by hand. */
export const SLIDER_POSITIONS = 1000;

/** Where a value lies on a slider; a value outside its reach lies at its end. The sign of a distance does not matter.
 * @param {Slider} slider @param {number} value */
export function sliderPosition({ from, to, scale }, value) {
  const magnitude = Math.min(to, Math.max(from, Math.abs(value)));
  const fraction =
    scale === 'log' ? Math.log(magnitude / from) / Math.log(to / from) : (magnitude - from) / (to - from);
  return fraction * SLIDER_POSITIONS;
}

/** The value at a position of a slider, rounded to what a hand can mean. The sign of the value before is kept.
 * @param {Slider} slider @param {number} position @param {number} before */
export function sliderValue({ from, to, scale, figures }, position, before) {
  const fraction = position / SLIDER_POSITIONS;
  const value = scale === 'log' ? from * (to / from) ** fraction : from + (to - from) * fraction;
  const rounded = figures === 0 ? Math.round(value) : Number(value.toPrecision(figures));
  return before < 0 ? -rounded : rounded;
}
