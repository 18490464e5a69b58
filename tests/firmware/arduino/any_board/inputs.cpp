/* Inputs, homing, and where a position is known. */
#include "board.h"
#include "scenarios.h"

/* An emergency stop: no step comes after it, nor before it is released and acknowledged. */
void emergency_stop()
{
    static StepRampAxis x(STEP, DIRECTION);
    CHECK(!StepRamp.setEmergencyStop(STOP_PIN)); /* only poll() sees it here */
    StepRamp.setDriverFault(FAULT_PIN);
    x.setRamp(1000, 2000);
    CHECK(x.begin() == STEPRAMP_READY && is_pulled_up[STOP_PIN] && is_pulled_up[FAULT_PIN]);
    CHECK(StepRamp.stoppedBy() == STEPRAMP_BY_NOTHING && x.setPosition(0) == STEPRAMP_OK && x.isHomed());
    for (uint8_t pin = STOP_PIN; pin <= FAULT_PIN; pin++) {
        uint8_t cause = pin == STOP_PIN ? STEPRAMP_BY_EMERGENCY_STOP : STEPRAMP_BY_DRIVER_FAULT;
        CHECK(x.runAt(900) == STEPRAMP_OK);
        poll_for(700000);
        is_grounded[pin] = true;
        poll_for(pin == STOP_PIN ? 30 : 6000);
        int there = place;
        CHECK(!x.isMoving() && StepRamp.stoppedBy() == cause && x.position() == there);
        poll_for(20000);
        CHECK(place == there && !x.isHomed() && !StepRamp.acknowledge() && x.move(5) == STEPRAMP_STOPPED);
        is_grounded[pin] = false;
        poll_for(20000);
        CHECK(StepRamp.stoppedBy() == cause && x.moveTo(0) == STEPRAMP_STOPPED && x.runAt(10) == STEPRAMP_STOPPED);
        CHECK(x.moveTo(there) == STEPRAMP_STOPPED && x.move(0) == STEPRAMP_STOPPED && x.runAt(0) == STEPRAMP_STOPPED);
        CHECK(!x.isMoving() && x.setPosition(there) == STEPRAMP_OK && x.isHomed() && x.begin() == STEPRAMP_READY);
        CHECK(StepRamp.acknowledge() && StepRamp.stoppedBy() == STEPRAMP_BY_NOTHING && x.move(5) == STEPRAMP_OK);
        poll_until_rest();
        CHECK(place == there + 5 && x.position() == place);
    }
}

/* Pressed at each moment of a round, released and acknowledged before the next one: what isn't told yet can't be acknowledged. */
void short_stop()
{
    static StepRampAxis x(STEP, DIRECTION);
    StepRamp.setEmergencyStop(STOP_PIN);
    x.setRamp(1000, 8000);
    CHECK(x.begin() == STEPRAMP_READY);
    for (unsigned long after_us = 1; after_us < 40; after_us++) {
        CHECK(x.runAt(900) == STEPRAMP_OK);
        poll_for(150000);
        grounds_us = now_us + after_us;
        StepRamp.poll();
        grounds_us = ULONG_MAX;
        is_grounded[STOP_PIN] = false;
        int there = place;
        StepRamp.acknowledge();
        poll_for(20000);
        CHECK(x.isMoving() == (place > there + 10));
        x.stop();
        poll_until_rest();
        poll_for(6000);
        CHECK(StepRamp.acknowledge() && x.position() == place);
    }
}

