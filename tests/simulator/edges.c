#include <stdio.h>

#include <simavr/avr_ioport.h>

#include "host.h"

enum { TRANSMITTER_PIN = 1, CONTROL = 1 /* of the UART's registers */, TXEN = 1 << 3 };

static avr_t *avr;
static FILE *log_file;
static long count;
static long counts[MOST_PINS];
static avr_cycle_count_t last_step;
static uint8_t values[MOST_PINS];

static bool is_step_pin(int pin)
{
    return (pin >= 2 && pin <= 4) || pin == 12;
}

static void log_edge(int pin, uint8_t value)
{
    if (values[pin] == value) {
        return;
    }
    values[pin] = value;
    switch_note_edge(pin, value != 0);
    count++;
    counts[pin]++;
    if (is_step_pin(pin)) {
        last_step = avr->cycle;
    }
    if (log_file) {
        int64_t cycle = (int64_t)avr->cycle;
        int8_t pin_and_value[2] = {(int8_t)pin, (int8_t)value};
        fwrite(&cycle, sizeof cycle, 1, log_file);
        fwrite(pin_and_value, sizeof pin_and_value, 1, log_file);
    }
}

static void on_pin(avr_irq_t *irq, uint32_t value, void *its_value)
{
    (void)irq;
    int pin = (int)((uint8_t *)its_value - values);
    if (pin != TRANSMITTER_PIN || !(avr->data[chip->uart_registers + CONTROL] & TXEN)) {
        log_edge(pin, (uint8_t)value);
    }
}

static avr_irq_t *irq_of(int pin)
{
    struct port_bit place = chip_pin(pin);
    return avr_io_getirq(avr, AVR_IOCTL_IOPORT_GETIRQ(place.port), place.bit);
}

bool edges_attach(avr_t *mcu, const char *file)
{
    avr = mcu;
    if (file && !(log_file = fopen(file, "wb"))) {
        perror(file);
        return false;
    }
    for (int pin = 0; pin < chip_pins(); pin++) {
        avr_irq_register_notify(irq_of(pin), on_pin, values + pin);
    }
    return true;
}

/* simavr remembers a pin's level through a reset, and tells only of changes: so it is told too. */
void edges_reset(void)
{
    for (int pin = 0; pin < chip_pins(); pin++) {
        avr_raise_irq(irq_of(pin), 0);
        log_edge(pin, 0);
    }
}

void edges_flush(void)
{
    if (log_file) {
        fflush(log_file);
    }
}

long edges_count(void)
{
    return count;
}

long edges_of_pin(int pin)
{
    return counts[pin];
}

avr_cycle_count_t edges_last_step(void)
{
    return last_step;
}
