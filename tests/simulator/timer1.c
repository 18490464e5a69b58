/* Timer1 as the firmware uses it, in the place of simavr's: it counts up freely, exact to the cycle, and the four
 * cycles that the processor takes to accept an interrupt are charged, which simavr doesn't. */
#include <string.h>

#include <simavr/avr_timer.h>
#include <simavr/sim_cycle_timers.h>
#include <simavr/sim_interrupts.h>
#include <simavr/sim_io.h>

#include "host.h"

enum { TIFR1 = 0x36, TIMSK1 = 0x6F, TCCR1A = 0x80, TCCR1B = 0x81 };
enum { TCNT1L = 0x84, TCNT1H = 0x85, OCR1AL = 0x88, OCR1AH = 0x89 };
enum { COMPARE_A = 2 /* in TIMSK1 and TIFR1 */, RESPONSE_CYCLES = 4, RETI_CYCLES = 4 };

static avr_t *avr;
static avr_int_vector_t *compare_a;
static avr_cycle_count_t started_at;
static unsigned prescaler; /* cycles a tick; 0: stopped */
static uint16_t compare;
static avr_cycle_count_t interrupt_began;
static uint64_t longest_interrupt;

static uint64_t ticks_since_start(void)
{
    return prescaler ? (avr->cycle - started_at) / prescaler : 0;
}

/* The flag goes up at the end of the tick in which the counter has the compare value. */
static avr_cycle_count_t on_match(avr_t *mcu, avr_cycle_count_t when, void *unused)
{
    (void)unused;
    avr_raise_interrupt(mcu, compare_a);
    return when + 65536ULL * prescaler;
}

static void schedule_match(void)
{
    avr_cycle_timer_cancel(avr, on_match, NULL);
    if (prescaler == 0) {
        return;
    }
    uint64_t now = ticks_since_start();
    uint64_t match = now + (uint16_t)(compare - now) + 1;
    avr_cycle_timer_register(avr, started_at + match * prescaler - avr->cycle, on_match, NULL);
}

static void on_plain_write(avr_t *mcu, avr_io_addr_t address, uint8_t value, void *unused)
{
    (void)unused;
    mcu->data[address] = value;
}

static void on_compare_write(avr_t *mcu, avr_io_addr_t address, uint8_t value, void *unused)
{
    (void)unused;
    mcu->data[address] = value;
    compare = (uint16_t)(mcu->data[OCR1AH] << 8 | value);
    schedule_match();
}

static void on_clock_select(avr_t *mcu, avr_io_addr_t address, uint8_t value, void *unused)
{
    static const unsigned prescalers[8] = {0, 1, 8, 64, 256, 1024, 0, 0};
    (void)unused;
    mcu->data[address] = value;
    prescaler = prescalers[value & 7];
    started_at = mcu->cycle;
    schedule_match();
}

static uint8_t on_count_read(avr_t *mcu, avr_io_addr_t address, void *unused)
{
    (void)address, (void)unused;
    uint64_t ticks = ticks_since_start();
    mcu->data[TCNT1H] = (uint8_t)(ticks >> 8);
    return mcu->data[TCNT1L] = (uint8_t)ticks;
}

/* A flag is cleared by writing 1 to it. */
static void on_flags_write(avr_t *mcu, avr_io_addr_t address, uint8_t value, void *unused)
{
    (void)unused;
    if (value & COMPARE_A) {
        avr_clear_interrupt(mcu, compare_a);
    }
    mcu->data[address] &= (uint8_t)~value;
}

/* A flag that is up already interrupts as soon as it is enabled. */
static void on_mask_write(avr_t *mcu, avr_io_addr_t address, uint8_t value, void *unused)
{
    (void)unused;
    bool enabled = value & ~mcu->data[address] & COMPARE_A;
    mcu->data[address] = value;
    if (enabled && (mcu->data[TIFR1] & COMPARE_A)) {
        avr_raise_interrupt(mcu, compare_a);
    }
}

static void on_interrupt(avr_irq_t *irq, uint32_t is_running, void *unused)
{
    (void)irq, (void)unused;
    if (is_running) {
        interrupt_began = avr->cycle;
        avr->cycle += RESPONSE_CYCLES;
    } else if (interrupt_began) {
        uint64_t length = avr->cycle + RETI_CYCLES - interrupt_began;
        longest_interrupt = length > longest_interrupt ? length : longest_interrupt;
        interrupt_began = 0;
    }
}

/* Puts our functions in the place of simavr's. */
static void replace(avr_io_addr_t address, avr_io_write_t on_write, avr_io_read_t on_read)
{
    avr_io_addr_t io = AVR_DATA_TO_IO(address);
    avr->io[io].w.c = on_write;
    avr->io[io].r.c = on_read;
}

void timer1_attach(avr_t *mcu)
{
    avr = mcu;
    for (avr_io_t *io = avr->io_port; io; io = io->next) {
        if (strcmp(io->kind, "timer") == 0 && ((avr_timer_t *)io)->name == '1') {
            compare_a = &((avr_timer_t *)io)->comp[AVR_TIMER_COMPA].interrupt;
        }
    }
    replace(TCCR1A, on_plain_write, NULL);
    replace(TCCR1B, on_clock_select, NULL);
    replace(TCNT1L, on_plain_write, on_count_read);
    replace(TCNT1H, on_plain_write, NULL);
    replace(OCR1AL, on_compare_write, NULL);
    replace(OCR1AH, on_plain_write, NULL);
    replace(TIFR1, on_flags_write, NULL);
    replace(TIMSK1, on_mask_write, NULL);
    avr_irq_register_notify(compare_a->irq + AVR_INT_IRQ_RUNNING, on_interrupt, NULL);
}

void timer1_reset(void)
{
    prescaler = 0;
    compare = 0;
    interrupt_began = 0;
    avr_cycle_timer_cancel(avr, on_match, NULL);
}

uint64_t timer1_longest_interrupt(void)
{
    return longest_interrupt;
}
