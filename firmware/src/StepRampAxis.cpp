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

/* What begin() asks of a ramp, computed or exported. Only setRamp(), or useRamp() and useRampInFlash(), refer to each, so that the linker leaves
 * computing out of a sketch with exported ramps, and the other way round. Function pointers in an AVR's flash: RAM is scarcer. */
struct StepRampAxis::Kind {
    StepRampProblem (*check)(const StepRampAxis &axis);
    bool (*wantsSlowClock)(const StepRampAxis &axis);
    uint16_t (*write)(const StepRampAxis &axis, uint8_t *bytes, uint16_t room, uint16_t segmentTicks); /* 0: there is no room */
};
#ifdef __AVR__
#define IN_PROGRAM PROGMEM
#define OF_KIND(function) ((decltype(kind->function))pgm_read_ptr(&kind->function))
#else
#define IN_PROGRAM
#define OF_KIND(function) (kind->function)
#endif

StepRampAxis *StepRampAxis::all[STEPRAMP_AXES];
uint8_t StepRampAxis::count;

namespace {

/* A ramp image: version, clock, axes, ramps, the number of each axis' ramp; then the ramps. */
const uint8_t IMAGE_FORMAT = 2, CLOCK_AT = 1, AXES_AT = 2, RAMPS_AT = 3, NUMBERS_AT = 4, RAMP_AT_OF_ONE_AXIS = 5;

/* To the speed: a segment has 32,767 steps at most and takes five bytes then, and each of two sides has 125 segments. What has more is known
 * to have no room before seconds have been spent on it. */
const uint8_t MOST_SEGMENTS_THAT_LONG = STEPRAMP_AXIS_RAMP_BYTES / 5 < 125 ? STEPRAMP_AXIS_RAMP_BYTES / 5 : 125;
const float MOST_STEPS = MOST_SEGMENTS_THAT_LONG * 32767.0f;

/* [steps/s] Slower motors want the slow clock, whose intervals may be longer. */
const float LEAST_FAST_SPEED = 1;

/* [steps/s], [steps/s^2] With less, a step, or the first one from rest, takes longer than LONGEST_INTERVAL_TICKS of the slow
 * clock, or of the fast one. */
const float LEAST_SPEED = 0.0075f, LEAST_ACCELERATION = 0.00012f, LEAST_FAST_ACCELERATION = 0.0072f;

const uint8_t CLOCK_IS_FAST = 1;

/* What it takes to prepare a segment for each axis that moves, 0.7 ms, where a timer's steps take all of the processor that they may: see
 * docs/serial_protocol.md, Keeping pace. */
const uint16_t SEGMENT_TICKS = 11200;

/* What a segment must last beyond that, so that a round of loop() may take 2 ms besides: six segments at least are queued in one round. */
const uint16_t ROUND_TICKS = 5300;

uint8_t ramps[STEPRAMP_AXIS_RAMP_BYTES];
uint16_t length_of_ramps; /* [bytes] of the image in it; 0: it is to be made, as an axis or a ramp is new */

uint32_t clock_hz = SLOW_CLOCK_HZ; /* of the ramps that begin() is about */

uint32_t shortest_interval()
{
    const uint8_t fast_ticks = FAST_CLOCK_HZ / SLOW_CLOCK_HZ; /* in a slow one */
    uint16_t shortest = board_limit(LIMIT_SHORTEST_1_AXIS);
    return clock_hz == FAST_CLOCK_HZ ? shortest : (uint16_t)(shortest + fast_ticks - 1u) / fast_ticks;
}

OUT_OF_LINE void write_head(uint8_t *bytes, uint8_t axes, uint8_t ramps_of_them)
{
    bytes[0] = IMAGE_FORMAT;
    bytes[CLOCK_AT] = clock_hz == FAST_CLOCK_HZ ? CLOCK_IS_FAST : 0;
    bytes[AXES_AT] = axes;
    bytes[RAMPS_AT] = ramps_of_them;
}

OUT_OF_LINE bool is_at_least(float least, float number)
{
    return number >= least && number < 1e9f;
}

} // namespace

StepRampAxis::StepRampAxis(uint8_t itsStepPin, uint8_t itsDirectionPin)
    : index(count++), kind(nullptr), found(STEPRAMP_RAMP_MISSING), isReady(false)
{
    length_of_ramps = 0;
    if (index < STEPRAMP_AXES) {
        all[index] = this;
    }
    StepRamp.setStepper(index, itsStepPin, itsDirectionPin);
}

/* ---- the ramp ---- */

void StepRampAxis::setRamp(float speed, float acceleration, float deceleration, float baseSpeed)
{
    static const Kind IN_PROGRAM computed = {checkComputed, computedWantsSlowClock, writeComputed};
    kind = &computed;
    length_of_ramps = 0;
    ramp.computed = {speed, acceleration, deceleration == 0 ? acceleration : deceleration, baseSpeed};
}

void StepRampAxis::useExported(const uint8_t *image, uint16_t length, bool isInFlash)
{
    static const Kind IN_PROGRAM exported = {checkExported, exportedWantsSlowClock, writeExported};
    kind = &exported;
    length_of_ramps = 0;
    ramp.exported = {image, length, isInFlash};
}

