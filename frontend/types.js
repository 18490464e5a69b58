// @ts-check
// The shapes that the server and the page exchange. Types only: nothing runs here.

/** What a field holds: a number, or the text of a field that isn't one (the server says what is wrong with it).
 * @typedef {number | string} Entry */

/** @typedef {'exact' | 'ideal' | 'midpoint' | 'first_order' | 'second_order' | 'compromise' | 'tuned' | 'newton' |
 *   'austin' | 'table'} MethodName */

/** @typedef {object} Design
 * @property {string} schema
 * @property {string} name
 * @property {{full_steps_per_rev: Entry, microsteps: Entry, travel_per_rev: Entry, travel_unit: string}} axis
 * @property {{frequency_hz: Entry, counter_bits: Entry, shortest_interval_us: Entry}} timer
 * @property {{base_speed_steps_per_s: Entry, slew_speed_steps_per_s: Entry, acceleration_steps_per_s2: Entry,
 *   deceleration_steps_per_s2: Entry | null}} ramp
 * @property {{name: MethodName, arithmetic: string, rounding: string}} method
 * @property {{rows: [Entry, Entry][], interval_unit: string} | null} table
 * @property {{steps: Entry}} move */

/** @typedef {{name: 'accelerate' | 'slew' | 'decelerate', first_step: number, last_step: number}} Phase */

/** @typedef {object} Profile
 * @property {number[]} step
 * @property {number[]} intervals_ticks
 * @property {number[]} time_s
 * @property {number[]} position_steps
 * @property {number[]} speed_steps_per_s
 * @property {Phase[]} phases
 * @property {{steps: number, duration_s: number, peak_speed_steps_per_s: number, accelerate_steps: number,
 *   slew_steps: number, decelerate_steps: number}} summary
 * @property {{field: string | null, message: string}[]} warnings */

/** @typedef {object} ErrorCurve
 * @property {MethodName} method
 * @property {number[]} step
 * @property {number[]} relative_error
 * @property {{value: number, step: number}} largest_relative_error */

/** One round of answers to one design: everything that the plots and the summary show.
 * @typedef {object} Answer
 * @property {Design} design
 * @property {Partial<Record<MethodName, Profile>>} profiles
 * @property {Partial<Record<MethodName, ErrorCurve>>} errors
 * @property {Partial<Record<MethodName, string>>} failures  why a method has no profile */

/** @typedef {{field: string | null, value: unknown, allowed: string | null, message: string}} Rejection */

/** @typedef {{title: string, description: string, design: Design}} Example */

/** @typedef {{port: string, name: string, virtual: boolean}} Port */

/** @typedef {{name: string, unit: string, requested: string, sent: string, read_back: string}} PushItem */

/** @typedef {{items: PushItem[], verified: boolean, segments: number, bytes: number, largest_deviation_us: number,
 *   sequence: number, warnings: string[]}} Push */

/** @typedef {object} Device
 * @property {string} id
 * @property {string} port
 * @property {string} name
 * @property {'connecting' | 'ready' | 'moving' | 'stopping' | 'writing' | 'lost'} state
 * @property {string | null} message
 * @property {number} position_steps
 * @property {number} target_steps
 * @property {number} speed_steps_per_s
 * @property {number} timer_hz
 * @property {string} firmware_version
 * @property {{sequence: number, crc: number} | null} ramp
 * @property {Push | null} pushed */

/** Why the curves belong to earlier values; null: they don't.
 * @typedef {'refused' | 'unanswered' | null} Staleness */

/** What decides which of the device's buttons can be used.
 * @typedef {object} Situation
 * @property {boolean} isServerThere
 * @property {boolean} isDesignValid
 * @property {boolean} isBusy          something is being asked of a device
 * @property {boolean} isPushing
 * @property {boolean} isChanged       the design is another than the one last pushed */

export {};
