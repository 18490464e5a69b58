#include "StepRampAxis.h"

#ifdef __AVR__
#include <avr/pgmspace.h>
#endif

#include "boards/polled/arduino_board.h"
#include "stepramp/edge/board_limits.h"
#include "stepramp/edge/out_of_line.h"
#include "stepramp/motion/machine.h"
#include "stepramp/store/ramp_maker.h"

/* Room for the ramps of all axes [bytes]; may be set before, by the build. */
#ifndef STEPRAMP_AXIS_RAMP_BYTES
#if defined(__AVR__) && RAMEND < 0x1000
#define STEPRAMP_AXIS_RAMP_BYTES 320
#else
#define STEPRAMP_AXIS_RAMP_BYTES 1024
#endif
#endif

StepRampAxis *StepRampAxis::all[STEPRAMP_AXES];
uint8_t StepRampAxis::count;

namespace {

/* A ramp image: version, clock, axes, ramps, the number of each axis' ramp; then the ramps. */
const uint8_t IMAGE_FORMAT = 2, CLOCK_AT = 1, AXES_AT = 2, RAMPS_AT = 3, NUMBERS_AT = 4, RAMP_AT_OF_ONE_AXIS = 5;

const float MOST_STEPS = 16777214.0f;

/* [steps/s] Slower motors want the slow clock, whose intervals may be longer. */
const float LEAST_FAST_SPEED = 1;

/* [steps/s], [steps/s^2] With less, a step, or the first one from rest, takes longer than LONGEST_INTERVAL_TICKS of the slow
 * clock, or of the fast one. */
const float LEAST_SPEED = 0.0075f, LEAST_ACCELERATION = 0.00012f, LEAST_FAST_ACCELERATION = 0.0072f;

const uint8_t CLOCK_IS_FAST = 1;

uint8_t ramps[STEPRAMP_AXIS_RAMP_BYTES];

uint32_t clock_hz = SLOW_CLOCK_HZ; /* of the ramps */

uint32_t shortest_interval()
{
    const uint8_t fast_ticks = (uint8_t)(FAST_CLOCK_HZ / clock_hz);
    return (board_limit(LIMIT_SHORTEST_1_AXIS) + fast_ticks - 1u) / fast_ticks;
}

OUT_OF_LINE bool is_at_least(float least, float number)
{
    return number >= least && number < 1e9f;
}

} // namespace

StepRampAxis::StepRampAxis(uint8_t itsStepPin, uint8_t itsDirectionPin)
    : index(count++), stepPin(itsStepPin), directionPin(itsDirectionPin), source(NOTHING), found(STEPRAMP_RAMP_MISSING)
{
    if (index < STEPRAMP_AXES) {
        all[index] = this;
    }
}

/* ---- the ramp ---- */

void StepRampAxis::setRamp(float newSpeed, float newAcceleration, float newDeceleration, float newBaseSpeed)
{
    source = COMPUTED;
    speed = newSpeed;
    acceleration = newAcceleration;
    deceleration = newDeceleration == 0 ? newAcceleration : newDeceleration;
    baseSpeed = newBaseSpeed;
}

void StepRampAxis::useRamp(const uint8_t *newImage, uint16_t newLength)
{
    source = EXPORTED;
    image = newImage;
    length = newLength;
}

void StepRampAxis::useRampInFlash(const uint8_t *newImage, uint16_t newLength)
{
    useRamp(newImage, newLength);
    source = EXPORTED_IN_FLASH;
}

float StepRampAxis::mostSpeed()
{
    return (float)FAST_CLOCK_HZ / board_limit(LIMIT_SHORTEST_1_AXIS);
}

uint8_t StepRampAxis::imageByte(uint16_t at) const
{
#ifdef __AVR__
    if (source == EXPORTED_IN_FLASH) {
        return pgm_read_byte(image + at);
    }
#endif
    return image[at];
}

StepRampProblem StepRampAxis::checkImage() const
{
    bool isForTheClock = (imageByte(CLOCK_AT) == CLOCK_IS_FAST) == (clock_hz == FAST_CLOCK_HZ);
    bool isOfOneAxis = length > RAMP_AT_OF_ONE_AXIS && imageByte(0) == IMAGE_FORMAT && isForTheClock &&
                       imageByte(AXES_AT) == 1 && imageByte(RAMPS_AT) == 1 && imageByte(NUMBERS_AT) == 0;
    return isOfOneAxis ? STEPRAMP_READY : STEPRAMP_BAD_IMAGE;
}