void StepRampAxis::useRamp(const uint8_t *image, uint16_t length)
{
    useExported(image, length, false);
}

void StepRampAxis::useRampInFlash(const uint8_t *image, uint16_t length)
{
    useExported(image, length, true);
}

float StepRampAxis::mostSpeed()
{
    return (float)FAST_CLOCK_HZ / board_limit(LIMIT_SHORTEST_1_AXIS);
}

uint8_t StepRampAxis::imageByte(uint16_t at) const
{
#ifdef __AVR__
    if (ramp.exported.isInFlash) {
        return pgm_read_byte(ramp.exported.image + at);
    }
#endif
    return ramp.exported.image[at];
}

StepRampProblem StepRampAxis::checkExported(const StepRampAxis &axis)
{
    uint8_t head[NUMBERS_AT + 1] = {0}; /* of one axis */
    write_head(head, 1, 1);
    uint16_t same = 0;
    while (same < sizeof head && axis.ramp.exported.length > RAMP_AT_OF_ONE_AXIS && axis.imageByte(same) == head[same]) {
        same++;
    }
    return same == sizeof head ? STEPRAMP_READY : STEPRAMP_BAD_IMAGE;
}

bool StepRampAxis::exportedWantsSlowClock(const StepRampAxis &axis)
{
    return axis.ramp.exported.length > CLOCK_AT && axis.imageByte(CLOCK_AT) != CLOCK_IS_FAST;
}

uint16_t StepRampAxis::writeExported(const StepRampAxis &axis, uint8_t *bytes, uint16_t room, uint16_t)
{
    uint16_t rampBytes = (uint16_t)(axis.ramp.exported.length - RAMP_AT_OF_ONE_AXIS);
    for (uint16_t i = 0; i < rampBytes && rampBytes <= room; i++) {
        bytes[i] = axis.imageByte((uint16_t)(RAMP_AT_OF_ONE_AXIS + i));
    }
    return rampBytes <= room ? rampBytes : 0;
}

StepRampProblem StepRampAxis::checkComputed(const StepRampAxis &axis)
{
    const Computed &its = axis.ramp.computed;
    if (!(its.speed >= LEAST_SPEED)) {
        return STEPRAMP_BAD_SPEED;
    }
    if (ramp_maker_interval(clock_hz, its.speed) < shortest_interval()) {
        return STEPRAMP_SPEED_TOO_HIGH;
    }
    if (!(its.baseSpeed >= 0 && its.baseSpeed < its.speed)) {
        return STEPRAMP_BAD_BASE_SPEED;
    }
    const ramp_wish wish = {its.speed, its.baseSpeed, its.acceleration, its.deceleration, clock_hz, 0};
    float slower = its.acceleration < its.deceleration ? its.acceleration : its.deceleration;
    bool isGood = is_at_least(LEAST_ACCELERATION, its.acceleration) && is_at_least(LEAST_ACCELERATION, its.deceleration) &&
                  ramp_maker_steps(&wish, slower) <= MOST_STEPS;
    return isGood ? STEPRAMP_READY : STEPRAMP_BAD_ACCELERATION;
}

/* It can't be played at the fast clock. */
bool StepRampAxis::computedWantsSlowClock(const StepRampAxis &axis)
{
    const Computed &its = axis.ramp.computed;
    return !is_at_least(LEAST_FAST_SPEED, its.speed) || !is_at_least(LEAST_FAST_ACCELERATION, its.acceleration) ||
           !is_at_least(LEAST_FAST_ACCELERATION, its.deceleration);
}

uint16_t StepRampAxis::writeComputed(const StepRampAxis &axis, uint8_t *bytes, uint16_t room, uint16_t segmentTicks)
{
    const Computed &its = axis.ramp.computed;
    const ramp_wish wish = {its.speed, its.baseSpeed, its.acceleration, its.deceleration, clock_hz, segmentTicks};
    return ramp_maker_write(&wish, bytes, room);
}

StepRampProblem StepRampAxis::check() const
{
    if (index >= STEPRAMP_AXES) {
        return STEPRAMP_TOO_MANY;
    }
    if (stepramp_pins.step[index] == NO_PIN || stepramp_pins.direction[index] == NO_PIN || !arduino_pins_are_good()) {
        return STEPRAMP_BAD_PINS;
    }
    return kind == nullptr ? STEPRAMP_RAMP_MISSING : OF_KIND(check)(*this);
}

/* Writes its ramp. Returns its length, or 0: there is no room. */
uint16_t StepRampAxis::write(uint8_t *bytes, uint16_t room, uint16_t segmentTicks) const
{
    return OF_KIND(write)(*this, bytes, room, segmentTicks);
}

