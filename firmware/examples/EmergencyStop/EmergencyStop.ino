/* An emergency stop: no step comes after it is pressed, and none before it is released and somebody has acknowledged it.
 *
 * A driver's step is on pin 4, its direction on pin 7. The emergency stop lies between pin 2 and ground and opens when it is
 * pressed, so that a wire that breaks stops the motor, too. A button between pin A0 and ground acknowledges.
 * With the line below that is commented out, steps are made by a timer, and pin 2's interrupt stops them. Whoever can be hurt needs a switch in the motors' supply besides: this is a program.
 *
 * It fits an Uno and a Mega, with a timer, too; no Leonardo. With an exported ramp, useRampInFlash(), it fits that without a timer. */
#include <StepRampAxis.h>
// #include <StepRampTimer1.h>

const uint8_t STOP = 2;
const uint8_t ACKNOWLEDGE = A0;
const int32_t STEPS = 800;

StepRampAxis motor(4, 7);
int32_t goal = STEPS;

void setup() {
  Serial.begin(115200);
  pinMode(ACKNOWLEDGE, INPUT_PULLUP);
  StepRamp.setEmergencyStop(STOP, STEPRAMP_OPENS);
  motor.setRamp(1000, 8000);  // steps/s, steps/s^2
  StepRampProblem problem = motor.begin();
  if (problem != STEPRAMP_READY) {
    Serial.println(problem);  // StepRampAxis.h has its name; in words, motor.problem(), it takes 500 bytes more than an Uno has
  }
}

void loop() {
  motor.run();  // nothing here may wait

  if (StepRamp.stoppedBy() != STEPRAMP_BY_NOTHING) {
    if (digitalRead(ACKNOWLEDGE) == LOW) {
      StepRamp.acknowledge();  // does nothing as long as the emergency stop is pressed
    }
  } else if (!motor.isMoving()) {
    if (motor.position() == goal) {
      goal = STEPS - goal;
    }
    motor.moveTo(goal);
  }
}
