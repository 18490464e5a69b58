/* $title
 *
 * A sketch with the SwitecX25 library: it moves a gauge's pointer there and back. Nothing moves until the start button is
 * pressed, also after a reset; then it finds the gauge's stop, goes STEPS steps up, rests for REST_MS, goes back, and
 * waits for the button again. A press on its way slows it down to rest, and it stays there.
 *
 * Wire the gauge's four contacts to the pins below, in the order of the library, and a button between START_PIN and ground.
 *
$remarks
 *
 * The Arduino IDE wants this file in a folder of its name: ${name}_switecx25/${name}_switecx25.ino. */
#include <Arduino.h>
#include <SwitecX25.h>

/* ---- what you may change ---- */

const int32_t STEPS = $steps;
const unsigned int RANGE_STEPS = $range; /* of the gauge, from stop to stop: so far it goes back to find its stop */
const uint8_t PIN_1 = 4, PIN_2 = 5, PIN_3 = 6, PIN_4 = 7;
const uint8_t START_PIN = A2; /* a button to ground */
const unsigned long REST_MS = 500; /* before the way back */
const unsigned long STEADY_MS = 20; /* so long a button must be pressed, or released, to count */

/* ---- the ramp: {last ramp index of the row, delay in us} ---- */

static unsigned short ${name}_table[][2] = {
$lines
};
const uint16_t ROWS = $rows;

static SwitecX25 ${name}_gauge(RANGE_STEPS, PIN_1, PIN_2, PIN_3, PIN_4);
static bool hasFoundItsStop = false;

static bool isMoving() {
  return !${name}_gauge.stopped;
}

/* Up to STEPS, or back to its stop. */
static void moveBy(int32_t steps) {
  if (!hasFoundItsStop) {
    ${name}_gauge.zero();
    hasFoundItsStop = true;
  }
  ${name}_gauge.setPosition(steps > 0 ? (unsigned int)STEPS : 0U);
}

/* Where it comes to rest by the table. */
static void slowDown() {
  const int32_t way = (int32_t)${name}_gauge.vel * ${name}_gauge.dir;
  const int32_t rest = (int32_t)${name}_gauge.currentStep + way;
  ${name}_gauge.setPosition(rest > 0 ? (unsigned int)rest : 0U);
}

$button

$there_and_back

void setup() {
  pinMode(START_PIN, INPUT_PULLUP);
  ${name}_gauge.accelTable = ${name}_table;
  ${name}_gauge.maxVel = ${name}_table[ROWS - 1][0];
}

void loop() {
  ${name}_gauge.update();
  goThereAndBack();
}
