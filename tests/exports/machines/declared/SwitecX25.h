/* What the sketch uses of SwitecX25 1.2: calls, and members that are public. */
#ifndef SWITEC_X25_H
#define SWITEC_X25_H

#include <Arduino.h>

class SwitecX25 {
public:
  unsigned int currentStep;
  unsigned int targetStep;
  unsigned int steps;
  unsigned long time0;
  unsigned int microDelay;
  unsigned short (*accelTable)[2];
  unsigned int maxVel;
  unsigned int vel;
  signed char dir;
  boolean stopped;

  SwitecX25(unsigned int steps, unsigned char pin1, unsigned char pin2, unsigned char pin3, unsigned char pin4);
  void zero();
  void update();
  void setPosition(unsigned int pos);
};

#endif
