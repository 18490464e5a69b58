/* StepRamp for Arduino: moves up to four stepper motors, or three gauges, along ramps designed with StepRamp.
 *
 *   #include <StepRamp.h>
 *   const uint8_t ramp[] = {...};                     // a ramp image, exported by StepRamp
 *   void setup() {
 *       StepRamp.setStepper(0, 2, 5);                 // axis 0: step on pin 2, direction on pin 5
 *       StepRamp.begin(ramp, sizeof ramp);
 *       StepRamp.moveTo(0, 1000);
 *   }
 *   void loop() { StepRamp.poll(); }
 *
 * Nothing here waits. Without more, poll() makes the steps that are due, on any board: call it as often as you can, and don't use
 * delay(). On an Uno, Nano, Mega, Leonardo or Micro a timer's interrupt makes them when the sketch says so, in one of its files:
 *
 *   #include <StepRampTimer1.h>                       // Uno, Nano, Mega, Leonardo, Micro
 *   #include <StepRampTimer3.h>                       // or Mega, Leonardo, Micro; StepRampTimer4.h, StepRampTimer5.h: Mega
 *
 * and, when the emergency stop is at a pin without an interrupt of its own, but with one of pin changes:
 *
 *   #include <StepRampPinChange.h>                    // beside one of the above
 *
 * Then poll() only plans: at the highest speeds, 100,000 steps/s, it is wanted 2 ms after it has returned, at a tenth of that 4 ms. So
 * ramps that a StepRampAxis computes are made; of an exported one that is so where it takes 0.2 s or more to its speed. That timer, the
 * PWM of its pins and the registers GPIOR0 to GPIOR2 are StepRamp's then. */
#ifndef STEPRAMP_H
#define STEPRAMP_H

#include <Arduino.h>

/* What moves and the like return. The numbers are those of the serial protocol. */
enum StepRampResult : uint8_t {
    STEPRAMP_OK = 0,
    STEPRAMP_MOVING = 4,       /* not while something moves, or not while a line is drawn */
    STEPRAMP_NO_RAMP = 5,      /* begin() has had no good ramp */
    STEPRAMP_OUT_OF_RANGE = 6, /* there is no such axis, or no such position, or the speed or interval is none that the ramp has; of home()
                                * also: no limit switch has been set at that end */
    STEPRAMP_TOO_FAST = 12,    /* together, these axes need more time than the board has */
    STEPRAMP_STOPPED = 13,     /* an emergency stop or a driver's fault: see stoppedBy() */
    STEPRAMP_AT_LIMIT = 14     /* a limit switch at that end is active, or a soft limit lies on the way; the other way is free */
};

/* What an input's switch is like, and what it does; they can be added. */
enum StepRampSwitch : uint8_t {
    STEPRAMP_CLOSES = 0,      /* it connects the pin to ground when it is pressed */
    STEPRAMP_AT_ONCE = 0x20,  /* a limit: no further step, instead of slowing down with the ramp */
    STEPRAMP_OPENS = 0x40,    /* it leaves the pin to its pull-up when it is pressed: a wire that breaks stops, too */
    STEPRAMP_NO_PULL_UP = 0x80 /* the chip's own pull-up stays off */
};

/* What has stopped all axes; both may have. */
enum StepRampCause : uint8_t {
    STEPRAMP_BY_NOTHING = 0,
    STEPRAMP_BY_EMERGENCY_STOP = 1,
    STEPRAMP_BY_DRIVER_FAULT = 2
};

constexpr uint8_t STEPRAMP_AXES = 4;
constexpr uint8_t STEPRAMP_GAUGES = 3;
constexpr uint8_t STEPRAMP_NO_PIN = 255;
constexpr uint8_t STEPRAMP_INPUTS = 9;
constexpr uint16_t STEPRAMP_HOLD = 0xFFFF; /* for setEnableHold: motors stay enabled */

class StepRampClass {
public:
    /* ---- wiring: before begin() ---- */

