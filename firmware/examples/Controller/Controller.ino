/* A StepRamp controller: the StepRamp program finds this board at its serial port, sends it ramps and settings, and
 * moves its motors. The pins are those of the common CNC shield, with a fourth axis on pins 12 and 13.
 *
 * A Mega has nine inputs besides, for what the program says: emergency stop, limit switches, drivers' faults. The first four pins
 * have an interrupt of their own, so that they are the ones for an emergency stop.
 *
 * It fits an Uno and a Mega, with a timer, too; no Leonardo. */
#include <StepRamp.h>

#ifdef ARDUINO_AVR_MEGA2560
const uint8_t INPUT_PINS[STEPRAMP_INPUTS] = {18, 19, 20, 21, A8, A9, A10, A11, A12};
#endif

void setup() {
  StepRamp.setStepper(0, 2, 5);    // axis, step pin, direction pin
  StepRamp.setStepper(1, 3, 6);
  StepRamp.setStepper(2, 4, 7);
  StepRamp.setStepper(3, 12, 13);
  StepRamp.setEnablePin(8);
#ifdef ARDUINO_AVR_MEGA2560
  for (uint8_t input = 0; input < STEPRAMP_INPUTS; input++) {
    StepRamp.setInputPin(input, INPUT_PINS[input]);
  }
#endif

  Serial.begin(115200);
  StepRampController.begin(Serial);
}

void loop() {
  StepRampController.poll();
}
