/* $title
 *
 * A sketch with the TeensyStep library: it moves a stepper motor there and back. Nothing moves until the start button
 * is pressed, also after a reset; then it makes STEPS steps, rests for REST_MS, makes as many steps back, and waits for
 * the button again. A press on its way slows it down to rest, and it stays there.
 *
 * Wire the driver's step, direction and enable inputs to the pins below, the grounds together, and a button between
 * START_PIN and ground. Steps are the pulses of the driver, microsteps if it makes such.
 *
$remarks
 *
 * The Arduino IDE wants this file in a folder of its name: ${name}_teensystep/${name}_teensystep.ino. */
#include <Arduino.h>
#include <TeensyStep.h>

/* ---- what you may change ---- */

const int32_t STEPS = $steps; /* below 0: backward first */
const uint8_t STEP_PIN = 2;
const uint8_t DIRECTION_PIN = 5; /* high is forward */
const uint8_t ENABLE_PIN = 8; /* low enables the driver, from the first move on */
const uint8_t START_PIN = 14; /* a button to ground */
const unsigned long REST_MS = 500; /* before the way back */
const unsigned long STEADY_MS = 20; /* so long a button must be pressed, or released, to count */

/* ---- the ramp ---- */

const int32_t SLEW_SPEED = $setMaxSpeed; /* steps/s */
const int32_t PULL_IN_SPEED = $setPullInSpeed; /* steps/s: it begins and ends with it */
const uint32_t ACCELERATION = $setAcceleration; /* steps/s^2 */

static Stepper ${name}_motor(STEP_PIN, DIRECTION_PIN);
static StepControl ${name}_control;

static bool isMoving() {
  return ${name}_control.isRunning();
}

static void moveBy(int32_t steps) {
  digitalWrite(ENABLE_PIN, LOW);
  ${name}_motor.setTargetRel(steps);
  ${name}_control.moveAsync(${name}_motor);
}

static void slowDown() {
  ${name}_control.stopAsync();
}

$button

$there_and_back

void setup() {
  digitalWrite(ENABLE_PIN, HIGH);
  pinMode(ENABLE_PIN, OUTPUT);
  pinMode(START_PIN, INPUT_PULLUP);
  ${name}_motor.setMaxSpeed(SLEW_SPEED);
  ${name}_motor.setPullInSpeed(PULL_IN_SPEED);
  ${name}_motor.setAcceleration(ACCELERATION);
}

void loop() {
  goThereAndBack();
}