StepRampProblem StepRampAxis::checkRamp() const
{
    if (!is_at_least(LEAST_SPEED, speed)) {
        return STEPRAMP_BAD_SPEED;
    }
    if (ramp_maker_interval(clock_hz, speed) < shortest_interval()) {
        return STEPRAMP_SPEED_TOO_HIGH;
    }
    if (!(baseSpeed >= 0 && baseSpeed < speed)) {
        return STEPRAMP_BAD_BASE_SPEED;
    }
    const ramp_wish wish = {speed, baseSpeed, acceleration, deceleration, clock_hz};
    bool isGood = is_at_least(LEAST_ACCELERATION, acceleration) && is_at_least(LEAST_ACCELERATION, deceleration) &&
                  ramp_maker_steps(&wish, acceleration) <= MOST_STEPS && ramp_maker_steps(&wish, deceleration) <= MOST_STEPS;
    return isGood ? STEPRAMP_READY : STEPRAMP_BAD_ACCELERATION;
}

StepRampProblem StepRampAxis::check() const
{
    if (index >= STEPRAMP_AXES) {
        return STEPRAMP_TOO_MANY;
    }
    for (uint8_t i = 0; i < STEPRAMP_AXES && all[i] != nullptr; i++) {
        const StepRampAxis *other = all[i];
        bool isShared = other->stepPin == stepPin || other->stepPin == directionPin || other->directionPin == stepPin ||
                        other->directionPin == directionPin;
        if (stepPin == directionPin || (other != this && isShared)) {
            return STEPRAMP_BAD_PINS;
        }
    }
    return source == NOTHING ? STEPRAMP_RAMP_MISSING : source == COMPUTED ? checkRamp() : checkImage();
}

/* Writes its ramp. Returns its length, or 0: there is no room. */
uint16_t StepRampAxis::write(uint8_t *bytes, uint16_t room) const
{
    if (source == COMPUTED) {
        const ramp_wish wish = {speed, baseSpeed, acceleration, deceleration, clock_hz};
        return ramp_maker_write(&wish, bytes, room);
    }
    uint16_t rampBytes = (uint16_t)(length - RAMP_AT_OF_ONE_AXIS);
    for (uint16_t i = 0; i < rampBytes && rampBytes <= room; i++) {
        bytes[i] = imageByte((uint16_t)(RAMP_AT_OF_ONE_AXIS + i));
    }
    return rampBytes <= room ? rampBytes : 0;
}

/* One image for all axes. Those that have no good ramp yet are given the first one, as each needs one: they don't move. Nor does
 * any where that fails: what others began with isn't there any more. */
StepRampProblem StepRampAxis::beginAll()
{
    uint8_t axes = count < STEPRAMP_AXES ? count : STEPRAMP_AXES, left = 0, number = 0;
    for (uint8_t i = 0; i < axes; i++) {
        left = (uint8_t)(left + (all[i]->check() == STEPRAMP_READY));
    }
    uint16_t end = (uint16_t)(NUMBERS_AT + axes), written = 1;
    for (uint8_t i = 0; i < axes && written != 0; i++) {
        ramps[NUMBERS_AT + i] = 0;
        StepRampProblem problem = all[i]->check();
        if (problem != STEPRAMP_READY) {
            all[i]->found = problem; /* it may have begun with another ramp */
            continue;
        }
        written = all[i]->write(ramps + end, (uint16_t)((sizeof ramps - end) / left--));
        ramps[NUMBERS_AT + i] = number++;
        end = (uint16_t)(end + written);
        StepRamp.setStepper(i, all[i]->stepPin, all[i]->directionPin);
    }
    const uint8_t head[NUMBERS_AT] = {IMAGE_FORMAT, (uint8_t)(clock_hz == FAST_CLOCK_HZ ? CLOCK_IS_FAST : 0), axes, number};
    memcpy(ramps, head, sizeof head);
    if (written != 0 && StepRamp.begin(ramps, end)) {
        return STEPRAMP_READY;
    }
    StepRampProblem problem = written == 0 ? STEPRAMP_NO_ROOM : STEPRAMP_BAD_IMAGE;
#if HAS_INPUTS
    if (has_inputs() && !WITH_INPUTS(arduino_inputs_are_good)()) {
        problem = STEPRAMP_BAD_PINS;
    }
#endif
    for (uint8_t i = 0; i < axes; i++) {
        all[i]->found = problem;
    }
    return problem;
}

