/* A StepRamp controller: the StepRamp program finds this board at its serial port, sends it ramps and settings, and
 * moves its motors. The pins are those of the common CNC shield, with a fourth axis on pins 12 and 13. */
#include <StepRamp.h>

void setup() {
  StepRamp.setStepper(0, 2, 5);    // axis, step pin, direction pin
  StepRamp.setStepper(1, 3, 6);
  StepRamp.setStepper(2, 4, 7);
  StepRamp.setStepper(3, 12, 13);
  StepRamp.setEnablePin(8);

  Serial.begin(115200);
  StepRampController.begin(Serial);
}

void loop() {
  StepRampController.poll();
}
