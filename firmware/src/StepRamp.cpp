#include "StepRamp.h"

#include "boards/polled/arduino_board.h"
#include "stepramp/edge/board.h"
#include "stepramp/motion/feed.h"
#include "stepramp/motion/homing.h"
#include "stepramp/motion/machine.h"
#include "stepramp/motion/machine_axes.h"
#include "stepramp/motion/machine_inputs.h"
#include "stepramp/protocol/message.h"
#include "stepramp/store/driver_settings.h"
#include "stepramp/store/ramp_image.h"

StepRampClass StepRamp;

static_assert((uint8_t)STEPRAMP_AXES == AXES && (uint8_t)STEPRAMP_GAUGES == GAUGES, "StepRamp.h and board_limits.h differ");
static_assert((uint8_t)STEPRAMP_NO_PIN == (uint8_t)NO_PIN, "StepRamp.h and arduino_board.h differ");
static_assert((uint16_t)STEPRAMP_HOLD == (uint16_t)HOLD_FOR_EVER, "StepRamp.h and driver_settings.h differ");
static_assert((uint8_t)STEPRAMP_STOPPED == STATUS_STOPPED && (uint8_t)STEPRAMP_AT_LIMIT == STATUS_AT_LIMIT,
              "StepRamp.h and message.h differ");
static_assert((uint8_t)STEPRAMP_MOVING == STATUS_MOVING && (uint8_t)STEPRAMP_NO_RAMP == STATUS_NO_RAMP &&
                  (uint8_t)STEPRAMP_OUT_OF_RANGE == STATUS_OUT_OF_RANGE && (uint8_t)STEPRAMP_TOO_FAST == STATUS_TOO_FAST,
              "StepRamp.h and message.h differ");

#if HAS_INPUTS
struct settings stepramp_sketch_settings = {OUTPUTS_STEP_AND_DIRECTION, 0, 0, 0, 0, 0, 30, 1, HOLD_FOR_EVER, USUAL_SILENCE, 0, 4, {0},
                                             {PACKED_NO_LIMITS, PACKED_NO_LIMITS, PACKED_NO_LIMITS, PACKED_NO_LIMITS}};
#else
struct settings stepramp_sketch_settings = {OUTPUTS_STEP_AND_DIRECTION, 0, 0, 0, 0, 0, 30, 1, HOLD_FOR_EVER};
#endif

namespace {

struct settings &settings_now = stepramp_sketch_settings;

/* Of poll(), at most: loop() has other things to do. */
enum { MOST_ROUNDS = 2 };

/* More than a tick of millis(): it is 1.024 ms at 16 MHz. */
enum { LOOKS_APART_US = 1030 };

bool has_begun;

uint8_t bit_of(uint8_t axis)
{
    return axis < AXES ? (uint8_t)(1u << axis) : 0;
}

uint8_t all_axes()
{
    return (uint8_t)((1u << machine_axes()) - 1u);
}

void set_bit(uint8_t *mask, uint8_t axis, bool on)
{
    *mask = (uint8_t)(on ? *mask | bit_of(axis) : *mask & ~bit_of(axis));
}

bool settings_are_good()
{
    uint8_t packed[SETTINGS_BYTES];
    settings_pack(&settings_now, packed);
    return settings_check(packed) == SETTINGS_BYTES;
}

/* The axes of the mask that are being homed. */
uint8_t homing_of(uint8_t mask)
{
    return axes_homing() & mask;
}

void end_homing(uint8_t mask)
{
#if HAS_INPUTS
    if (has_homing()) {
        WITH_HOMING(homing_end)(mask);
    }
#else
    (void)mask;
#endif
}

/* Nothing moves before the next good image. */
void forget_image()
{
    stepramp_image = nullptr;
    stepramp_axis_count = 0;
}

/* Nothing else is to be said to these axes now. */
bool are_taken(uint8_t mask)
{
    return machine_is_on_a_line() || homing_of(mask) != 0;
}

StepRampResult move_to(uint8_t mask, const int32_t *targets)
{
    uint16_t detail;
    return are_taken(mask) ? STEPRAMP_MOVING : (StepRampResult)machine_move_to(mask, targets, &detail);
}

/* `from` + `steps`, unless that is beyond what a position can be. */
bool add_steps(int32_t from, int32_t steps, int32_t *target)
{
    *target = (int32_t)((uint32_t)from + (uint32_t)steps);
    return (steps >= 0) == (*target >= from);
}

} // namespace

/* ---- wiring and settings ---- */

void StepRampClass::setStepper(uint8_t axis, uint8_t stepPin, uint8_t directionPin)
{
    if (axis < AXES) {
        stepramp_pins.step[axis] = stepPin;
        stepramp_pins.direction[axis] = directionPin;
    }
}

void StepRampClass::setEnablePin(uint8_t pin)
{
    stepramp_pins.enable = pin;
}

void StepRampClass::setGauge(uint8_t axis, uint8_t pin1, uint8_t pin2, uint8_t pin3, uint8_t pin4)
{
    if (axis < GAUGES) {
        const uint8_t pins[COIL_PINS] = {pin1, pin2, pin3, pin4};
        memcpy(stepramp_pins.coils[axis], pins, sizeof pins);
        settings_now.outputs = OUTPUTS_GAUGES;
        arduino_use_gauges();
    }
}

void StepRampClass::setBothEdges(uint8_t axis, bool on)
{
    set_bit(&settings_now.both_edges, axis, on);
}

