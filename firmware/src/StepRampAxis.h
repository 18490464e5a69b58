/* A stepper motor in a sketch that has no host:
 *
 *   #include <StepRampAxis.h>
 *   StepRampAxis x(2, 5);                         // step on pin 2, direction on pin 5
 *   void setup() {
 *       x.setRamp(1000, 2000);                    // steps/s, steps/s^2
 *       if (x.begin() != STEPRAMP_READY) { ... }  // x.problem() says what is wrong
 *       x.moveTo(800);
 *   }
 *   void loop() { x.run(); }
 *
 * Up to four of them. Their ramps are computed by begin(): each interval is within 0.2 % of the exact one, or within 0.4,
 * 0.8 or 1.6 % where their memory is short, or 6.4 % where a timer makes the steps and leaves less time to prepare them; and a tick
 * more or less. What is the same for all motors, as the pulses' width or the enable pin, is set
 * with StepRamp (StepRamp.h) before. */
#ifndef STEPRAMP_SKETCH_AXIS_H
#define STEPRAMP_SKETCH_AXIS_H

#include "StepRamp.h"

/* What begin() finds. */
enum StepRampProblem : uint8_t {
    STEPRAMP_READY,
    STEPRAMP_TOO_MANY,         /* there are more than four axes */
    STEPRAMP_BAD_PINS,         /* one of the step and direction pins, the enable pin and the inputs' isn't there, or is two of them at once;
                                * or an input is two things at once, or there are more than nine inputs, or six emergency stops */
    STEPRAMP_RAMP_MISSING,     /* neither setRamp() nor useRamp() has been called */
    STEPRAMP_BAD_SPEED,        /* it is below 0.0075 steps/s, or no number */
    STEPRAMP_SPEED_TOO_HIGH,   /* for this board: see mostSpeed() */
    STEPRAMP_BAD_ACCELERATION, /* or deceleration: it is below 0.00012 steps/s^2, with which a step from rest takes
                                * 129 s, or 1e9 or more, or takes more than 2 million steps to the speed, where there is 4 KB of RAM 4 million */
    STEPRAMP_BAD_BASE_SPEED,   /* it is below 0, or not below the speed */
    STEPRAMP_BAD_IMAGE,        /* an exported ramp is damaged, for several axes, too fast, or for another clock: for the fast one
                                * where no timer makes the steps; or one of StepRamp's settings is out of its range */
    STEPRAMP_NO_ROOM,          /* the ramps of all axes need more than STEPRAMP_AXIS_RAMP_BYTES, as with a wrong length given to useRamp(), or a timer's more time than there is to
                                * prepare them: as of three axes that come to 30,000 steps/s in 5 ms */
    STEPRAMP_STILL_MOVING      /* begin() is for motors at rest */
};

class StepRampAxis {
public:
    /* It must not go away again. */
    StepRampAxis(uint8_t stepPin, uint8_t directionPin);
    StepRampAxis(const StepRampAxis &) = delete;
    StepRampAxis &operator=(const StepRampAxis &) = delete;

    /* ---- the ramp: before begin() ---- */

    /* [steps/s], [steps/s^2]. A deceleration of 0 is that of the acceleration. At the base speed the ramp begins and ends. */
    void setRamp(float speed, float acceleration, float deceleration = 0, float baseSpeed = 0);

    /* Instead: a ramp image of one axis as StepRamp exports it, in RAM or, on an AVR, in flash (PROGMEM). */
    void useRamp(const uint8_t *image, uint16_t length);
    void useRampInFlash(const uint8_t *image, uint16_t length);

    /* ---- limit switches, before begin(): where positions are small, and at the other end; STEPRAMP_NO_PIN: none ---- */

    void setLimitSwitches(uint8_t lowPin, uint8_t highPin = STEPRAMP_NO_PIN, uint8_t how = STEPRAMP_CLOSES);

    /* [steps] While its position is known, see isHomed(), it goes nowhere beyond, and a run ends there. With
     * the lowest above the highest it goes nowhere. */
    void setSoftLimits(int32_t lowest, int32_t highest);

