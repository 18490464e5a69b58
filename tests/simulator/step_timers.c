/* The 16-bit timers as the firmware uses one, in the place of simavr's: they count up freely, and their compare channels are
 * exact to the cycle. Channel A of an ATmega328P's Timer1 can move pin 9, OC1A. */
#include <string.h>

#include <simavr/avr_ioport.h>
#include <simavr/avr_timer.h>
#include <simavr/sim_cycle_timers.h>
#include <simavr/sim_interrupts.h>
#include <simavr/sim_io.h>

#include "host.h"

/* Of TIFR0 and TIMSK0; and of a timer's other registers. */
enum { FLAGS_0 = 0x35, MASK_0 = 0x6E };
enum { CONTROL_A = 0, CONTROL_B = 1, CONTROL_C = 2, COUNT_LOW = 4, COUNT_HIGH = 5, COMPARE_LOW = 8 };
enum { OC1A_BIT_OF_PORT_B = 1 };
enum { OUTPUT_A_SHIFT = 6, OUTPUT_CLEARS = 2, OUTPUT_SETS = 3, FORCE_A = 1 << 7 };

struct timer;

struct channel {
    struct timer *timer;
    avr_int_vector_t *vector;
    uint8_t flag; /* in TIMSKn and TIFRn */
    uint16_t compare;
};

struct timer {
    char name;
    avr_io_addr_t registers, flags, mask;
    unsigned prescaler; /* cycles a tick; 0: stopped */
    avr_cycle_count_t counted_from;
    uint16_t count_then;
    struct channel channels[MOST_CHANNELS];
};

static avr_t *avr;
static struct timer timers[MOST_STEP_TIMERS];

/* The prescaler runs freely: ticks begin at its multiples, whenever the timer was started. */
static uint64_t ticks_since(const struct timer *timer, avr_cycle_count_t cycle)
{
    return timer->prescaler ? avr->cycle / timer->prescaler - cycle / timer->prescaler : 0;
}

static uint16_t count(const struct timer *timer)
{
    return (uint16_t)(timer->count_then + ticks_since(timer, timer->counted_from));
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
    avr->data[channel->timer->flags] |= channel->flag;
    channel->vector->pending = (avr->data[channel->timer->mask] & channel->flag) != 0;
    if (channel->vector->pending && avr->sreg[S_I] && avr->interrupt_state == 0) {
        avr->interrupt_state = 1;
    }
}

/* What a match of channel A does to its pin; the programs here write to no other pin of port B meanwhile. */
static void move_output_a(const struct timer *timer)
{
    unsigned mode = avr->data[timer->registers + CONTROL_A] >> OUTPUT_A_SHIFT;
    if (mode == OUTPUT_CLEARS || mode == OUTPUT_SETS) {
        avr_raise_irq(avr_io_getirq(avr, AVR_IOCTL_IOPORT_GETIRQ('B'), OC1A_BIT_OF_PORT_B), mode == OUTPUT_SETS);
    }
}

/* The flag goes up at the end of the tick in which the counter has the compare value. */
static avr_cycle_count_t on_match(avr_t *mcu, avr_cycle_count_t when, void *its_channel)
{
    (void)mcu;
    struct channel *channel = its_channel;
    raise_flag(channel);
    if (channel == &timers[0].channels[0] && chip->timer_channels == 2) {
        /* simavr calls this at the end of an instruction; the pin has changed in the midst of it. */
        avr_cycle_count_t now = avr->cycle;
        avr->cycle = when;
        move_output_a(channel->timer);
        avr->cycle = now;
    }
    return when + 65536ULL * channel->timer->prescaler;
}

static void schedule_match(struct channel *channel)
{
    unsigned prescaler = channel->timer->prescaler;
    avr_cycle_timer_cancel(avr, on_match, channel);
    if (prescaler == 0) {
        return;
    }
    uint64_t ticks = (uint64_t)(uint16_t)(channel->compare - count(channel->timer)) + 1;
    avr_cycle_count_t match = (avr->cycle / prescaler + ticks) * prescaler;
    avr_cycle_timer_register(avr, match - avr->cycle, on_match, channel);
}

static void on_plain_write(avr_t *mcu, avr_io_addr_t address, uint8_t value, void *unused)
{
    (void)unused;
    mcu->data[address] = value;
}

static void on_force_write(avr_t *mcu, avr_io_addr_t address, uint8_t value, void *timer)
{
    (void)mcu, (void)address;
    if (value & FORCE_A) {
        move_output_a(timer);
    }
}

static void on_compare_write(avr_t *mcu, avr_io_addr_t address, uint8_t value, void *its_channel)
{
    struct channel *channel = its_channel;
    mcu->data[address] = value;
    channel->compare = (uint16_t)(mcu->data[address + 1] << 8 | value);
    schedule_match(channel);
}

static void restart_count(struct timer *timer, uint16_t value)
{
    timer->count_then = value;
    timer->counted_from = avr->cycle;
}

static void schedule_matches(struct timer *timer)
{
    for (unsigned i = 0; i < chip->timer_channels; i++) {
        schedule_match(&timer->channels[i]);
    }
}

/* The counter keeps its value when its clock changes. */
static void on_clock_select(avr_t *mcu, avr_io_addr_t address, uint8_t value, void *its_timer)
{
    static const unsigned prescalers[8] = {0, 1, 8, 64, 256, 1024, 0, 0};
    struct timer *timer = its_timer;
    mcu->data[address] = value;
    restart_count(timer, count(timer));
    timer->prescaler = prescalers[value & 7];
    schedule_matches(timer);
}