    void setStepper(uint8_t axis, uint8_t stepPin, uint8_t directionPin);

    /* One enable pin for all drivers. */
    void setEnablePin(uint8_t pin);

    /* A gauge such as the X25: its coils' four pins, which it drives itself. With a gauge, all axes are gauges. */
    void setGauge(uint8_t axis, uint8_t pin1, uint8_t pin2, uint8_t pin3, uint8_t pin4);

    /* ---- inputs: before begin(). Nine at most, each at a pin of its own and for one thing. A sketch that calls none of these has nothing of them in it ---- */

    /* No step after it, until it is released and acknowledged. Six at most. Where a timer makes the steps, the pin's own interrupt stops
     * them; returns false when the pin has none, or no timer does: then poll() has to see it. With a timer that is in some 5 ms, 15 at most
     * where poll() is called all the time, and a press has to last as long: in so many looks as setInputLooks() says, 1 ms or a round apart.
     * Inputs are watched from when the first begin() returns: what is active then keeps motors from moving, what was pressed and let go of
     * before is not remembered. */
    bool setEmergencyStop(uint8_t pin, uint8_t how = STEPRAMP_CLOSES);

    /* A driver's fault output, often open drain: STEPRAMP_CLOSES. No step after poll() has seen it, as above. */
    void setDriverFault(uint8_t pin, uint8_t how = STEPRAMP_CLOSES);

    /* At an axis' low end, where positions are small, or at its high end: nothing moves on into it. */
    void setLowLimit(uint8_t axis, uint8_t pin, uint8_t how = STEPRAMP_CLOSES);
    void setHighLimit(uint8_t axis, uint8_t pin, uint8_t how = STEPRAMP_CLOSES);

    /* [steps] While an axis' position is known, see isHomed(), it goes nowhere beyond, and a run ends there. With
     * the lowest above the highest it goes nowhere. */
    void setSoftLimits(uint8_t axis, int32_t lowest, int32_t highest);

    /* So many looks in a row, 1 to 10, until an input has changed: 1 ms apart, of an emergency stop 4 us, but
     * where a timer makes the steps and its pin has no interrupt 1 ms, too. At first 4. */
    void setInputLooks(uint8_t looks);

    /* For a StepRampController: where its input of this number is, 0 to 8. What it is for, the host says. Emergency stops can be 0 to 5. */
    void setInputPin(uint8_t input, uint8_t pin);

    /* ---- settings: before begin(). With a StepRampController the host sets them ---- */

    void setBothEdges(uint8_t axis, bool on = true);         /* each edge of the step pin is a step */
    void setStepInverted(uint8_t axis, bool on = true);      /* the step pin rests high */
    void setDirectionInverted(uint8_t axis, bool on = true); /* forward is low */
    void setEnableActiveHigh(bool on = true);
    void setPulseWidth(uint8_t microseconds);      /* at least; 0 to 100 */
    void setDirectionSetup(uint16_t microseconds); /* from the direction to the pulse; 20 to 15000, at first 30 */
    void setEnableLead(uint16_t milliseconds);     /* from enabling to the first pulse; 0 to 1000, at first 1 */
    void setEnableHold(uint16_t milliseconds);     /* from rest to disabling; at first STEPRAMP_HOLD */

    /* Uses a ramp image, which must stay as it is; all positions are 0 at first. Returns false when the image, a setting or a pin isn't
     * good: then nothing moves, until it is called again with good ones; but an input that had no place, or was for two things, stays refused
     * until the board is reset. While something moves it returns false and changes nothing. */
    bool begin(const uint8_t *ramp, uint16_t length);

    /* Plans further steps, and makes those that are due unless a timer does. */
    void poll();

    /* ---- moves. A new one may come while the last one is under way: the motor goes on from the speed it has ---- */

    StepRampResult moveTo(uint8_t axis, int32_t position);
    StepRampResult moveBy(uint8_t axis, int32_t steps); /* from where it would come to rest */