/* Homing comes to the same step each time; the way into a switch is closed, the way back is free. */
void home()
{
    static StepRampAxis x(STEP, DIRECTION), y(STEP + 1, DIRECTION + 1);
    low_switch_at = -37;
    high_switch_at = 900;
    x.setLimitSwitches(LOW_SWITCH, HIGH_SWITCH, STEPRAMP_AT_ONCE);
    x.setRamp(1000, 4000);
    CHECK(x.home(-500, 100) == STEPRAMP_NO_RAMP && x.begin() == STEPRAMP_READY && !x.isHomed() && !y.isHomed());
    CHECK(x.home(-500, 0) == STEPRAMP_OUT_OF_RANGE && x.home(0, 100) == STEPRAMP_OUT_OF_RANGE);
    CHECK(x.home(-1100, 100) == STEPRAMP_OUT_OF_RANGE && x.home(-500, 1100) == STEPRAMP_OUT_OF_RANGE);
    CHECK(StepRamp.home(1, -8000, 40000) == STEPRAMP_OUT_OF_RANGE && StepRamp.home(2, -8000, 40000) == STEPRAMP_OUT_OF_RANGE);
    for (int way = 0; way < 5; way++) {
        CHECK(x.move(50 + 31 * way) == STEPRAMP_OK);
        poll_until_rest();
        CHECK(x.home(-500, 100) == STEPRAMP_OK && x.isHoming() && x.isMoving() && !x.isHomed());
        CHECK(x.move(1) == STEPRAMP_MOVING && x.setPosition(1) == STEPRAMP_MOVING && x.home(-500, 100) == STEPRAMP_MOVING);
        poll_until_rest();
        CHECK(x.isHomed() && !x.isHoming() && place - x.position() == -36);
    }
    CHECK(x.runAt(-500) == STEPRAMP_AT_LIMIT || !x.isAtLimit());
    CHECK(x.moveTo(5000) == STEPRAMP_OK);
    poll_until_rest();
    CHECK(x.isAtLimit() && place >= 900 && place < 910 && x.move(1) == STEPRAMP_AT_LIMIT && !x.isHomed());
    CHECK(x.home(500, 1001) == STEPRAMP_OUT_OF_RANGE && x.home(1001, 100) == STEPRAMP_OUT_OF_RANGE && !x.isMoving());
    CHECK(x.home(500, 100, 10) == STEPRAMP_OK);
    poll_for(30000);
    x.stop();
    poll_until_rest();
    CHECK(!x.isHoming() && !x.isHomed() && x.moveTo(0) == STEPRAMP_OK);
    poll_until_rest();
}

/* The second one sets out the other way, with other speeds and steps, in whatever stage the first one is. */
void two_homes()
{
    static StepRampAxis x(STEP, DIRECTION), y(STEP + 1, DIRECTION + 1);
    low_switch_at = -37;
    second_switch_at = 400;
    x.setLimitSwitches(LOW_SWITCH);
    y.setLimitSwitches(STEPRAMP_NO_PIN, SECOND_SWITCH);
    x.setRamp(1000, 4000);
    y.setRamp(1000, 4000);
    CHECK(x.begin() == STEPRAMP_READY && y.begin() == STEPRAMP_READY);
    CHECK(x.home(-500, 100, 0) == STEPRAMP_OUT_OF_RANGE);
    for (unsigned long later_us = 0; later_us < 1500000; later_us += 125000) {
        CHECK(x.moveTo(100) == STEPRAMP_OK && y.moveTo(-50) == STEPRAMP_OK);
        poll_until_rest();
        CHECK(x.home(-500, 100, 50) == STEPRAMP_OK);
        poll_for(later_us);
        CHECK(y.home(800, 150, 10) == STEPRAMP_OK);
        poll_until_rest();
        CHECK(x.isHomed() && place - x.position() == -36);
        CHECK(y.isHomed() && second_place - y.position() == 399);
    }
}

/* While the position is known: nowhere beyond, and a run comes to rest at the last step that is allowed. */
void soft_limits()
{
    static StepRampAxis x(STEP, DIRECTION);
    x.setSoftLimits(-50, 300);
    x.setRamp(1000, 4000);
    CHECK(x.begin() == STEPRAMP_READY && !x.isHomed() && x.moveTo(310) == STEPRAMP_OK);
    poll_until_rest();
    CHECK(place == 310 && x.setPosition(310) == STEPRAMP_OK && x.isHomed());
    CHECK(x.moveTo(301) == STEPRAMP_AT_LIMIT && x.runAt(500) == STEPRAMP_AT_LIMIT && x.moveTo(-51) == STEPRAMP_AT_LIMIT);
    CHECK(x.runAt(-500) == STEPRAMP_OK);
    poll_until_rest();
    CHECK(x.position() == -50 && place == -50 && x.move(-1) == STEPRAMP_AT_LIMIT && x.moveTo(300) == STEPRAMP_OK);
    poll_until_rest();
    CHECK(place == 300);
}

