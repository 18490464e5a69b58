/* $title
 *
 * A sketch with the FastAccelStepper library: it moves a stepper motor there and back. Nothing moves until the start button
 * is pressed, also after a reset; then it makes STEPS steps, rests for REST_MS, makes as many steps back, and waits for
 * the button again. A press on its way slows it down to rest, and it stays there.
 *
 * Wire the driver's step, direction and enable inputs to the pins below, the grounds together, and a button between
 * START_PIN and ground. Steps are the pulses of the driver, microsteps if it makes such.
 *
$remarks
 *
 * The Arduino IDE wants this file in a folder of its name: ${name}_fastaccelstepper/${name}_fastaccelstepper.ino. */
#include <Arduino.h>
#include <FastAccelStepper.h>

/* ---- what you may change ---- */

const int32_t STEPS = $steps; /* below 0: backward first */
const uint8_t STEP_PIN = 9; /* on an Uno or Nano 9 or 10 */
const uint8_t DIRECTION_PIN = 5; /* high is forward */
const uint8_t ENABLE_PIN = 8; /* low enables the driver, from the first move on */
const uint8_t START_PIN = A2; /* a button to ground */
const unsigned long REST_MS = 500; /* before the way back */
const unsigned long STEADY_MS = 20; /* so long a button must be pressed, or released, to count */

/* ---- the ramp ---- */

const uint32_t SLEW_SPEED_MILLI_HZ = $setSpeedInMilliHz; /* steps/1000 s */
const int32_t ACCELERATION = $setAcceleration; /* steps/s^2 */
const uint32_t JUMP_STEPS = $setJumpStart; /* it begins with the speed that these steps lead to */

static FastAccelStepperEngine ${name}_engine;
static FastAccelStepper *${name}_motor;

static bool isMoving() {
  return ${name}_motor->isRunning();
}

static void moveBy(int32_t steps) {
  ${name}_motor->enableOutputs();
  ${name}_motor->move(steps);
}

static void slowDown() {
  ${name}_motor->stopMove();
}

$button

$there_and_back

/* Returns whether this board makes such steps at that pin. */
static bool begin() {
  ${name}_engine.init();
  ${name}_motor = ${name}_engine.stepperConnectToPin(STEP_PIN);
  if (!${name}_motor) {
    return false;
  }
  ${name}_motor->setDirectionPin(DIRECTION_PIN);
  ${name}_motor->setEnablePin(ENABLE_PIN);
  ${name}_motor->setAutoEnable(false);
  ${name}_motor->setJumpStart(JUMP_STEPS);
  return ${name}_motor->setSpeedInMilliHz(SLEW_SPEED_MILLI_HZ) == 0 && ${name}_motor->setAcceleration(ACCELERATION) == 0;
}

static bool isUsable;

void setup() {
  pinMode(START_PIN, INPUT_PULLUP);
  isUsable = begin();
  if (!isUsable) {
    pinMode(LED_BUILTIN, OUTPUT);
    digitalWrite(LED_BUILTIN, HIGH); /* too fast for this board, or not its pin: nothing will move */
  }
}

void loop() {
  if (isUsable) {
    goThereAndBack();
  }
}
