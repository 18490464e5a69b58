/* Three gauges such as the X25 show three values that keep changing. Their coils are connected to the board: pins 2 to
 * 5, 6 to 9 and 10 to 13. A step is a third of a degree, and from stop to stop there are 945.
 *
 * First each needle runs back against its stop, which is 0 from then on. Then each gets a new target four times a
 * second, also while it is still on its way to the last one: it goes on from the speed that it has.
 *
 * It fits an Uno, a Mega and a Leonardo, with a timer, too. */
#include <StepRamp.h>

const uint8_t GAUGES = 3;
const int32_t FULL_SCALE = 945;  // steps

/* 400 steps/s (133 degrees a second), 2000 steps/s^2, for three axes. Made with the StepRamp program. */
const uint8_t RAMP[] = {
    0x02, 0x00, 0x03, 0x01, 0x00, 0x00, 0x00, 0x00, 0x41, 0x00, 0x01, 0x0E, 0x00, 0x88, 0x13, 0x00,
    0x00, 0x38, 0x00, 0x02, 0x84, 0xEE, 0x03, 0xC7, 0x90, 0x01, 0x02, 0xA4, 0x50, 0xC0, 0x6A, 0x02,
    0xEA, 0x0B, 0xFC, 0x12, 0x02, 0xFC, 0x03, 0x98, 0x07, 0x02, 0xE2, 0x01, 0xCE, 0x03, 0x02, 0x70,
    0x8E, 0x02, 0x02, 0x38, 0xAE, 0x01, 0x02, 0x18, 0x78, 0x03, 0x06, 0x56, 0x03, 0x26, 0x5A, 0x04,
    0x0C, 0x3E, 0x04, 0x1A, 0x36, 0x05, 0x0C, 0x26, 0x05, 0x12, 0x24,
};

const unsigned long PERIOD_MS = 250;

bool areZeroed = false;
unsigned long lastChange = 0;

/* Take your own values here, from a sensor for instance: 0 to FULL_SCALE. */
int32_t valueOf(uint8_t gauge, unsigned long now) {
  int32_t swing = (int32_t)(now / (4 + gauge) % (2 * FULL_SCALE));
  return swing < FULL_SCALE ? swing : 2 * FULL_SCALE - swing;
}

void setup() {
  for (uint8_t gauge = 0; gauge < GAUGES; gauge++) {
    uint8_t pin = 2 + 4 * gauge;
    StepRamp.setGauge(gauge, pin, pin + 1, pin + 2, pin + 3);
  }
  StepRamp.begin(RAMP, sizeof RAMP);
  for (uint8_t gauge = 0; gauge < GAUGES; gauge++) {
    StepRamp.zero(gauge, FULL_SCALE);
  }
}

void loop() {
  StepRamp.poll();

  if (!areZeroed) {
    areZeroed = !StepRamp.isMoving();
    return;
  }
  unsigned long now = millis();
  if (now - lastChange >= PERIOD_MS) {
    lastChange = now;
    for (uint8_t gauge = 0; gauge < GAUGES; gauge++) {
      StepRamp.moveTo(gauge, valueOf(gauge, now));
    }
  }
}