    /* At rest: makes all axes ready whose ramp is set, this one and others. Their ramps are computed together, and not again before
     * one of them is set: set all of them before the first begin(). An axis whose own ramp or pins are refused isn't ready; where
     * the ramps of all together are refused, none is. */
    StepRampProblem begin();

    /* What begin() found last, in words. */
    const __FlashStringHelper *problem() const;

    /* [steps/s] The highest speed of one axis on this board. */
    static float mostSpeed();

    /* ---- moves. A new one may come while the last one is under way: the motor goes on from the speed it has ---- */

    StepRampResult moveTo(int32_t position);
    StepRampResult move(int32_t steps); /* from where it would come to rest */

    /* At a speed [steps/s], no higher than the ramp's, until stop(); below 0 backward. */
    StepRampResult runAt(float speed);

    /* To a limit switch at this speed [steps/s], which is the low one below 0; back off, by a step at least, and again slowly: where it sees the switch then is
     * position 0, and it comes to rest a few steps beyond: position() is 0 to -4 or so then, at the high switch 0 to 4. At the slow speed the motor is
     * halted, without its ramp: it has to be one at which no step is lost by that. It
     * moves until that is done, and isHomed() then; not so if the switch stays as it is for 64 times stepsBack beyond the way to it.
     * STEPRAMP_OUT_OF_RANGE where no switch has been set at that end, where a speed is above the ramp's, or 0, and where the slow one is below 0. */
    StepRampResult home(float speed, float slowSpeed, uint16_t stepsBack = 20);

    void stop(); /* slows down with the ramp */
    void halt(); /* no further step. A motor that was fast may slip */

    /* StepRamp.poll(), for all axes: call it as often as you can. Returns isMoving(). */
    bool run();

    /* ---- what it does ---- */

    bool isMoving();
    int32_t position();
    int32_t target();
    int32_t stepsToGo(); /* to the target; beyond 2^31 - 1 it comes round, as positions do */
    bool isHoming();
    bool isHomed(); /* its position is known, though hardly ever 0 right after home(): see there, and StepRamp.h */
    bool isAtLimit();

    /* At rest: says where the motor is. */
    StepRampResult setPosition(int32_t position);

private:
    struct Kind;
    struct Computed {
        float speed, acceleration, deceleration, baseSpeed; /* [steps/s], [steps/s^2] */
    };
    struct Exported {
        const uint8_t *image;
        uint16_t length; /* [bytes] of the image */
        bool isInFlash;
    };

    static void chooseClock();
    static void beginAll();
    static StepRampProblem makeImage(uint8_t axes);
    StepRampProblem check() const;
    bool wantsSlowClock() const;
    uint16_t write(uint8_t *bytes, uint16_t room, uint16_t segmentTicks) const;
    void useExported(const uint8_t *image, uint16_t length, bool isInFlash);
    uint8_t imageByte(uint16_t at) const;
    static StepRampProblem checkComputed(const StepRampAxis &axis);
    static StepRampProblem checkExported(const StepRampAxis &axis);
    static bool computedWantsSlowClock(const StepRampAxis &axis);
    static bool exportedWantsSlowClock(const StepRampAxis &axis);
    static uint16_t writeComputed(const StepRampAxis &axis, uint8_t *bytes, uint16_t room, uint16_t segmentTicks);
    static uint16_t writeExported(const StepRampAxis &axis, uint8_t *bytes, uint16_t room, uint16_t segmentTicks);
    static int32_t intervalOf(float speed);

    static StepRampAxis *all[STEPRAMP_AXES];
    static uint8_t count; /* of all, those that are too many as well */

    uint8_t index;
    const Kind *kind; /* of its ramp; none yet: nullptr */
    StepRampProblem found;
    bool isReady; /* its ramp is in the image that is used */
    union {
        Computed computed;
        Exported exported;
    } ramp;
};

#endif
