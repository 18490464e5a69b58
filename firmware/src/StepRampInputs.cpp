/* Emergency stop, drivers' faults, limit switches and homing of a sketch. */
#include "StepRampAxis.h"

#include "boards/polled/arduino_board.h"
#include "stepramp/motion/homing.h"
#include "stepramp/motion/machine.h"
#include "stepramp/motion/machine_axes.h"
#include "stepramp/motion/machine_inputs.h"

#if HAS_INPUTS

static_assert((uint8_t)STEPRAMP_INPUTS == (uint8_t)INPUTS, "StepRamp.h and inputs.h differ");
static_assert((uint8_t)STEPRAMP_AT_ONCE == (uint8_t)INPUT_STOPS_AT_ONCE && (uint8_t)STEPRAMP_OPENS == (uint8_t)INPUT_ACTIVE_HIGH &&
                  (uint8_t)STEPRAMP_NO_PULL_UP == (uint8_t)INPUT_WITHOUT_PULL_UP,
              "StepRamp.h and driver_settings.h differ");
static_assert((uint8_t)STEPRAMP_BY_EMERGENCY_STOP == (uint8_t)BY_EMERGENCY_STOP &&
                  (uint8_t)STEPRAMP_BY_DRIVER_FAULT == (uint8_t)BY_DRIVER_FAULT,
              "StepRamp.h and machine_inputs.h differ");

namespace {

bool are_bad; /* too many, or for two things at once */

void use_inputs()
{
    static const struct inputs_functions functions = {
        machine_check_ways,      machine_check_part,       machine_end_run,
        machine_forget_fast,     machine_inputs_configure, machine_watch_inputs,
        machine_active_inputs,   machine_stopped_by,       machine_acknowledge,
        machine_is_in_emergency, machine_new_stop,         emergency_release,
        settings_check_inputs,   arduino_inputs_are_good,  arduino_configure_inputs,
        arduino_sees_stop};
    stepramp_inputs = &functions;
    stepramp_machine_settings = &stepramp_sketch_settings; /* poll() may be called before begin() */
}

void use_homing()
{
    static const struct homing_functions functions = {homing_begin, homing_end, homing_go_on};
    stepramp_homing = &functions;
}

/* An input that is free, or is at this pin already: emergency stops begin with the first of them, all others with the last. None
 * where the pin is for something else, which it would silently be no more. */
uint8_t input_for(uint8_t pin, uint8_t role)
{
    bool is_stop = role == ROLE_EMERGENCY_STOP;
    uint8_t free = INPUTS;
    for (uint8_t i = 0; i < INPUTS; i++) {
        uint8_t input = is_stop ? (uint8_t)(INPUTS - 1 - i) : i;
        if (stepramp_pins.inputs[input] == pin) {
            return (stepramp_sketch_settings.roles[input] & ROLE_BITS) == role ? input : (uint8_t)INPUTS;
        }
        if (stepramp_pins.inputs[input] == NO_PIN && (!is_stop || input < EMERGENCY_INPUTS)) {
            free = input;
        }
    }
    return free;
}

void add_input(uint8_t pin, uint8_t role, uint8_t how)
{
    use_inputs();
    uint8_t input = input_for(pin, role);
    if (input == INPUTS) {
        are_bad = true;
        return;
    }
    stepramp_pins.inputs[input] = pin;
    stepramp_sketch_settings.roles[input] = (uint8_t)(role | how);
}

} // namespace

bool arduino_inputs_are_good(void)
{
    return !are_bad;
}

/* ---- wiring ---- */

bool StepRampClass::addEmergencyStop(uint8_t pin, uint8_t how, Attach attach)
{
    stepramp_attach_interrupt = attach;
    add_input(pin, ROLE_EMERGENCY_STOP, how & (uint8_t)~INPUT_STOPS_AT_ONCE);
    return arduino_watch_pin(pin);
}

void StepRampClass::setDriverFault(uint8_t pin, uint8_t how)
{
    add_input(pin, ROLE_DRIVER_FAULT, how & (uint8_t)~INPUT_STOPS_AT_ONCE);
}

void StepRampClass::setLowLimit(uint8_t axis, uint8_t pin, uint8_t how)
{
    if (axis < AXES) {
        add_input(pin, (uint8_t)(ROLE_LOW_LIMIT + axis), how);
    }
}

