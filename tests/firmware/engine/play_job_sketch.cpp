/* play_job.c as a sketch: with the library's engine that has a timer, Arduino's core and its interrupts. TIMER_HEADER is the
 * header that chooses the timer. The job lies where the simulator puts it; the result is sent over the serial port. */
#include <Arduino.h>
#include TIMER_HEADER
#include <avr/sleep.h>

#include "boards/polled/arduino_board.h"

extern "C" {
#include "play_job.h"
}

#ifdef __AVR_ATmega32U4__
#define PORT Serial1
#else
#define PORT Serial
#endif

enum { JOB_BEGINS = 0x4000, HALT_MARK = 14 };

extern "C" {

void job_begin(int, char **)
{
    static const uint8_t steps[AXES] = {2, 3, 4, 12}, directions[AXES] = {5, 6, 7, 13};
    init();
    for (uint8_t axis = 0; axis < AXES; axis++) {
        stepramp_pins.step[axis] = steps[axis];
        stepramp_pins.direction[axis] = directions[axis];
    }
    for (uint8_t i = 0; i < GAUGES * COIL_PINS; i++) {
        stepramp_pins.coils[i / COIL_PINS][i % COIL_PINS] = (uint8_t)(2 + i);
    }
    arduino_use_gauges();
    arduino_begin();
    PORT.begin(115200);
}

void job_read_head(struct job_head *head)
{
    memcpy_P(head, (const void *)JOB_BEGINS, sizeof *head);
}

void job_read_segment(uint16_t index, void *segment, uint8_t size)
{
    memcpy_P(segment, (const uint8_t *)(JOB_BEGINS + sizeof(struct job_head)) + index * size, size);
}

void job_time_passes(void)
{
}

void job_halted(void)
{
    pinMode(HALT_MARK, OUTPUT);
    digitalWrite(HALT_MARK, HIGH);
}

bool job_takes_byte(uint16_t *count)
{
    int byte = PORT.read();
    if (byte < 0) {
        return false;
    }
    *count = (uint16_t)(*count + (byte == (uint8_t)*count));
    return true;
}

bool job_sends_byte(uint8_t byte)
{
    if (PORT.availableForWrite() == 0) {
        return false;
    }
    PORT.write(byte);
    return true;
}

void job_end(const void *result, size_t size)
{
    PORT.write((const uint8_t *)result, size);
    PORT.flush();
    cli();
    sleep_enable();
    for (;;) {
        sleep_cpu();
    }
}
}
