/* What the sketches call of Arduino. */
#ifndef ARDUINO_H
#define ARDUINO_H

#include <stdint.h>

#define LOW 0x0
#define HIGH 0x1
#define OUTPUT 0x1
#define INPUT_PULLUP 0x2

typedef bool boolean;

static const uint8_t A2 = 16;
static const uint8_t LED_BUILTIN = 13;

void pinMode(uint8_t pin, uint8_t mode);
void digitalWrite(uint8_t pin, uint8_t value);
int digitalRead(uint8_t pin);
unsigned long millis();

#endif
