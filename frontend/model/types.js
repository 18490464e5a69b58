// @ts-check
// The shapes that the server and the page exchange. Types only: nothing runs here.

/** What a field holds: a number, or the text of a field that isn't one (the server says what is wrong with it).
 * @typedef {number | string} Entry */

/** One of those that the server has.
 * @typedef {string} MethodName */

/** A method, as the server tells of it.
 * @typedef {object} RampMethod
 * @property {MethodName} name
 * @property {string} label
 * @property {string} formula         its number; '' when it has none
 * @property {string} help
 * @property {string[]} arithmetics   the usual one first
 * @property {{light: string, dark: string, dash: number[] | null}} style  of its line; dashes and gaps in turn [px]
 * @property {boolean} plays_table    it is not computed, but the lookup table
 * @property {boolean} is_tuned
 * @property {boolean} is_shown_at_first
 * @property {{format: string, label: string, help: string} | null} code  in C */

/** @typedef {object} Design
 * @property {string} schema
 * @property {string} name
 * @property {{full_steps_per_rev: Entry, microsteps: Entry, travel_per_rev: Entry, travel_unit: string}} axis
 * @property {{frequency_hz: Entry, counter_bits: Entry, shortest_interval_us: Entry}} timer
 * @property {{base_speed_steps_per_s: Entry, slew_speed_steps_per_s: Entry, acceleration_steps_per_s2: Entry,
 *   deceleration_steps_per_s2: Entry | null, shape?: {name: string, jerk_steps_per_s3?: Entry,
 *   deceleration_jerk_steps_per_s3?: Entry | null, points?: [Entry, Entry][], margin?: Entry}}} ramp
 * @property {{name: MethodName, arithmetic: string, rounding: string, tuned_for?: string}} method
 * @property {{rows: [Entry, Entry][], interval_unit: string} | null} table
 * @property {{steps: Entry, plan?: string}} move
 * @property {MotorData} [motor]
 * @property {DriveData} [drive]
 * @property {{inertia_g_cm2?: Entry, torque_nm?: Entry, friction_nm?: Entry | null,
 *   mechanism?: {name: string, [field: string]: Entry | null} | null}} [load] */

/** @typedef {{supply_v?: Entry | null, current_a?: Entry | null, current_is?: string | null}} DriveData */

/** A motor, as its data sheet has it.
 * @typedef {{resistance_ohm: Entry, inductance_mh: Entry, holding_torque_nm: Entry, rated_current_a: Entry,
 *   rotor_inertia_g_cm2: Entry, detent_torque_nm?: Entry | null, full_steps_per_rev?: Entry | null, kind?: string,
 *   pull_out_factor?: Entry | null, stalled?: {rpm: Entry, torque_nm: Entry} | null, torque_curve?: [Entry, Entry][] | null,
 *   measured_with?: DriveData | null}} MotorData */

/** What the server says of the motor with a design.
 * @typedef {object} MotorAnswer
 * @property {'safe' | 'marginal' | 'stalls'} verdict
 * @property {string | null} cause
 * @property {string | null} evidence           what shows it
 * @property {number} lost_full_steps
 * @property {number | null} first_lost_step
 * @property {number} largest_load_angle_deg
 * @property {number | null} most_used          of the pull-out torque, at most; null: some is asked for where there is none
 * @property {number} most_used_at_steps_per_s
 * @property {number} natural_frequency_hz
 * @property {number} greatest_start_speed_steps_per_s
 * @property {number} greatest_sudden_acceleration_steps_per_s2
 * @property {[number, number][]} resonances_steps_per_s
 * @property {MotorRun[]} runs  the move with each damping, the least first
 * @property {{step: number[], time_s: number[], load_angle_deg: number[], speed_steps_per_s: number[]}} rotor  with a usual one
 * @property {{speed_steps_per_s: number[], speed_rpm: number[], pull_out_nm: number[], required_nm: number[]}} torque
 * @property {Remedy[]} proposals
 * @property {Record<string, 'measured' | 'datasheet' | 'given' | 'assumed' | 'unused'>} origins  by path; what means none isn't there
 * @property {string[]} assumed
 * @property {string} not_covered */

/** What the rotor does with one damping.
 * @typedef {object} MotorRun
 * @property {number} damping
 * @property {number} lost_full_steps
 * @property {number | null} first_lost_step
 * @property {number} largest_load_angle_deg
 * @property {number | null} speed_ripple       at slew speed, in parts of it; null: the move has no slew phase
 * @property {number} overshoot_deg
 * @property {number} settled_after_s */

