/* Two motors that draw straight lines together: from corner to corner of a triangle, again and again, each line from rest
 * to rest. The ramps are computed on the board.
 *
 * Drivers' steps are on pins 2 and 3, their directions on pins 5 and 6. When a button between pin A0 and ground is
 * pressed, both slow down at once, still on their line; when it is released, they go on to the corner.
 * What is wrong is told at the serial port at 115200 baud.
 *
 * It fits an Uno and a Mega, with a timer, too; a Leonardo without a timer. With exported ramps, useRampInFlash(), that has room for one. */
#include <StepRampAxis.h>

const uint8_t BUTTON = A0;
const uint8_t CORNERS = 3;
const int32_t CORNER[CORNERS][2] = {{600, 150}, {200, 400}, {0, 0}};  // steps

StepRampAxis x(2, 5);
StepRampAxis y(3, 6);
uint8_t next = 0;

bool begin(StepRampAxis &motor) {
  motor.setRamp(800, 4000);  // steps/s, steps/s^2
  if (motor.begin() == STEPRAMP_READY) {
    return true;
  }
  Serial.println(motor.problem());
  return false;
}

void setup() {
  Serial.begin(115200);
  pinMode(BUTTON, INPUT_PULLUP);
  StepRamp.setPulseWidth(5);  // microseconds: what the driver's data sheet asks for
  begin(x) && begin(y);
}

void loop() {
  StepRamp.poll();  // makes the steps that are due, of both: nothing here may wait

  if (digitalRead(BUTTON) == LOW) {
    StepRamp.stop();
  } else if (!StepRamp.isMoving()) {
    if (x.position() == CORNER[next][0] && y.position() == CORNER[next][1]) {
      next = (next + 1) % CORNERS;
    }
    const int32_t way[] = {CORNER[next][0] - x.position(), CORNER[next][1] - y.position()};
    StepRamp.lineBy(way);
  }
}
