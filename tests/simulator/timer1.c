/* Timer1 as the firmware uses it, in the place of simavr's: it counts up freely, and both compare channels are exact to
 * the cycle. Channel A can move pin 9, OC1A. */
#include <string.h>

#include <simavr/avr_ioport.h>
#include <simavr/avr_timer.h>
#include <simavr/sim_cycle_timers.h>
#include <simavr/sim_interrupts.h>
#include <simavr/sim_io.h>

#include "host.h"

enum { TIFR1 = 0x36, TIMSK1 = 0x6F, TCCR1A = 0x80, TCCR1B = 0x81, TCCR1C = 0x82 };
enum { TCNT1L = 0x84, TCNT1H = 0x85, OCR1AL = 0x88, OCR1AH = 0x89, OCR1BL = 0x8A, OCR1BH = 0x8B };
enum { CHANNELS = 2, OC1A_BIT_OF_PORT_B = 1 };
enum { OUTPUT_A_SHIFT = 6, OUTPUT_CLEARS = 2, OUTPUT_SETS = 3, FORCE_A = 1 << 7 };

struct channel {
    avr_int_vector_t *vector;
    uint8_t flag; /* in TIMSK1 and TIFR1 */
    uint16_t compare;
};

static avr_t *avr;
static struct channel channels[CHANNELS] = {{.flag = 2}, {.flag = 4}};
static unsigned prescaler; /* cycles a tick; 0: stopped */
static avr_cycle_count_t counted_from;
static uint16_t count_then;

/* The prescaler runs freely: ticks begin at its multiples, whenever the timer was started. */
static uint64_t ticks_since(avr_cycle_count_t cycle)
{
    return prescaler ? avr->cycle / prescaler - cycle / prescaler : 0;
}

static uint16_t count(void)
{
    return (uint16_t)(count_then + ticks_since(counted_from));
}

static bool waits_in_queue(const avr_int_vector_t *vector)
{
    const avr_int_pending_t *queue = &avr->interrupts.pending;
    unsigned size = sizeof queue->buffer / sizeof queue->buffer[0];
    for (unsigned i = queue->read; i != queue->write; i = (i + 1) % size) {
        if (queue->buffer[i] == vector) {
            return true;
        }
    }
    return false;
}

/* An interrupt that is cleared stays in simavr's queue. Raised again, it must take that place instead of a further one,
 * or the queue overflows when an interrupt routine clears and serves one event after the other. */
static void raise_flag(struct channel *channel)
{
    if (!waits_in_queue(channel->vector)) {
        avr_raise_interrupt(avr, channel->vector);
        return;
    }
    avr->data[TIFR1] |= channel->flag;
    channel->vector->pending = (avr->data[TIMSK1] & channel->flag) != 0;
    if (channel->vector->pending && avr->sreg[S_I] && avr->interrupt_state == 0) {
        avr->interrupt_state = 1;
    }
}

/* What a match of channel A does to its pin; the programs here write to no other pin of port B meanwhile. */
static void move_output_a(void)
{
    unsigned mode = avr->data[TCCR1A] >> OUTPUT_A_SHIFT;
    if (mode == OUTPUT_CLEARS || mode == OUTPUT_SETS) {
        avr_raise_irq(avr_io_getirq(avr, AVR_IOCTL_IOPORT_GETIRQ('B'), OC1A_BIT_OF_PORT_B), mode == OUTPUT_SETS);
    }
}

/* The flag goes up at the end of the tick in which the counter has the compare value. */
static avr_cycle_count_t on_match(avr_t *mcu, avr_cycle_count_t when, void *channel)
{
    (void)mcu;
    raise_flag(channel);
    if (channel == &channels[0]) {
        /* simavr calls this at the end of an instruction; the pin has changed in the midst of it. */
        avr_cycle_count_t now = avr->cycle;
        avr->cycle = when;
        move_output_a();
        avr->cycle = now;
    }
    return when + 65536ULL * prescaler;
}

static void schedule_match(struct channel *channel)
{
    avr_cycle_timer_cancel(avr, on_match, channel);
    if (prescaler == 0) {
        return;
    }
    uint64_t ticks = (uint64_t)(uint16_t)(channel->compare - count()) + 1;
    avr_cycle_count_t match = (avr->cycle / prescaler + ticks) * prescaler;
    avr_cycle_timer_register(avr, match - avr->cycle, on_match, channel);
}

