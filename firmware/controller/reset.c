/* What outlives a reset by the watchdog, and why the processor began. */
#include <avr/io.h>
#include <avr/wdt.h>

#include "boards/avr/enable_pin.h"
#include "boards/avr/pins.h"
#include "stepramp/edge/board.h"

static uint8_t kept_level __attribute__((section(".noinit")));
static uint8_t kept_complement __attribute__((section(".noinit")));
static uint8_t cause __attribute__((section(".noinit")));

static inline __attribute__((always_inline)) void drive(uint8_t level)
{
    if (level == ENABLE_HIGH) {
        PORTB |= _BV(ENABLE_BIT); /* before it is an output: it must not be low in between */
    } else {
        PORTB &= (uint8_t)~_BV(ENABLE_BIT);
    }
    if (level == ENABLE_NOT_DRIVEN) {
        DDRB &= (uint8_t)~_BV(ENABLE_BIT);
    } else {
        DDRB |= _BV(ENABLE_BIT);
    }
}

/* Runs a few cycles after the reset, before memory is cleared. After the watchdog its timeout is short until it is set
 * anew. A boot loader that has cleared MCUSR leaves its value in r2. */
void begin_after_reset(void) __attribute__((naked, used, section(".init3")));
void begin_after_reset(void)
{
    register uint8_t from_boot_loader __asm__("r2");
    __asm__ volatile("" : "=r"(from_boot_loader));
    uint8_t flags = MCUSR;
    cause = (flags != 0 ? flags : from_boot_loader) & 0x0F;
    MCUSR = 0;
    wdt_disable();
    bool is_kept = (kept_level ^ kept_complement) == 0xFF && kept_level <= ENABLE_HIGH;
    if ((cause & RESET_WATCHDOG) == 0 || !is_kept) {
        kept_level = ENABLE_NOT_DRIVEN;
        kept_complement = (uint8_t)~ENABLE_NOT_DRIVEN;
    }
    drive(kept_level);
}

void enable_pin_drive(uint8_t level)
{
    drive(level);
    kept_complement = (uint8_t)~level;
    kept_level = level;
}

uint8_t enable_pin_level(void)
{
    return kept_level;
}

uint8_t board_reset_cause(void)
{
    return cause;
}
