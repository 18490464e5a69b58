/* A stage on a lead screw goes to and fro: 0 mm, 20 mm, 5 mm, 12.5 mm, with a second's rest between.
 *
 * A driver for a motor of 200 steps a turn, set to half steps: step on pin 2, direction on pin 5, enable on pin 8 (the
 * X axis of the common CNC shield). The screw moves the stage by 8 mm a turn.
 *
 * It fits an Uno, a Mega and a Leonardo, with a timer, too. */
#include <StepRamp.h>

const int32_t STEPS_PER_TURN = 200 * 2;
const int32_t UM_PER_TURN = 8000;

/* 30 mm/s (1500 steps/s), 200 mm/s^2 (10,000 steps/s^2). Made with the StepRamp program. */
const uint8_t RAMP[] = {
    0x02, 0x00, 0x01, 0x01, 0x00, 0x00, 0x3D, 0x00, 0x01, 0x0E, 0x00, 0x35, 0x05, 0x00, 0x00, 0x34,
    0x00, 0x02, 0xEE, 0xDC, 0x01, 0xBF, 0x40, 0x02, 0xCE, 0x23, 0xD0, 0x2F, 0x02, 0x80, 0x05, 0xBE,
    0x08, 0x02, 0xBC, 0x01, 0x9C, 0x03, 0x02, 0x3E, 0xCE, 0x01, 0x03, 0x0C, 0x78, 0x04, 0x2C, 0x66,
    0x05, 0x26, 0x4C, 0x07, 0x18, 0x32, 0x09, 0x14, 0x24, 0x0C, 0x0E, 0x18, 0x10, 0x08, 0x10, 0x14,
    0x12, 0x0A, 0x1A, 0x04, 0x08,
};

const int32_t PLACES_UM[] = {20000, 5000, 12500, 0};
const uint8_t PLACES = sizeof PLACES_UM / sizeof PLACES_UM[0];
const unsigned long REST_MS = 1000;

uint8_t nextPlace = 0;
bool wasMoving = false;
unsigned long restedSince = 0;

int32_t stepsOf(int32_t micrometres) {
  return micrometres * STEPS_PER_TURN / UM_PER_TURN;
}

void setup() {
  StepRamp.setStepper(0, 2, 5);
  StepRamp.setEnablePin(8);
  if (!StepRamp.begin(RAMP, sizeof RAMP)) {
    pinMode(LED_BUILTIN, OUTPUT);
    digitalWrite(LED_BUILTIN, HIGH);  // the ramp is not one that this board can play
  }
}

void loop() {
  StepRamp.poll();

  bool moves = StepRamp.isMoving();
  if (wasMoving && !moves) {
    restedSince = millis();
  }
  wasMoving = moves;
  if (!moves && millis() - restedSince >= REST_MS) {
    StepRamp.moveTo(0, stepsOf(PLACES_UM[nextPlace]));
    nextPlace = (nextPlace + 1) % PLACES;
    restedSince = millis();
  }
}