/* What inputs can't be is found by begin(). */
void bad_inputs()
{
    static StepRampAxis x(STEP, DIRECTION);
    x.setRamp(1000, 2000);
    x.setLimitSwitches(LOW_SWITCH);
    StepRamp.setInputLooks(11);
    CHECK(x.begin() == STEPRAMP_BAD_IMAGE);
    StepRamp.setInputLooks(10);
    CHECK(x.begin() == STEPRAMP_READY);
    for (uint8_t pin = 10; pin < 16; pin++) {
        StepRamp.setEmergencyStop(pin);
    }
    CHECK(x.begin() == STEPRAMP_READY);
    StepRamp.setHighLimit(0, STEP);
    CHECK(x.begin() == STEPRAMP_BAD_PINS);
    StepRamp.setEmergencyStop(16);
    CHECK(strcmp((const char *)x.problem(), "a pin is used twice or isn't there, or too many inputs") == 0);
    CHECK(x.begin() == STEPRAMP_BAD_PINS && !StepRamp.begin(image, image_bytes));
}

/* A switch can't be two things at once, as one of two axes is: the first would silently be forgotten. */
void shared_inputs()
{
    static StepRampAxis x(STEP, DIRECTION), y(STEP + 1, DIRECTION + 1);
    x.setRamp(1000, 4000);
    x.setLimitSwitches(LOW_SWITCH);
    x.setLimitSwitches(LOW_SWITCH, STEPRAMP_NO_PIN, STEPRAMP_AT_ONCE);
    CHECK(x.begin() == STEPRAMP_READY);
    y.setLimitSwitches(LOW_SWITCH);
    CHECK(x.begin() == STEPRAMP_BAD_PINS && strcmp((const char *)x.problem(), "a pin is used twice or isn't there, or too many inputs") == 0);
}

void shared_stop()
{
    static StepRampAxis x(STEP, DIRECTION);
    x.setRamp(1000, 4000);
    StepRamp.setDriverFault(STOP_PIN);
    StepRamp.setEmergencyStop(STOP_PIN);
    CHECK(x.begin() == STEPRAMP_BAD_PINS && !StepRamp.begin(image, image_bytes));
}

/* Before the first good begin() nothing happens, and nothing bad. */
void early_poll()
{
    static StepRampAxis x(STEP, DIRECTION);
    StepRamp.setEmergencyStop(STOP_PIN);
    StepRamp.setLowLimit(0, LOW_SWITCH);
    poll_for(10000);
    StepRamp.setPulseWidth(101);
    CHECK(!StepRamp.begin(image, image_bytes));
    poll_for(10000);
    x.setRamp(1000, 2000);
    CHECK(x.begin() == STEPRAMP_BAD_IMAGE && !x.run());
    StepRamp.setPulseWidth(0);
    CHECK(x.begin() == STEPRAMP_READY);
    rest_at(x, 100);
}

/* Drivers that are let go at rest aren't between the stages of homing. */
void home_without_hold()
{
    static StepRampAxis x(STEP, DIRECTION);
    low_switch_at = -37;
    StepRamp.setEnablePin(ENABLE);
    StepRamp.setEnableHold(0);
    x.setLimitSwitches(LOW_SWITCH);
    x.setRamp(1000, 4000);
    CHECK(x.begin() == STEPRAMP_READY);
    poll_for(3000);
    int before = edges[ENABLE];
    CHECK(x.home(-500, 100) == STEPRAMP_OK);
    poll_until_rest();
    poll_for(3000);
    CHECK(x.isHomed() && edges[ENABLE] - before == 2 && level[ENABLE] == HIGH);
}