    /* All axes of the ramp image set out at once. */
    StepRampResult moveAllTo(const int32_t positions[]);

    /* A straight line by so many steps of each axis of the ramp image, from rest to rest, with the ramp of one of them. */
    StepRampResult lineBy(const int32_t steps[], uint8_t rampAxis = 0);

    /* At a speed, until stop(): so many ticks a step; below 0 backward. */
    StepRampResult run(uint8_t axis, int32_t interval);

    /* A gauge: back against its stop by so many steps, which then is position 0. */
    StepRampResult zero(uint8_t axis, uint16_t steps);

    /* To the limit switch that lies that way: at an interval as run() has it, back off by some steps beyond the switch, 1 at least, and again
     * slowly [ticks]; where it is seen then is position 0. The motor is halted there, without its ramp, and rests a few steps beyond: the slow
     * interval has to be one at which no step is lost by that. It is moving until that is done; stop() and halt() end it, and so does a switch
     * that stays as it is for 64 times stepsBack beyond the way to it: isHomed() tells. */
    StepRampResult home(uint8_t axis, int32_t interval, uint32_t slowInterval, uint16_t stepsBack = 20);

    /* Slows down. */
    void stop();
    void stop(uint8_t axis);

    /* No further step. A motor that was fast may slip. */
    void halt();
    void halt(uint8_t axis);

    /* ---- what inputs have done ---- */

    /* By STEPRAMP_BY_EMERGENCY_STOP, STEPRAMP_BY_DRIVER_FAULT, or both: nothing moves until acknowledge(), each motion is STEPRAMP_STOPPED,
     * also to where the motor is. setPosition() is taken meanwhile, and makes the position known. */
    uint8_t stoppedBy(); /* it knows before poll() does: at the first look isMoving() may be true yet */

    /* Motions are taken again; somebody should have looked before. Returns false while the input is active. */
    bool acknowledge();

    /* A limit switch of the axis is active. */
    bool isAtLimit(uint8_t axis);

    bool isHoming(uint8_t axis);

    /* Its position is known: it has been homed, zeroed, or setPosition() called, and no more after a halt, or a stop by an input, at a speed at
     * which a motor may slip. Only with inputs. */
    bool isHomed(uint8_t axis);

    /* ---- what it does ---- */

    bool isMoving();
    bool isMoving(uint8_t axis);
    int32_t position(uint8_t axis);
    int32_t target(uint8_t axis);

    /* At rest: says where the motor is. */
    StepRampResult setPosition(uint8_t axis, int32_t position);

    /* Axes of the ramp image; 0 without one. */
    uint8_t axes();

    /* Of the ramp image's intervals. */
    uint32_t ticksPerSecond();

    /* So long, all in all, motion has been delayed because poll() was called too late. With a timer always 0: see ranDry(). */
    uint32_t delayedMicroseconds();

    /* So often a motor has stood still in the midst of a move, because nothing was planned any more when poll() was called. No step is
     * lost by that, but a fast motor may slip. 255 stays 255. */
    uint8_t ranDry();

private:
    bool isTaken(uint8_t axis);

    typedef void (*Attach)(uint8_t interrupt, void (*look)(), int mode);

    bool addEmergencyStop(uint8_t pin, uint8_t how, Attach attach);
    void addInput(uint8_t input, uint8_t pin, Attach attach);
};

extern StepRampClass StepRamp;

#include "boards/polled/pin_interrupts.h"

/* A StepRamp controller: speaks the serial protocol with the StepRamp program, which sends it ramps and settings and
 * moves its motors. The pins are those that StepRamp.setStepper() and the like have been told. On an AVR with 1 KB of
 * EEPROM, ramps and settings are kept there; on other boards until the power goes. */
class StepRampControllerClass {
public:
    /* Speaks over this port, which has begun at 115200 baud, instead of StepRamp.begin(). */
    void begin(Stream &port);

    /* In place of StepRamp.poll(). */
    void poll();
};

extern StepRampControllerClass StepRampController;

#endif
