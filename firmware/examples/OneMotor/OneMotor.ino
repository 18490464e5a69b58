/* One motor, without a host and without exported bytes: its ramp is computed on the board from a speed, an acceleration and
 * a deceleration.
 *
 * A driver's step is on pin 2, its direction on pin 5. The motor makes 800 steps forward and comes back. When a button
 * between pin A0 and ground is pressed, it slows down at once, and goes on from there when it is released.
 * What is wrong is told at the serial port at 115200 baud.
 *
 * It fits an Uno and a Mega, with a timer, too; a Leonardo without a timer. With an exported ramp, useRampInFlash(), that has room for one. */
#include <StepRampAxis.h>

const uint8_t BUTTON = A0;
const int32_t STEPS = 800;

StepRampAxis motor(2, 5);
int32_t goal = STEPS;

void setup() {
  Serial.begin(115200);
  pinMode(BUTTON, INPUT_PULLUP);
  StepRamp.setPulseWidth(5);      // microseconds: what the driver's data sheet asks for
  motor.setRamp(1000, 2000, 4000);  // steps/s, steps/s^2 up, steps/s^2 down
  if (motor.begin() != STEPRAMP_READY) {
    Serial.println(motor.problem());
  }
}

void loop() {
  motor.run();  // makes the steps that are due: nothing here may wait

  if (digitalRead(BUTTON) == LOW) {
    motor.stop();
  } else if (!motor.isMoving()) {
    if (motor.position() == goal) {
      goal = STEPS - goal;
    }
    motor.moveTo(goal);
  }
}
