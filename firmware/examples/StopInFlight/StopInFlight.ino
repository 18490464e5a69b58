/* A motor that runs at a speed, without a target, until a button is pressed: then it slows down with its ramp, from whatever speed it
 * has. When the button is released it runs the other way.
 *
 * A driver's step is on pin 2, its direction on pin 5, the button between pin A0 and ground.
 * Where it has come to rest is told at the serial port at 115200 baud.
 *
 * It fits an Uno and a Mega, with a timer, too; a Leonardo without a timer. With an exported ramp, useRampInFlash(), it fits that with one, too. */
#include <StepRampAxis.h>

const uint8_t BUTTON = A0;

StepRampAxis motor(2, 5);
float speed = 900;  // steps/s

void setup() {
  Serial.begin(115200);
  pinMode(BUTTON, INPUT_PULLUP);
  motor.setRamp(1000, 2000, 4000);  // steps/s, steps/s^2 up, steps/s^2 down
  if (motor.begin() != STEPRAMP_READY) {
    Serial.println(motor.problem());
  }
  motor.runAt(speed);
}

void loop() {
  bool moves = motor.run();  // nothing here may wait

  if (digitalRead(BUTTON) == LOW) {
    motor.stop();  // halt() in its place would make no further step, and a fast motor slip
  } else if (!moves) {
    Serial.println(motor.position());
    speed = -speed;
    motor.runAt(speed);
  }
}