static void on_count_write(avr_t *mcu, avr_io_addr_t address, uint8_t value, void *timer)
{
    restart_count(timer, (uint16_t)(mcu->data[address + 1] << 8 | value));
    schedule_matches(timer);
}

static uint8_t on_count_read(avr_t *mcu, avr_io_addr_t address, void *timer)
{
    uint16_t value = count(timer);
    mcu->data[address + 1] = (uint8_t)(value >> 8);
    return mcu->data[address] = (uint8_t)value;
}

/* A flag is cleared by writing 1 to it. */
static void on_flags_write(avr_t *mcu, avr_io_addr_t address, uint8_t value, void *its_timer)
{
    struct timer *timer = its_timer;
    for (unsigned i = 0; i < chip->timer_channels; i++) {
        if (value & timer->channels[i].flag) {
            avr_clear_interrupt(mcu, timer->channels[i].vector);
        }
    }
    mcu->data[address] &= (uint8_t)~value;
}

/* A flag that is up already interrupts as soon as it is enabled; one that is masked waits. */
static void on_mask_write(avr_t *mcu, avr_io_addr_t address, uint8_t value, void *its_timer)
{
    struct timer *timer = its_timer;
    uint8_t before = mcu->data[address];
    mcu->data[address] = value;
    for (unsigned i = 0; i < chip->timer_channels; i++) {
        struct channel *channel = &timer->channels[i];
        bool is_up = mcu->data[timer->flags] & channel->flag;
        if ((value & ~before & channel->flag) && is_up) {
            raise_flag(channel);
        } else if ((before & ~value & channel->flag) && is_up) {
            avr_clear_interrupt(mcu, channel->vector);
            mcu->data[timer->flags] |= channel->flag;
        }
    }
}

/* Puts our functions in the place of simavr's. */
static void replace(avr_io_addr_t address, avr_io_write_t on_write, avr_io_read_t on_read, void *parameter)
{
    avr_io_addr_t io = AVR_DATA_TO_IO(address);
    avr->io[io].w.c = on_write;
    avr->io[io].w.param = parameter;
    avr->io[io].r.c = on_read;
    avr->io[io].r.param = parameter;
}

/* simavr's ATmega32U4 has no channel C. Its vector comes behind B's. */
static void add_vector(struct timer *timer, struct channel *channel, uint8_t number, uint8_t bit)
{
    channel->vector->vector = number;
    channel->vector->enable = (avr_regbit_t)AVR_IO_REGBIT(timer->mask, bit);
    channel->vector->raised = (avr_regbit_t)AVR_IO_REGBIT(timer->flags, bit);
    avr_register_vector(avr, channel->vector);
}

static void find_vectors(struct timer *timer)
{
    for (avr_io_t *io = avr->io_port; io; io = io->next) {
        if (strcmp(io->kind, "timer") == 0 && ((avr_timer_t *)io)->name == timer->name) {
            for (unsigned i = 0; i < chip->timer_channels; i++) {
                struct channel *channel = &timer->channels[i];
                channel->vector = &((avr_timer_t *)io)->comp[AVR_TIMER_COMPA + i].interrupt;
                if (channel->vector->vector == 0) {
                    add_vector(timer, channel, (uint8_t)(timer->channels[0].vector->vector + i), (uint8_t)(i + 1));
                }
            }
        }
    }
}

static void attach(struct timer *timer, char name)
{
    timer->name = name;
    avr_io_addr_t number = (avr_io_addr_t)(name - '0');
    timer->registers = number == 5 ? 0x120 : (avr_io_addr_t)(0x80 + (number == 1 ? 0 : 0x10 * (number - 2)));
    timer->flags = FLAGS_0 + number;
    timer->mask = MASK_0 + number;
    find_vectors(timer);
    replace(timer->registers + CONTROL_A, on_plain_write, NULL, timer);
    replace(timer->registers + CONTROL_B, on_clock_select, NULL, timer);
    replace(timer->registers + CONTROL_C, on_force_write, NULL, timer);
    replace(timer->registers + COUNT_LOW, on_count_write, on_count_read, timer);
    replace(timer->registers + COUNT_HIGH, on_plain_write, NULL, timer);
    for (unsigned i = 0; i < chip->timer_channels; i++) {
        timer->channels[i].timer = timer;
        timer->channels[i].flag = (uint8_t)(2u << i);
        avr_io_addr_t compare = (avr_io_addr_t)(timer->registers + COMPARE_LOW + 2 * i);
        replace(compare, on_compare_write, NULL, &timer->channels[i]);
        replace(compare + 1, on_plain_write, NULL, timer);
    }
    replace(timer->flags, on_flags_write, NULL, timer);
    replace(timer->mask, on_mask_write, NULL, timer);
}

void step_timers_attach(avr_t *mcu)
{
    avr = mcu;
    for (unsigned i = 0; chip->timers[i] != '\0'; i++) {
        attach(&timers[i], chip->timers[i]);
    }
}

void step_timers_reset(void)
{
    for (unsigned i = 0; chip->timers[i] != '\0'; i++) {
        timers[i].prescaler = 0;
        restart_count(&timers[i], 0);
        for (unsigned k = 0; k < chip->timer_channels; k++) {
            timers[i].channels[k].compare = 0;
            avr_cycle_timer_cancel(avr, on_match, &timers[i].channels[k]);
        }
    }
}