static void on_plain_write(avr_t *mcu, avr_io_addr_t address, uint8_t value, void *unused)
{
    (void)unused;
    mcu->data[address] = value;
}

static void on_force_write(avr_t *mcu, avr_io_addr_t address, uint8_t value, void *unused)
{
    (void)mcu, (void)address, (void)unused;
    if (value & FORCE_A) {
        move_output_a();
    }
}

static void on_compare_write(avr_t *mcu, avr_io_addr_t address, uint8_t value, void *unused)
{
    (void)unused;
    struct channel *channel = &channels[address == OCR1BL];
    mcu->data[address] = value;
    channel->compare = (uint16_t)(mcu->data[address + 1] << 8 | value);
    schedule_match(channel);
}

static void restart_count(uint16_t value)
{
    count_then = value;
    counted_from = avr->cycle;
}

static void schedule_matches(void)
{
    for (int i = 0; i < CHANNELS; i++) {
        schedule_match(&channels[i]);
    }
}

/* The counter keeps its value when its clock changes. */
static void on_clock_select(avr_t *mcu, avr_io_addr_t address, uint8_t value, void *unused)
{
    static const unsigned prescalers[8] = {0, 1, 8, 64, 256, 1024, 0, 0};
    (void)unused;
    mcu->data[address] = value;
    restart_count(count());
    prescaler = prescalers[value & 7];
    schedule_matches();
}

static void on_count_write(avr_t *mcu, avr_io_addr_t address, uint8_t value, void *unused)
{
    (void)address, (void)unused;
    restart_count((uint16_t)(mcu->data[TCNT1H] << 8 | value));
    schedule_matches();
}

static uint8_t on_count_read(avr_t *mcu, avr_io_addr_t address, void *unused)
{
    (void)address, (void)unused;
    uint16_t value = count();
    mcu->data[TCNT1H] = (uint8_t)(value >> 8);
    return mcu->data[TCNT1L] = (uint8_t)value;
}

/* A flag is cleared by writing 1 to it. */
static void on_flags_write(avr_t *mcu, avr_io_addr_t address, uint8_t value, void *unused)
{
    (void)unused;
    for (int i = 0; i < CHANNELS; i++) {
        if (value & channels[i].flag) {
            avr_clear_interrupt(mcu, channels[i].vector);
        }
    }
    mcu->data[address] &= (uint8_t)~value;
}

/* A flag that is up already interrupts as soon as it is enabled; one that is masked waits. */
static void on_mask_write(avr_t *mcu, avr_io_addr_t address, uint8_t value, void *unused)
{
    (void)unused;
    uint8_t before = mcu->data[address];
    mcu->data[address] = value;
    for (int i = 0; i < CHANNELS; i++) {
        bool is_up = mcu->data[TIFR1] & channels[i].flag;
        if ((value & ~before & channels[i].flag) && is_up) {
            raise_flag(&channels[i]);
        } else if ((before & ~value & channels[i].flag) && is_up) {
            avr_clear_interrupt(mcu, channels[i].vector);
            mcu->data[TIFR1] |= channels[i].flag;
        }
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
            channels[0].vector = &((avr_timer_t *)io)->comp[AVR_TIMER_COMPA].interrupt;
            channels[1].vector = &((avr_timer_t *)io)->comp[AVR_TIMER_COMPB].interrupt;
        }
    }
    replace(TCCR1A, on_plain_write, NULL);
    replace(TCCR1B, on_clock_select, NULL);
    replace(TCCR1C, on_force_write, NULL);
    replace(TCNT1L, on_count_write, on_count_read);
    replace(TCNT1H, on_plain_write, NULL);
    replace(OCR1AL, on_compare_write, NULL);
    replace(OCR1AH, on_plain_write, NULL);
    replace(OCR1BL, on_compare_write, NULL);
    replace(OCR1BH, on_plain_write, NULL);
    replace(TIFR1, on_flags_write, NULL);
    replace(TIMSK1, on_mask_write, NULL);
}

void timer1_reset(void)
{
    prescaler = 0;
    restart_count(0);
    for (int i = 0; i < CHANNELS; i++) {
        channels[i].compare = 0;
        avr_cycle_timer_cancel(avr, on_match, &channels[i]);
    }
}