void StepRampClass::setHighLimit(uint8_t axis, uint8_t pin, uint8_t how)
{
    if (axis < AXES) {
        add_input(pin, (uint8_t)(ROLE_HIGH_LIMIT + axis), how);
    }
}

void StepRampClass::setSoftLimits(uint8_t axis, int32_t lowest, int32_t highest)
{
    if (axis < AXES) {
        use_inputs();
        write_u32(stepramp_sketch_settings.soft_limits[axis], (uint32_t)lowest);
        write_u32(stepramp_sketch_settings.soft_limits[axis] + 4, (uint32_t)highest);
    }
}

void StepRampClass::setInputLooks(uint8_t looks)
{
    use_inputs();
    stepramp_sketch_settings.looks = looks;
}

void StepRampClass::addInput(uint8_t input, uint8_t pin, Attach attach)
{
    stepramp_attach_interrupt = attach;
    if (input < INPUTS) {
        use_inputs();
        use_homing();
        stepramp_pins.inputs[input] = pin;
    }
}

void StepRampAxis::setLimitSwitches(uint8_t lowPin, uint8_t highPin, uint8_t how)
{
    if (lowPin != STEPRAMP_NO_PIN) {
        StepRamp.setLowLimit(index, lowPin, how);
    }
    if (highPin != STEPRAMP_NO_PIN) {
        StepRamp.setHighLimit(index, highPin, how);
    }
}

void StepRampAxis::setSoftLimits(int32_t lowest, int32_t highest)
{
    StepRamp.setSoftLimits(index, lowest, highest);
}

/* ---- homing ---- */

StepRampResult StepRampClass::home(uint8_t axis, int32_t interval, uint32_t slowInterval, uint16_t stepsBack)
{
    if (axis >= machine_axes()) {
        return machine_axes() == 0 ? STEPRAMP_NO_RAMP : STEPRAMP_OUT_OF_RANGE;
    }
    if (isTaken(axis)) {
        return STEPRAMP_MOVING;
    }
    if (machine_without_sign(interval) < ramp_image_slew_interval(stepramp_image, axis)) { /* also where it needn't go as fast: at the switch */
        return STEPRAMP_OUT_OF_RANGE;
    }
    use_homing();
    uint16_t detail;
    return (StepRampResult)homing_begin((uint8_t)(1u << axis), &interval, slowInterval, stepsBack, &detail);
}

StepRampResult StepRampAxis::home(float fastSpeed, float slowSpeed, uint16_t stepsBack)
{
    if (!isReady) {
        return STEPRAMP_NO_RAMP;
    }
    return slowSpeed > 0 ? StepRamp.home(index, intervalOf(fastSpeed), (uint32_t)intervalOf(slowSpeed), stepsBack)
                         : STEPRAMP_OUT_OF_RANGE;
}

bool StepRampClass::isHoming(uint8_t axis)
{
    return axis < AXES && (axes_homing() >> axis & 1) != 0;
}

bool StepRampClass::isHomed(uint8_t axis)
{
    return has_inputs() && axis < AXES && !isHoming(axis) && (stepramp_known_positions >> axis & 1) != 0;
}

bool StepRampAxis::isHoming()
{
    return StepRamp.isHoming(index);
}

bool StepRampAxis::isHomed()
{
    return StepRamp.isHomed(index);
}

/* ---- what has stopped motors ---- */

/* An interrupt may have seen it since poll() was called last. */
uint8_t StepRampClass::stoppedBy()
{
    if (!has_inputs()) {
        return STEPRAMP_BY_NOTHING;
    }
    return (uint8_t)(machine_stopped_by() | (emergency_is_latched() ? BY_EMERGENCY_STOP : 0));
}

bool StepRampClass::acknowledge()
{
    return !has_inputs() || machine_acknowledge();
}

bool StepRampClass::isAtLimit(uint8_t axis)
{
    return has_inputs() && axis < AXES && (machine_limit_at(axis, true) != NO_INPUT || machine_limit_at(axis, false) != NO_INPUT);
}

bool StepRampAxis::isAtLimit()
{
    return StepRamp.isAtLimit(index);
}

#endif
