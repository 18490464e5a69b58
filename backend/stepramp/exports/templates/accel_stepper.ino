/* $title
 *
 * A sketch with the AccelStepper library: it moves a stepper motor there and back. Nothing moves until the start button
 * is pressed, also after a reset; then it makes STEPS steps, rests for REST_MS, makes as many steps back, and waits for
 * the button again. A press on its way slows it down to rest, and it stays there.
 *
 * Wire the driver's step, direction and enable inputs to the pins below, the grounds together, and a button between
 * START_PIN and ground. Steps are the pulses of the driver, microsteps if it makes such.
 *
$remarks
 *
 * The Arduino IDE wants this file in a folder of its name: ${name}_accelstepper/${name}_accelstepper.ino. */
#include <Arduino.h>
#include <AccelStepper.h>

/* ---- what you may change ---- */

const int32_t STEPS = $steps; /* below 0: backward first */
const uint8_t STEP_PIN = 2;
const uint8_t DIRECTION_PIN = 5; /* high is forward */
const uint8_t ENABLE_PIN = 8; /* low enables the driver, from the first move on */
const uint8_t START_PIN = A2; /* a button to ground */
const unsigned long REST_MS = 500; /* before the way back */
const unsigned long STEADY_MS = 20; /* so long a button must be pressed, or released, to count */
const unsigned int PULSE_US = 5; /* a pulse lasts so long at least */

/* ---- the ramp ---- */

const float SLEW_SPEED = $setMaxSpeed; /* steps/s */
const float ACCELERATION = $setAcceleration; /* steps/s^2 */

static AccelStepper ${name}_motor(AccelStepper::DRIVER, STEP_PIN, DIRECTION_PIN);

static bool isMoving() {
  return ${name}_motor.isRunning();
}

static void moveBy(int32_t steps) {
  ${name}_motor.enableOutputs();
  ${name}_motor.move(steps);
}

static void slowDown() {
  ${name}_motor.stop();
}

$button

$there_and_back

void setup() {
  pinMode(START_PIN, INPUT_PULLUP);
  ${name}_motor.setPinsInverted(false, false, true);
  ${name}_motor.setEnablePin(ENABLE_PIN);
  ${name}_motor.disableOutputs();
  ${name}_motor.setMinPulseWidth(PULSE_US);
  ${name}_motor.setMaxSpeed(SLEW_SPEED);
  ${name}_motor.setAcceleration(ACCELERATION);
}

void loop() {
  ${name}_motor.run();
  goThereAndBack();
}