/* Its ramp can't be played at the fast clock. */
bool StepRampAxis::wantsSlowClock() const
{
    if (source == COMPUTED) {
        return !is_at_least(LEAST_FAST_SPEED, speed) || !is_at_least(LEAST_FAST_ACCELERATION, acceleration) ||
               !is_at_least(LEAST_FAST_ACCELERATION, deceleration);
    }
    return source != NOTHING && length > CLOCK_AT && imageByte(CLOCK_AT) != CLOCK_IS_FAST;
}

/* One clock for all axes: the fast one where a timer makes the steps, unless one of them wants the slow one. */
void StepRampAxis::chooseClock()
{
    clock_hz = arduino_has_timer() ? FAST_CLOCK_HZ : SLOW_CLOCK_HZ;
    for (uint8_t i = 0; i < STEPRAMP_AXES && all[i] != nullptr; i++) {
        if (all[i]->wantsSlowClock()) {
            clock_hz = SLOW_CLOCK_HZ;
        }
    }
}

StepRampProblem StepRampAxis::begin()
{
    chooseClock();
    found = check();
    if (found == STEPRAMP_READY && StepRamp.isMoving()) {
        found = STEPRAMP_STILL_MOVING;
    }
    if (found == STEPRAMP_READY) {
        found = beginAll();
    }
    return found;
}

const __FlashStringHelper *StepRampAxis::problem() const
{
    switch (found) {
    case STEPRAMP_READY:
        return F("ready");
    case STEPRAMP_TOO_MANY:
        return F("over four axes");
    case STEPRAMP_BAD_PINS:
        return F("a pin is used twice");
    case STEPRAMP_RAMP_MISSING:
        return F("no ramp: setRamp() first");
    case STEPRAMP_BAD_SPEED:
        return F("the speed is below 0.0075 steps/s");
    case STEPRAMP_SPEED_TOO_HIGH:
        return F("the speed is above this board's mostSpeed()");
    case STEPRAMP_BAD_ACCELERATION:
        return F("acceleration and deceleration must be 0.00012 at least, for 16777214 steps at most");
    case STEPRAMP_BAD_BASE_SPEED:
        return F("the base speed is below 0 or not below the speed");
    case STEPRAMP_BAD_IMAGE:
        return F("the exported ramp is damaged, of several axes, of another clock or too fast, or a setting is wrong");
    case STEPRAMP_NO_ROOM:
        return F("the ramps need more than STEPRAMP_AXIS_RAMP_BYTES");
    default:
        return F("begin() is for motors at rest");
    }
}

/* ---- moves ---- */

StepRampResult StepRampAxis::moveTo(int32_t position)
{
    return found == STEPRAMP_READY ? StepRamp.moveTo(index, position) : STEPRAMP_NO_RAMP;
}

StepRampResult StepRampAxis::move(int32_t steps)
{
    return found == STEPRAMP_READY ? StepRamp.moveBy(index, steps) : STEPRAMP_NO_RAMP;
}

/* [ticks] of a speed, with its sign: 0 of none; of one that is too slow, more than may be. */
int32_t StepRampAxis::intervalOf(float itsSpeed)
{
    const float tooLong = (float)LONGEST_INTERVAL_TICKS + 1;
    float ticks = itsSpeed == 0 ? 0 : clock_hz / itsSpeed;
    return ticks >= -tooLong && ticks <= tooLong ? lroundf(ticks) : INT32_MAX;
}

StepRampResult StepRampAxis::runAt(float newSpeed)
{
    return found == STEPRAMP_READY ? StepRamp.run(index, intervalOf(newSpeed)) : STEPRAMP_NO_RAMP;
}

void StepRampAxis::stop()
{
    StepRamp.stop(index);
}

void StepRampAxis::halt()
{
    StepRamp.halt(index);
}

bool StepRampAxis::run()
{
    StepRamp.poll();
    return isMoving();
}

/* ---- what it does ---- */

bool StepRampAxis::isMoving()
{
    return StepRamp.isMoving(index);
}

int32_t StepRampAxis::position()
{
    return StepRamp.position(index);
}

int32_t StepRampAxis::target()
{
    return StepRamp.target(index);
}

int32_t StepRampAxis::stepsToGo()
{
    return (int32_t)((uint32_t)target() - (uint32_t)position());
}

StepRampResult StepRampAxis::setPosition(int32_t position)
{
    return found == STEPRAMP_READY ? StepRamp.setPosition(index, position) : STEPRAMP_NO_RAMP;
}