/** What a move is with its motor; null all of it where the rejections say why there is none.
 * @typedef {object} FastestFigures
 * @property {number | null} duration_s
 * @property {number | null} ramp_up_s
 * @property {number | null} peak_speed_steps_per_s
 * @property {number | null} acceleration_steps_per_s2
 * @property {number | null} most_used
 * @property {MotorAnswer['verdict'] | null} verdict
 * @property {Rejection[]} rejections */
/** The fastest ramp of a shape, and what makes it of the design.
 * @typedef {FastestFigures & {shape: string, changes: Remedy['changes'], is_fastest: boolean}} FastestRamp */
/** @typedef {{margin: number, candidates: FastestRamp[], present: FastestFigures & {is_fastest: boolean}, gain: number | null,
 *   words: string}} FastestAnswer */

/** What a stall map goes over beside the acceleration.
 * @typedef {'slew_speed' | 'load' | 'supply_voltage'} Over */
/** Whether the motor makes the move at each point: a row for each acceleration, a column for each other value. -1: not known yet,
 * 0: safe, 1: marginal, 2: stalls, 3: not possible.
 * @typedef {{over: Over, over_values: number[], over_unit: string, over_spacing: 'even' | 'ratios', accelerations_steps_per_s2: number[], verdicts: number[][],
 *   played: number}} MapResult */
/** @typedef {{id: string, state: 'waiting' | 'running' | 'done' | 'cancelled' | 'failed', progress: number, result: MapResult | null,
 *   errors?: Rejection[]}} MapJob */
/** The stall map of an axis: how far the last one is that was asked for, and the pictures that are known, the newest first.
 * key: what of a design it, or a picture, is of; id: of the job that computes it, null: not told yet; waitsFor: why nothing
 * comes of it just now, in words, '' or left out: something does.
 * @typedef {{key: string, over: Over, id: string | null, stage: 'running' | 'done' | 'cancelled' | 'failed', waitsFor?: string, progress: number,
 *   pictures: {key: string, result: MapResult}[], rejections: Rejection[]}} StallMap */

/** @typedef {{name: 'accelerate' | 'slew' | 'decelerate', first_step: number, last_step: number}} Phase */

/** @typedef {object} Profile
 * @property {number[]} step
 * @property {number[]} intervals_ticks
 * @property {number[]} time_s
 * @property {number[]} position_steps
 * @property {number[]} speed_steps_per_s
 * @property {Phase[]} phases
 * @property {{steps: number, duration_s: number, peak_speed_steps_per_s: number, accelerate_steps: number,
 *   slew_steps: number, decelerate_steps: number, ramp_steps: number, ramp_speed_steps_per_s: number,
 *   is_lowered: boolean}} summary
 * @property {import('./messages.js').Remark[]} warnings */

/** A quantity as it stands in a message, and as data. axis: which it is of, counted from 0; null: the one that the message
 * is about.
 * @typedef {{text: string, value: number, unit: string, rounding: 'nearest' | 'down' | 'up', axis: number | null}} Told */

/** One method's errors against the reference.
 * @typedef {object} ErrorCurve
 * @property {MethodName} method
 * @property {number[]} step
 * @property {number[]} relative_error
 * @property {number[]} [implied_acceleration_steps_per_s2]  when it was asked for
 * @property {{acceleration_steps_per_s2: number[], jerk_steps_per_s3: number[]}} [motion]  as planned, when it was asked for
 * @property {Record<ErrorPart, number[]>} [parts]            when they were asked for [ticks]
 * @property {{value: number, step: number}} largest_relative_error
 * @property {{value: number, step: number}} peak_acceleration_steps_per_s2       as it is played, in whole ticks
 * @property {{value: number, step: number}} peak_ramp_acceleration_steps_per_s2  before rounding: the ramp's own
 * @property {number} landing_error_steps_per_s */

/** Where an error comes from.
 * @typedef {'method' | 'arithmetic' | 'rounding' | 'compression'} ErrorPart */

/** What the server answers to be drawn.
 * @typedef {object} DrawnCurves
 * @property {number} timer_hz
 * @property {1 | -1} direction
 * @property {(ErrorCurve & {intervals_ticks: number[], start_ticks: number[]} &
 *   Pick<Profile, 'phases' | 'summary' | 'warnings'>)[]} methods
 * @property {{method: MethodName, errors: Rejection[]}[]} failures */