/* Two axes that are too much for the board at once: the other one is refused as long as the first is homed, between its stages, too. */
void home_beside_another()
{
    static StepRampAxis x(STEP, DIRECTION), y(STEP + 1, DIRECTION + 1);
    has_timer = true;
    low_switch_at = -300;
    x.setLimitSwitches(LOW_SWITCH);
    x.setRamp(8000, 400000);
    y.setRamp(20000, 40000);
    CHECK(x.begin() == STEPRAMP_READY && x.home(-7500, 7500, 200) == STEPRAMP_OK);
    for (unsigned long end = now_us + 9000000; x.isHoming();) {
        CHECK(now_us < end && (y.runAt(20000) == STEPRAMP_TOO_FAST));
        StepRamp.poll();
    }
    CHECK(x.isHomed() && y.runAt(20000) == STEPRAMP_OK);
}

/* With the lowest above the highest it goes nowhere, with the utmost positions, too. */
void soft_limits_the_wrong_way_round()
{
    static StepRampAxis x(STEP, DIRECTION);
    x.setSoftLimits(INT32_MAX, INT32_MIN);
    x.setRamp(1000, 4000);
    CHECK(x.begin() == STEPRAMP_READY && x.setPosition(0) == STEPRAMP_OK && x.isHomed());
    CHECK(x.moveTo(10) == STEPRAMP_AT_LIMIT && x.runAt(500) == STEPRAMP_AT_LIMIT && x.runAt(-500) == STEPRAMP_AT_LIMIT);
}

/* Halted at one step after another of a move: known is only where a motor is that was about as slow as at its ramp's first steps.
 * Returns how often it was. */
static int halt_everywhere(StepRampAxis &axis, int32_t steps, int32_t from, int32_t stride, unsigned long slowest_us)
{
    int known = 0;
    for (; from <= steps; from += stride) {
        int32_t before = place;
        CHECK(axis.setPosition(0) == STEPRAMP_OK && axis.isHomed() && axis.moveTo(steps) == STEPRAMP_OK);
        while (place - before < from) {
            StepRamp.poll();
        }
        axis.halt();
        bool is_slow = from == 1 || last_us[STEP] >= slowest_us;
        CHECK(is_slow || !axis.isHomed());
        known += axis.isHomed();
        poll_for(20000);
    }
    return known;
}

void known_positions()
{
    static StepRampAxis x(STEP, DIRECTION);
    has_timer = true;
    x.setSoftLimits(-1000000, 1000000);
    x.setRamp(10000, 400000);
    CHECK(x.begin() == STEPRAMP_READY && StepRamp.ticksPerSecond() == 16000000);
    halt_everywhere(x, 1000, 1, 1, 700); /* the last intervals are 710, 926 and 2236 us: an event early it has the one that follows */
    x.setRamp(2000, 100000, 0, 1800);
    CHECK(x.begin() == STEPRAMP_READY);
    CHECK(halt_everywhere(x, 30, 1, 1, 500) > 0);
}

/* At a speed whose interval is long to the queue it is as fast in each of its parts. */
void known_positions_of_long_intervals()
{
    static StepRampAxis x(STEP, DIRECTION);
    has_timer = true;
    x.setSoftLimits(-1000000, 1000000);
    x.setRamp(400, 1000);
    CHECK(x.begin() == STEPRAMP_READY);
    for (unsigned long after_us = 0; after_us < 5000; after_us += 100) {
        CHECK(x.setPosition(0) == STEPRAMP_OK && x.runAt(300) == STEPRAMP_OK);
        poll_for(500000 + after_us);
        x.halt();
        CHECK(!x.isHomed());
        CHECK(x.setPosition(0) == STEPRAMP_OK && x.runAt(20) == STEPRAMP_OK); /* slower than the ramp's first step */
        poll_for(500000 + after_us);
        x.halt();
        CHECK(x.isHomed());
    }
}
