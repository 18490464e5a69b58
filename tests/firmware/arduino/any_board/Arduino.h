/* What the library takes from the Arduino API, as boards declare it that are no AVR. */
#ifndef ARDUINO_H
#define ARDUINO_H

#include <limits.h>
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#ifndef INT_MAX
#error "The C library's limits.h is hidden by the library's."
#endif

enum { LOW = 0, HIGH = 1, INPUT = 0, OUTPUT = 1, INPUT_PULLUP = 2 };

extern "C" {
unsigned long micros(void);
unsigned long millis(void);
void delayMicroseconds(unsigned int microseconds);
void digitalWrite(uint8_t pin, uint8_t level);
int digitalRead(uint8_t pin);
void pinMode(uint8_t pin, uint8_t mode);
}

class __FlashStringHelper;
#define F(text) (reinterpret_cast<const __FlashStringHelper *>(text))

class Print {
public:
    virtual size_t write(uint8_t byte) = 0;
    virtual int availableForWrite();
};

class Stream : public Print {
public:
    virtual int available() = 0;
    virtual int read() = 0;
};

#endif