void StepRampClass::setStepInverted(uint8_t axis, bool on)
{
    set_bit(&settings_now.step_inverted, axis, on);
}

void StepRampClass::setDirectionInverted(uint8_t axis, bool on)
{
    set_bit(&settings_now.direction_inverted, axis, on);
}

void StepRampClass::setEnableActiveHigh(bool on)
{
    settings_now.enable_flags = on ? ENABLE_ACTIVE_HIGH : 0;
}

void StepRampClass::setPulseWidth(uint8_t microseconds)
{
    settings_now.pulse_width_us = microseconds;
}

void StepRampClass::setDirectionSetup(uint16_t microseconds)
{
    settings_now.direction_setup_us = microseconds;
}

void StepRampClass::setEnableLead(uint16_t milliseconds)
{
    settings_now.enable_lead_ms = milliseconds;
}

void StepRampClass::setEnableHold(uint16_t milliseconds)
{
    settings_now.enable_hold_ms = milliseconds;
}

bool StepRampClass::begin(const uint8_t *ramp, uint16_t length)
{
    if (!has_begun) {
        has_begun = true;
        arduino_begin();
        machine_begin();
    } else if (isMoving()) {
        return false;
    }
    if (!settings_are_good() || !arduino_pins_are_good() || !ramp_image_check(ramp, length).good) {
        forget_image();
        return false;
    }
    machine_use(ramp, &settings_now);
#if HAS_INPUTS
    /* For as long as an input takes to change: what is active already counts before the first motion is asked for. */
    for (uint8_t left = has_inputs() ? (uint8_t)(settings_now.looks + 1) : 0; left != 0; left--) {
        delayMicroseconds(LOOKS_APART_US);
        poll();
    }
#endif
    return true;
}

/* A sketch with a timer may have come late: then there is more to be queued than in one round, and no step waits meanwhile. */
void StepRampClass::poll()
{
#if HAS_INPUTS
    if (has_inputs()) {
        WITH_INPUTS(machine_watch_inputs)(board_milliseconds());
    }
#endif
    uint8_t left = arduino_has_timer() ? MOST_ROUNDS : 1;
    while (left != 0 && !machine_poll()) {
        left--;
    }
    arduino_play();
}

/* ---- moves ---- */

StepRampResult StepRampClass::moveTo(uint8_t axis, int32_t position)
{
    return move_to(bit_of(axis), &position);
}

StepRampResult StepRampClass::moveBy(uint8_t axis, int32_t steps)
{
    int32_t position;
    return add_steps(target(axis), steps, &position) ? moveTo(axis, position) : STEPRAMP_OUT_OF_RANGE;
}

StepRampResult StepRampClass::moveAllTo(const int32_t positions[])
{
    return move_to(all_axes(), positions);
}

StepRampResult StepRampClass::lineBy(const int32_t steps[], uint8_t rampAxis)
{
    uint16_t detail;
    return isMoving() ? STEPRAMP_MOVING : (StepRampResult)machine_line(all_axes(), rampAxis, steps, &detail);
}

StepRampResult StepRampClass::run(uint8_t axis, int32_t interval)
{
    uint16_t detail;
    return are_taken(bit_of(axis)) ? STEPRAMP_MOVING : (StepRampResult)machine_run(bit_of(axis), &interval, &detail);
}

StepRampResult StepRampClass::zero(uint8_t axis, uint16_t steps)
{
    uint16_t detail;
    return isTaken(axis) ? STEPRAMP_MOVING : (StepRampResult)machine_zero(bit_of(axis), steps, &detail);
}

void StepRampClass::stop()
{
    end_homing(all_axes());
    machine_stop(all_axes());
}

void StepRampClass::stop(uint8_t axis)
{
    end_homing(bit_of(axis));
    machine_stop(bit_of(axis));
}

void StepRampClass::halt()
{
    end_homing(all_axes());
    machine_halt(all_axes());
}

void StepRampClass::halt(uint8_t axis)
{
    end_homing(bit_of(axis));
    machine_halt(bit_of(axis));
}

/* ---- what it does ---- */

bool StepRampClass::isMoving()
{
    return machine_is_moving();
}

bool StepRampClass::isMoving(uint8_t axis)
{
    return axis < AXES && (machine_axis_is_moving(axis) || homing_of(bit_of(axis)) != 0);
}

/* It moves, or a line does, whose axes it would take along. */
bool StepRampClass::isTaken(uint8_t axis)
{
    return machine_is_on_a_line() || isMoving(axis);
}

int32_t StepRampClass::position(uint8_t axis)
{
    return axis < AXES ? machine_report(axis).position : 0;
}

int32_t StepRampClass::target(uint8_t axis)
{
    return axis < AXES ? machine_target(axis) : 0;
}

StepRampResult StepRampClass::setPosition(uint8_t axis, int32_t position)
{
    if (axis >= machine_axes()) {
        return STEPRAMP_OUT_OF_RANGE;
    }
    if (isTaken(axis)) {
        return STEPRAMP_MOVING;
    }
    machine_set_position(bit_of(axis), &position);
    return STEPRAMP_OK;
}

uint8_t StepRampClass::axes()
{
    return machine_axes();
}

uint32_t StepRampClass::ticksPerSecond()
{
    return machine_ticks_a_us() * 1000000ul;
}

uint8_t StepRampClass::ranDry()
{
    return feed_starved();
}

uint32_t StepRampClass::delayedMicroseconds()
{
    return arduino_delayed_us();
}