/** One round of answers to one design: everything that the plots and the summary show.
 * @typedef {object} Answer
 * @property {Design} design
 * @property {[number, number] | null} range  first and last step of the part that has the points; null: the whole move
 * @property {import('./units.js').Units} [units]  that it is shown in
 * @property {Partial<Record<MethodName, Profile>>} profiles
 * @property {Partial<Record<MethodName, ErrorCurve>>} errors
 * @property {Partial<Record<MethodName, string>>} failures  why a method has no profile */

/** From where to where a number may lie, or how long a text or a list may be; null: no end. A sentence about them goes on
 * with the note.
 * @typedef {{lowest: number | null, highest: number | null, is_whole: boolean, note: string}} Limits */

/** What would be accepted instead of what was refused: it was tried.
 * @typedef {{text: string, changes: {field: string, value: unknown}[], told?: Told[]}} Remedy */

/** What is allowed while another field has its value: some names, or something that is needed.
 * @typedef {{names: string[], because: {field: string, value: unknown}, is_need: boolean}} Choices */

/** What can't be used, or can't be done. limits and their unit: what `allowed` says, where it is about numbers. reason: the
 * message, where more than the value is wrong. What isn't known is left out. given: the value in words, in the units shown.
 * @typedef {{field: string | null, value: unknown, allowed: string | null, message: string, limits?: Limits,
 *   unit?: string, reason?: string, given?: string, told?: Told[], choices?: Choices,
 *   remedies?: Remedy[]}} Rejection */

/** Why a push is refused, and what would be accepted instead. axis: whose design is to blame, by its id; null: nobody's.
 * @typedef {{text: string, axis: number | null, remedies: Remedy[]}} PushRefusal */

/** @typedef {{title: string, description: string, design: Design}} Example */

/** What a fitted table is to keep to: one of rows, bytes and largest_relative_error (a fraction).
 * @typedef {{rows?: Entry, bytes?: Entry, largest_relative_error?: Entry, row_kind: 'constant' | 'linear',
 *   interval_unit: string, fit_to: FitTo}} FitWish */

/** What a table is fitted to: all steps that play a ramp index, or step k speeding up at index k.
 * @typedef {'played' | 'ramp_index'} FitTo */

/** What no number of rows can mend, and the ramp index that has it.
 * @typedef {{relative_error: number, ramp_index: number}} Floor */

/** @typedef {object} FittedTable
 * @property {{rows: [number, number][], interval_unit: string} | null} table  null for linear rows
 * @property {[number, number, number][] | null} linear_rows  last ramp index, first delay, what is added each step
 * @property {number} rows
 * @property {number} bytes
 * @property {number} largest_relative_error
 * @property {number[]} relative_errors
 * @property {Floor} floor */

/** @typedef {{steps: {at_us: number[], position: number[]}, stops: {at_us: number, position: number}[]}} PlayedTable */

/** What a motor does that is told something in flight: as many of its steps as were asked for, and all turns.
 * @typedef {object} InFlight
 * @property {number} timer_hz
 * @property {number[]} at_ticks
 * @property {number[]} interval_ticks        to the next pulse, or to rest
 * @property {number[]} position_steps
 * @property {(1 | -1)[]} direction
 * @property {{at_s: number, position_steps: number}[]} rests
 * @property {number[]} told_position_steps   where it was, by command */

/** @typedef {{rows: number[], bytes: number[], largest_relative_error: number[], floor: Floor}} FitCurve */

/** @typedef {{port: string, name: string, virtual: boolean, families: string[]}} Port  families: that one there may be of */

/** A family of controllers. cannot: what they can't take of a design, or do. plays_own: whether it is known what they play
 * that work their intervals out themselves. capabilities: those that they have at most. kind: the family that its controllers are of, whatever way they are reached.
 * @typedef {{name: string, title: string, kind: string, capabilities: Capability[], cannot: string[], plays_own: boolean,
 *   reads_settings: boolean}} Family */

/** What a page may do of a server that others may use, too: view is to see, to compute and to stop.
 * @typedef {{role: 'view' | 'operate', is_shared: boolean, place: string | null}} Access */

/** What can be connected to.
 * @typedef {{ports: Port[], families: Family[]}} Ports */

