/* play_job.c on the chip. The job lies where the simulator puts it; the result is sent over the serial port. */
#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/pgmspace.h>
#include <avr/sleep.h>

#include "clock.h"
#include "play_job.h"
#include "serial.h"
#include "stepramp/edge/board.h"

enum { JOB_BEGINS = 0x4000 };

void job_begin(int count, char **words)
{
    (void)count, (void)words;
    clock_begin();
    serial_begin();
    sei();
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

/* A pulse after this mark came after the halt. */
void job_halted(void)
{
    DDRC |= _BV(0);
    PORTC |= _BV(0);
}

bool job_takes_byte(uint16_t *count)
{
    int16_t byte = serial_take();
    if (byte == NO_BYTE) {
        return false;
    }
    *count += byte == (uint8_t)*count;
    return true;
}

/* In a frame of two bytes. */
bool job_sends_byte(uint8_t byte)
{
    static uint8_t frame[2];
    if (board_is_sending()) {
        return false;
    }
    frame[0] = byte | 1;
    board_send(frame);
    return true;
}

static void send_at_once(uint8_t byte)
{
    while ((UCSR0A & _BV(UDRE0)) == 0) {
    }
    UDR0 = byte;
}

void job_end(const void *result, size_t size)
{
    while (board_is_sending()) {
    }
    for (size_t i = 0; i < size; i++) {
        send_at_once(((const uint8_t *)result)[i]);
    }
    UCSR0A |= _BV(TXC0);
    while ((UCSR0A & _BV(UDRE0)) == 0) {
    }
    for (volatile uint16_t i = 0; i < 1000; i++) { /* the last byte is still on its way */
    }
    cli();
    sleep_enable();
    for (;;) { /* a byte that comes may wake it once more */
        sleep_cpu();
    }
}