/* One image for all axes. Those that have no good ramp yet are given the first one, as each needs one: they don't move. */
StepRampProblem StepRampAxis::makeImage(uint8_t axes)
{
    uint8_t left = 0, number = 0;
    for (uint8_t i = 0; i < axes; i++) {
        left = (uint8_t)(left + (all[i]->found == STEPRAMP_READY));
    }
    const uint16_t fastTicks = arduino_has_timer() ? (uint16_t)(SEGMENT_TICKS * left + ROUND_TICKS) : 0;
    const uint16_t segmentTicks = clock_hz == FAST_CLOCK_HZ ? fastTicks : fastTicks / (FAST_CLOCK_HZ / SLOW_CLOCK_HZ);
    uint16_t end = (uint16_t)(NUMBERS_AT + axes);
    for (uint8_t i = 0; i < axes; i++) {
        ramps[NUMBERS_AT + i] = 0;
        if (all[i]->found != STEPRAMP_READY) {
            continue;
        }
        uint16_t written = all[i]->write(ramps + end, (uint16_t)((sizeof ramps - end) / left--), segmentTicks);
        if (written == 0) {
            return STEPRAMP_NO_ROOM;
        }
        ramps[NUMBERS_AT + i] = number++;
        end = (uint16_t)(end + written);
    }
    write_head(ramps, axes, number);
    length_of_ramps = end;
    return STEPRAMP_READY;
}

/* The axes whose ramps are good are ready together, or none is: the image that they had before is gone then. */
void StepRampAxis::beginAll()
{
    uint8_t axes = count < STEPRAMP_AXES ? count : STEPRAMP_AXES;
    for (uint8_t i = 0; i < axes; i++) {
        all[i]->found = all[i]->check();
    }
    StepRampProblem outcome = length_of_ramps != 0 ? STEPRAMP_READY : makeImage(axes);
    if (!StepRamp.begin(ramps, length_of_ramps) && outcome == STEPRAMP_READY) {
        outcome = STEPRAMP_BAD_IMAGE;
    }
    for (uint8_t i = 0; i < axes; i++) {
        all[i]->found = all[i]->found == STEPRAMP_READY ? outcome : all[i]->found;
        all[i]->isReady = all[i]->found == STEPRAMP_READY;
    }
}

/* Its ramp can't be played at the fast clock. */
bool StepRampAxis::wantsSlowClock() const
{
    return kind != nullptr && OF_KIND(wantsSlowClock)(*this);
}

/* One clock for all axes: the fast one where a timer makes the steps, unless one of them wants the slow one, and is good with that. */
void StepRampAxis::chooseClock()
{
    bool isFast = arduino_has_timer();
    clock_hz = SLOW_CLOCK_HZ;
    for (uint8_t i = 0; i < STEPRAMP_AXES && all[i] != nullptr; i++) {
        if (all[i]->wantsSlowClock() && all[i]->check() == STEPRAMP_READY) {
            isFast = false;
        }
    }
    clock_hz = isFast ? FAST_CLOCK_HZ : SLOW_CLOCK_HZ;
}

StepRampProblem StepRampAxis::begin()
{
    if (StepRamp.isMoving()) {
        return found = STEPRAMP_STILL_MOVING;
    }
    chooseClock();
    found = check();
    isReady = false;
    if (found == STEPRAMP_READY) {
        beginAll();
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
        return F("a pin is used twice or isn't there, or too many inputs");
    case STEPRAMP_RAMP_MISSING:
        return F("no ramp: setRamp() first");
    case STEPRAMP_BAD_SPEED:
        return F("the speed is below 0.0075 steps/s");
    case STEPRAMP_SPEED_TOO_HIGH:
        return F("the speed is above mostSpeed()");
    case STEPRAMP_BAD_ACCELERATION:
        return F("accelerations: 0.00012 to 1e9; or too many steps");
    case STEPRAMP_BAD_BASE_SPEED:
        return F("base speed: 0 or more, below the speed");
    case STEPRAMP_BAD_IMAGE:
        return F("bad setting, or exported ramp: damaged, too fast, several axes, other clock");
    case STEPRAMP_NO_ROOM:
        return F("all ramps: too long for their room, or too steep to prepare in time");
    default:
        return F("begin() is for motors at rest");
    }
}

/* ---- moves ---- */

StepRampResult StepRampAxis::moveTo(int32_t position)
{
    return isReady ? StepRamp.moveTo(index, position) : STEPRAMP_NO_RAMP;
}

StepRampResult StepRampAxis::move(int32_t steps)
{
    return isReady ? StepRamp.moveBy(index, steps) : STEPRAMP_NO_RAMP;
}

/* [ticks] of a speed, with its sign: 0 of none; of one that is too slow, more than may be, and of one that is much too fast, less. */
int32_t StepRampAxis::intervalOf(float itsSpeed)
{
    if (itsSpeed == 0) {
        return 0;
    }
    float ticks = StepRamp.ticksPerSecond() / itsSpeed;
    int32_t interval = fabsf(ticks) <= LONGEST_INTERVAL_TICKS ? ramp_maker_rounded(ticks) : INT32_MAX;
    return interval != 0 ? interval : 1;
}

StepRampResult StepRampAxis::runAt(float newSpeed)
{
    return isReady ? StepRamp.run(index, intervalOf(newSpeed)) : STEPRAMP_NO_RAMP;
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
    return isReady ? StepRamp.setPosition(index, position) : STEPRAMP_NO_RAMP;
}
