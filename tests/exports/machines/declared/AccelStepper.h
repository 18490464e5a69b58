/* What the sketch calls of AccelStepper 1.64. */
#ifndef ACCEL_STEPPER_H
#define ACCEL_STEPPER_H

#include <Arduino.h>

class AccelStepper {
public:
  typedef enum { FUNCTION = 0, DRIVER = 1, FULL2WIRE = 2, FULL3WIRE = 3, FULL4WIRE = 4, HALF3WIRE = 6, HALF4WIRE = 8 } MotorInterfaceType;
  AccelStepper(uint8_t interface = AccelStepper::FULL4WIRE, uint8_t pin1 = 2, uint8_t pin2 = 3, uint8_t pin3 = 4, uint8_t pin4 = 5, bool enable = true);
  void move(long relative);
  bool run();
  void setMaxSpeed(float speed);
  void setAcceleration(float acceleration);
  virtual void disableOutputs();
  virtual void enableOutputs();
  void setMinPulseWidth(unsigned int minWidth);
  void setEnablePin(uint8_t enablePin = 0xff);
  void setPinsInverted(bool directionInvert = false, bool stepInvert = false, bool enableInvert = false);
  void stop();
  bool isRunning();
};

#endif
