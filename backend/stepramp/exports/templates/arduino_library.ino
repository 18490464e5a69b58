/* $title
 *
 * A sketch for an Arduino Uno with the StepRamp library, which lies in firmware/ of StepRamp: it moves a stepper motor
 * there and back. Nothing moves until the start button is pressed, also after a reset; then it makes STEPS steps, rests
 * for REST_MS, makes as many steps back, and waits for the button again. A press on its way slows it
 * down to rest, and it stays there.
 *
 * Wire the driver's step, direction and enable inputs to the pins below, the grounds together, and a button between
 * START_PIN and ground.
 *
 * Method $method in $arithmetic, rounded: $rounding. F $timer_hz Hz, v0 $base_speed, v $slew_speed steps/s,
 * a $acceleration, d $deceleration steps/s^2$shape. Steps are the pulses of the driver, microsteps if it makes such.
 * Fastest $fastest steps/s, slowest $slowest steps/s. No interval of the ramp is more than $bound from what StepRamp
$played
 *
 * The Arduino IDE wants this file in a folder of its name: ${name}_library/${name}_library.ino. */
#include <StepRamp.h>
$timer
/* ---- what you may change ---- */

const int32_t STEPS = $steps; /* below 0: backward first; shorter moves keep to the ramp */
const uint8_t STEP_PIN = 2;
const uint8_t DIRECTION_PIN = 5; /* high is forward */
const uint8_t ENABLE_PIN = 8; /* low enables the driver, from the first move on */
const uint8_t START_PIN = A2; /* a button to ground */
const unsigned long REST_MS = 500; /* before the way back */
const uint8_t PULSE_US = $pulse
const unsigned long STEADY_MS = 20; /* so long a button must be pressed, or released, to count */

/* ---- the ramp: the motor is driven from these bytes, they stay in RAM ---- */

const uint8_t RAMP[] = {
$bytes
};

$button

static bool isWayBackDue = false;
static unsigned long movedAt_ms;

void setup() {
  pinMode(START_PIN, INPUT_PULLUP);
  StepRamp.setStepper(0, STEP_PIN, DIRECTION_PIN);
  StepRamp.setEnablePin(ENABLE_PIN);
  StepRamp.setPulseWidth(PULSE_US);
  if (!StepRamp.begin(RAMP, sizeof RAMP)) {
    pinMode(LED_BUILTIN, OUTPUT);
    digitalWrite(LED_BUILTIN, HIGH); /* too fast or too long for this board: nothing will move */
  }
}

void loop() {
  StepRamp.poll();
  const bool isPressed = isPressedAnew();
  if (StepRamp.isMoving()) {
    movedAt_ms = millis();
    if (isPressed) {
      StepRamp.stop();
      isWayBackDue = false;
    }
  } else if (isPressed) { /* while it rests before the way back: stay */
    if (!isWayBackDue) {
      StepRamp.moveBy(0, STEPS);
    }
    isWayBackDue = !isWayBackDue;
  } else if (isWayBackDue && millis() - movedAt_ms >= REST_MS) {
    isWayBackDue = false;
    StepRamp.moveBy(0, -STEPS);
  }
}
