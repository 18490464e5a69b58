/* Timer0, which the firmware keeps stopped and uses as three bytes of memory, and Timer2, which counts freely. simavr
 * loses what is written to a counter that stands still, and its own Timer2 would cost time for nothing. Where a program
 * lets Timer0 run, as Arduino's clock does, it is simavr's. */
#include <simavr/sim_io.h>

#include "host.h"

enum { TCCR0B = 0x45, TCNT0 = 0x46, OCR0A = 0x47, OCR0B = 0x48, TCCR2B = 0xB1, TCNT2 = 0xB2, CLOCK_SELECT = 7 };

static avr_t *avr;
static unsigned prescaler; /* cycles a tick; 0: stopped */
static avr_cycle_count_t counted_from;
static uint8_t count_then;

/* simavr's own handlers of Timer0, from TCNT0 on. */
static struct {
    avr_io_write_t on_write;
    void *write_parameter;
    avr_io_read_t on_read;
    void *read_parameter;
} own[OCR0B - TCNT0 + 1];

static void on_plain_write(avr_t *mcu, avr_io_addr_t address, uint8_t value, void *unused)
{
    (void)unused;
    mcu->data[address] = value;
}

static bool timer0_runs(const avr_t *mcu)
{
    return (mcu->data[TCCR0B] & CLOCK_SELECT) != 0;
}

static void on_timer0_write(avr_t *mcu, avr_io_addr_t address, uint8_t value, void *unused)
{
    if (timer0_runs(mcu) && own[address - TCNT0].on_write != NULL) {
        own[address - TCNT0].on_write(mcu, address, value, own[address - TCNT0].write_parameter);
    } else {
        on_plain_write(mcu, address, value, unused);
    }
}

static uint8_t on_timer0_read(avr_t *mcu, avr_io_addr_t address, void *unused)
{
    (void)unused;
    if (timer0_runs(mcu) && own[address - TCNT0].on_read != NULL) {
        return own[address - TCNT0].on_read(mcu, address, own[address - TCNT0].read_parameter);
    }
    return mcu->data[address];
}

static uint8_t count(void)
{
    return (uint8_t)(count_then + (prescaler ? avr->cycle / prescaler - counted_from / prescaler : 0));
}

static void on_clock_select(avr_t *mcu, avr_io_addr_t address, uint8_t value, void *unused)
{
    static const unsigned prescalers[8] = {0, 1, 8, 32, 64, 128, 256, 1024};
    (void)unused;
    mcu->data[address] = value;
    count_then = count();
    counted_from = mcu->cycle;
    prescaler = prescalers[value & 7];
}

static uint8_t on_count_read(avr_t *mcu, avr_io_addr_t address, void *unused)
{
    (void)unused;
    return mcu->data[address] = count();
}

static void replace(avr_io_addr_t address, avr_io_write_t on_write, avr_io_read_t on_read)
{
    avr_io_addr_t io = AVR_DATA_TO_IO(address);
    avr->io[io].w.c = on_write;
    avr->io[io].r.c = on_read;
}

void other_timers_attach(avr_t *mcu)
{
    avr = mcu;
    for (avr_io_addr_t address = TCNT0; address <= OCR0B; address++) {
        avr_io_addr_t io = AVR_DATA_TO_IO(address);
        own[address - TCNT0].on_write = avr->io[io].w.c;
        own[address - TCNT0].write_parameter = avr->io[io].w.param;
        own[address - TCNT0].on_read = avr->io[io].r.c;
        own[address - TCNT0].read_parameter = avr->io[io].r.param;
        replace(address, on_timer0_write, on_timer0_read);
    }
    if (chip->has_timer2) {
        replace(TCCR2B, on_clock_select, NULL);
        replace(TCNT2, on_plain_write, on_count_read);
    }
}

void other_timers_reset(void)
{
    prescaler = 0;
    count_then = 0;
}