/** What only some controllers can do.
 * @typedef {'keep' | 'try' | 'restore' | 'settings' | 'trace' | 'line' | 'zero' | 'backup' | 'import' | 'prove' | 'inputs'} Capability */

/** A figure as the controller itself has it, such as $120.
 * @typedef {{term: string, unit: string, sent: number | null, on_device: number | null}} OwnTerms */

/** read_back: null when that makes no sense. own: null where the controller's own terms are the same.
 * @typedef {{name: string, unit: string, requested: number, sent: number, read_back: number | null,
 *   axis: number | null, own: OwnTerms | null}} PushItem */

/** @typedef {{items: PushItem[], verified: boolean, segments: number | null, bytes: number,
 *   largest_deviation_us: number | null, sequence: number | null, warnings: string[], warnings_told: Told[][]}} Push */

/** What is pushed: a design for one axis, or those of all.
 * @typedef {{mode?: 'keep' | 'try'} & ({design: Design, to_axis: number} | {axes: Design[]})} Pushed */

/** @typedef {{name: string, unit: string, on_device: number | null, to_send: number | null, differs: boolean,
 *   axis: number | null, own: OwnTerms | null}} PreviewItem */

/** What is saved of a device before it is written to. name: when, in UTC.
 * @typedef {{name: string, bytes: number}} Backup */
/** What is saved of a device. unreadable: which folders of it can't be listed, and why, as sentences.
 * @typedef {{backups: Backup[], unreadable: string[]}} Backups */
/** What backups are of, connected or not.
 * @typedef {{name: string, family: string, plugged_in: string, backups: Backup[]}} BackupSource */

/** A design's move as a controller plays it that works its intervals out itself.
 * @typedef {object} OwnRamp
 * @property {number[]} step
 * @property {number[]} intervals_us
 * @property {number[]} start_s
 * @property {number[]} speed_steps_per_s
 * @property {number[]} relative_error
 * @property {1 | -1} direction
 * @property {number} max_relative_error
 * @property {number} max_error_step
 * @property {number} duration_s
 * @property {number} planned_duration_s
 * @property {string[]} losses */

/** @typedef {{items: PreviewItem[], same: boolean, segments: number | null, bytes: number,
 *   largest_deviation_us: number | null, warnings: string[], warnings_told: Told[][]}} Preview */

/** @typedef {{stage: 'planning' | 'sending' | 'checking' | 'storing' | 'reading_back', bytes_done: number,
 *   bytes_total: number}} Progress */

/** @typedef {{traced_axis: number, number: number, every_steps: number, timer_hz: number, complete: boolean, changed: boolean,
 *   step: number[], planned_ticks: number[], measured_ticks: number[], deviation_us: number[]}} Trace */

/** A finished move as it was made.
 * @typedef {object} Measured
 * @property {number[]} step
 * @property {number[]} time_s
 * @property {number[]} speed_steps_per_s
 * @property {number[]} delay_us
 * @property {number[]} deviation_us  how much later than planned
 * @property {number | null} length     steps from rest to rest; null: not known */

/** What is wanted of a captured file; null: what is likeliest.
 * @typedef {object} CaptureWish
 * @property {string | null} step_channel
 * @property {string | null} direction_channel   empty: none
 * @property {'rising' | 'falling' | 'both' | null} edge
 * @property {Entry | null} move_number          counted from 1
 * @property {'first_step' | 'best_fit'} alignment
 * @property {Entry | null} shortest_pulse_us    null: none is marked
 * @property {Entry | null} longest_wait_us */

/** Steps that something is wrong with: how many, and the first of them.
 * @typedef {{count: number, step: number[], time_s: number[]}} MarkedSteps */

/** A captured move laid over the planned one.
 * @typedef {object} Deviation
 * @property {number} planned_steps
 * @property {number} planned_duration_s         from the first planned step to the last
 * @property {number} matched_steps
 * @property {{largest_us: number, largest_at_step: number, mean_us: number, rms_us: number, clock_ppm: number | null,
 *   no_clock: string}} figures
 * @property {MarkedSteps} missing               planned steps that were not made
 * @property {MarkedSteps} extra                 measured steps that were not planned
 * @property {number[]} planned_step             of each listed step; 0: none
 * @property {(number | null)[]} deviation_us    how much later than planned */

/** @typedef {{move: number, steps: number, begin_s: number, duration_s: number, direction_level: 0 | 1 | null}} CapturedMove */

