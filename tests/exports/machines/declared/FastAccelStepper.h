/* What the sketch calls of FastAccelStepper 0.33. */
#ifndef FAST_ACCEL_STEPPER_H
#define FAST_ACCEL_STEPPER_H

#include <Arduino.h>

enum class MoveResultCode : int8_t { OK = 0 };

class FastAccelStepper {
public:
  void setDirectionPin(uint8_t dirPin, bool dirHighCountsUp = true, uint16_t dir_change_delay_us = 0);
  void setEnablePin(uint8_t enablePin, bool low_active_enables_stepper = true);
  bool enableOutputs();
  void setAutoEnable(bool auto_enable);
  int8_t setSpeedInMilliHz(uint32_t speed_mhz);
  int8_t setAcceleration(int32_t step_s_s);
  void setJumpStart(uint32_t jump_step);
  MoveResultCode move(int32_t move, bool blocking = false);
  void stopMove();
  bool isRunning() const;
};

class FastAccelStepperEngine {
public:
  void init();
  FastAccelStepper *stepperConnectToPin(uint8_t step_pin);
};

#endif
