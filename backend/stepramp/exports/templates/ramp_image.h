/* $title
 *
 * Method $method in $arithmetic, rounded: $rounding. F $timer_hz Hz, v0 $base_speed, v $slew_speed steps/s,
 * a $acceleration, d $deceleration steps/s^2$shape. No interval is more than $bound from what is planned.
 * A ramp image, for sketches with the StepRamp library:
 *
 *     StepRamp.setStepper(0, 2, 5);                      step and direction pin of axis 0
 *     StepRamp.begin(${name}_ramp, sizeof ${name}_ramp);    false: too fast for this board
 *     StepRamp.moveTo(0, 800);                           and StepRamp.poll() in loop()
 *
 * The motor is driven from these bytes as they are: they stay in RAM. A larger bound takes fewer of them. With a motor as an object:
 *
 *     StepRampAxis x(2, 5);                              x.useRamp(${name}_ramp, sizeof ${name}_ramp); x.begin();
 *
 * On an AVR they can be in flash until begin() copies them: write PROGMEM behind the brackets, and x.useRampInFlash(...). A sketch with
 * nothing but exported ramps links no computing of ramps, so that 4 KB more are left. */
#ifndef $guard
#define $guard

#include <stdint.h>

static const uint8_t ${name}_ramp[] = {
$bytes
};

#endif