/** What a captured file shows, next to a design.
 * @typedef {object} Captured
 * @property {string} format
 * @property {{name: string, edges: number}[]} channels
 * @property {string} step_channel
 * @property {string | null} direction_channel
 * @property {'rising' | 'falling' | 'both'} edge
 * @property {number | null} sample_rate_hz
 * @property {number} duration_s
 * @property {number} longest_wait_us
 * @property {string[]} remarks
 * @property {number} move_count
 * @property {CapturedMove[]} moves              the first of them
 * @property {(CapturedMove & {step: number[], time_s: number[], interval_us: (number | null)[],
 *   speed_steps_per_s: (number | null)[], short_pulses: MarkedSteps | null, deviation: Deviation | null}) | null} move */

/** A running move as the controller tells of it, since it set out: so many steps long; null while it has no end. earlier: of a
 * half of there and back, how long the longest of those before it took, and how fast they got.
 * @typedef {{time_s: number[], position: number[], speed: number[], length: number | null,
 *   earlier?: {seconds: number, speed: number}}} Samples */

/** How the controller drives its pins; see the API.
 * @typedef {Record<string, unknown>} Settings */

/** @typedef {object} AxisState
 * @property {number} axis
 * @property {'ready' | 'moving' | 'stopping' | 'lost'} state
 * @property {number} position_steps
 * @property {number} target_steps
 * @property {number} speed_steps_per_s
 * @property {number} steps_made
 * @property {number | null} steps_per_mm   as the controller itself is set; null: it counts in steps only
 * @property {number | null} microsteps     that it makes of a full step; null: it doesn't tell
 * @property {boolean | null} position_known whether it is known that it is there; null: it doesn't tell
 * @property {boolean} position_told        whether the controller tells where it is
 * @property {boolean | null} homing         whether it is being homed; null: it doesn't tell
 * @property {number | null} lowest_steps   soft limit; null: none
 * @property {number | null} highest_steps
 * @property {boolean} is_beyond_limits     whether it is where they let nothing send it */

/** What is asked for: numbers, or the text that is none; null for no limit.
 * @typedef {{axis: number, lowest_steps: Entry | null, highest_steps: Entry | null}} SoftLimits */
/** What is remembered of them, with what their axis told of its steps then; undefined: kept by a page that didn't ask yet.
 * @typedef {SoftLimits & {steps_per_mm?: number | null, microsteps?: number | null}} KeptLimits */

/** What an input is for. axis, end and stops: of a limit switch.
 * @typedef {{input: string, role: 'emergency_stop' | 'driver_fault' | 'limit', active: 'low' | 'high', pull_up: boolean,
 *   axis: number | null, end: 'low' | 'high' | null, stops: 'ramp' | 'at_once' | null}} InputRole */

/** @typedef {InputRole & {is_active: boolean}} DeviceInput */

/** What a start has shown of settings that were given before.
 * @typedef {object} Proof
 * @property {string[]} proven
 * @property {string[]} not_kept
 * @property {{name: string, written: string, at: string, now: string | null}[]} others  those that were not kept
 * @property {string | null} stored        what is said of the proven ones
 * @property {string} words                all of it */

/** @typedef {object} Device
 * @property {AxisState[]} axes
 * @property {boolean} on_trial
 * @property {Progress | null} progress
 * @property {{axis: number, by_steps: number, times: number, times_done: number, pause_s: number} | null} shuttle
 * @property {number[]} unknown_positions  axes that may be elsewhere than they count, since the device was lost
 * @property {string | null} in_control    the page that is
 * @property {string | null} in_control_at where that is; null where pages are on the server's machine only
 * @property {number} stops                grows with each stop of it
 * @property {number} heard_s
 * @property {number | null} age_s         how old that was when it was told; null: nothing was heard yet
 * @property {string} id
 * @property {string} port
 * @property {string} name
 * @property {string} family               the name of that of its controller
 * @property {number | null} most_axes     how many axes it can have; null until it is connected
 * @property {Capability[]} capabilities   what it can do besides what all can
 * @property {string | null} backup        the name of the last that was saved of it; null for none
 * @property {string | null} lacks_backup  the name of the one to restore, since it was lost half written; null for none
 * @property {string[]} unproven           settings that it was given, and of which its next start shows whether they are stored
 * @property {string | null} unproven_words  the same as sentences, with what can be done; null for none
 * @property {boolean} proving             it is started anew to prove them: all else is how it was before
 * @property {Proof | null} proof          what its last start has shown of such
 * @property {'connecting' | 'ready' | 'moving' | 'stopping' | 'writing' | 'lost'} state
 * @property {DeviceInput[] | null} inputs what each is for, and whether it is active; null for one without
 * @property {string[] | null} stopped_by  'emergency_stop', 'driver_fault' and 'stepped_late', until it is acknowledged; null for one without inputs
 * @property {string | null} message
 * @property {number} position_steps
 * @property {number} target_steps
 * @property {number} speed_steps_per_s
 * @property {number | null} timer_hz      null until it is connected, and without a step timer
 * @property {boolean} motors_on          whether motors have current
 * @property {string | null} firmware_version
 * @property {{sequence: number | null, crc: number | null} | null} ramp
 * @property {Push | null} pushed */

