/* What the sketch calls of TeensyStep 2.3; a Teensy's digitalWrite is as any Arduino's. */
#ifndef TEENSY_STEP_H
#define TEENSY_STEP_H

#include <Arduino.h>

namespace TeensyStep {
class Stepper {
public:
  Stepper(const int StepPin, const int DirPin);
  Stepper &setMaxSpeed(int32_t speed);
  Stepper &setPullInSpeed(int32_t speed);
  Stepper &setAcceleration(uint32_t a);
  void setTargetRel(int32_t delta);
};

class StepControl {
public:
  StepControl(unsigned pulseWidth = 5, unsigned accUpdatePeriod = 5000);
  void moveAsync(Stepper &stepper);
  void stopAsync();
  bool isRunning();
};
}

using StepControl = TeensyStep::StepControl;
using Stepper = TeensyStep::Stepper;

#endif
