/* A motor that finds its place by a limit switch: it runs to the switch, backs off, and comes again slowly; where it sees the
 * switch then is position 0. It comes to rest some steps beyond, so that position() is 0 to -4 then. It goes to step 400, and homes again.
 *
 * A driver's step is on pin 2, its direction on pin 5. The switch lies between pin 9 and ground, at the end where positions are
 * small, and closes when it is pressed; for one that opens add STEPRAMP_OPENS.
 * Where it has come to is told at the serial port at 115200 baud.
 *
 * It fits an Uno without a timer, and a Mega; no Leonardo. With an exported ramp, useRampInFlash(), it fits an Uno with a timer, too. */
#include <StepRampAxis.h>

const uint8_t LOW_SWITCH = 9;
const int32_t PLACE = 400;

StepRampAxis stage(2, 5);

void setup() {
  Serial.begin(115200);
  stage.setLimitSwitches(LOW_SWITCH);  // and the pin of one at the other end, if there is one
  stage.setRamp(1000, 8000);           // steps/s, steps/s^2
  if (stage.begin() != STEPRAMP_READY) {
    Serial.println(stage.problem());
  }
}

bool hasTried = false;

void loop() {
  if (stage.run()) {  // it moves, or homes: nothing here may wait
    return;
  }
  if (stage.isHomed() && stage.position() != PLACE) {
    Serial.println(stage.position());
    stage.moveTo(PLACE);
    hasTried = false;
  } else if (!hasTried) {  // a homing that has been stopped isn't begun again
    hasTried = true;
    stage.home(-500, 100);  // steps/s, below 0: to the low switch; then slowly
  }
}