/** How an axis is looked at.
 * @typedef {object} View
 * @property {'step' | 'time' | 'position'} against
 * @property {'whole' | 'start' | 'up' | 'down'} part
 * @property {string} only   the one plot where there is room for one
 * @property {'error' | 'parts' | 'deviation' | 'acceleration' | 'jerk'} third
 * @property {boolean} acceleration
 * @property {[number, number] | null} zoom   in units of the horizontal axis
 * @property {[number, number] | null} range  first and last step that finer points are wanted for; null: the whole move */

/** Why the curves belong to earlier values; null: they don't. awaited: those of the axis in hand haven't come yet.
 * @typedef {'refused' | 'unanswered' | 'awaited' | null} Staleness */

/** Whether the server is heard of. silent: the connection is there, but nothing comes over it.
 * unknown: it is there, but doesn't know this page: it was started anew, with other links.
 * @typedef {'there' | 'silent' | 'gone' | 'unknown'} Link */

/** What decides which of the device's buttons can be used.
 * @typedef {object} Situation
 * @property {Link} link
 * @property {number | null} age       of what is known of the device [whole s]; null: it is new
 * @property {boolean} isDesignValid
 * @property {boolean} isAwaited        whether it is valid is not known yet
 * @property {string} nameProblem       what is wrong with its name, which is far from the push; empty: nothing
 * @property {boolean} isBusy          something is being asked of a device
 * @property {boolean} isPushing
 * @property {boolean} isChanged       the design is another than the one last pushed
 * @property {boolean} mayAct          this page may connect, push and move, not only look on and stop
 * @property {boolean} isOthers        another page is in control
 * @property {boolean} isTracing
 * @property {Preview | null} preview  what a push would change
 * @property {boolean} isPreviewAwaited  that can be told, and hasn't been yet
 * @property {PushRefusal[]} refusals  why the device can't take the designs
 * @property {Design[] | null} lastPushed  from this page, to this device; null: none
 * @property {Trace | null} trace      of the last traced move
 * @property {Design[]} designs        of all axes of the page
 * @property {number[]} ids            of these axes
 * @property {Design[]} toPush         those that a push sends
 * @property {number} active           the one in hand
 * @property {Design[]} played         of each axis of the device that can be chosen; the one in hand where the device can't have
 *   those of all axes
 * @property {Design[]} scaled         the same with the scales that the controller tells, to convert by; what is pushed, and shown
 *   of a push, is by a design's own
 * @property {import('./units.js').Units} units */

export {};

/** One axis of a controller, as a design, and what is not as the controller has it.
 * @typedef {{design: Design, remarks: string[], remarks_told: Told[][]}} ReadAxis */

/** What a machine that ramps by itself is given for a design, and what is lost of it.
 * @typedef {object} MachineSheet
 * @property {string} file_name
 * @property {string} text
 * @property {{name: string, unit: string, requested: number, sent: string}[]} settings
 * @property {string[]} remarks
 * @property {Told[][]} remarks_told  the quantities of each remark
 * @property {string | null} unplayed  why it isn't known what it really plays; null: it is */

/** Axes that begin together, each thinned.
 * @typedef {object} ScheduledAxes
 * @property {{name: string, steps: number, duration_s: number,
 *   pulses: {time_s: number[], speed_steps_per_s: number[]}}[]} axes
 * @property {number} duration_s       until all of them rest
 * @property {number | null} leader    of a line, counted from 0
 * @property {import('./messages.js').Remark[]} limits      what makes a line slower than its leader
 * @property {import('./messages.js').Remark[]} warnings */
