/* What outlives a reset by the watchdog, and why the processor began. */
#include "reset.h"

#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/pgmspace.h>
#include <avr/wdt.h>

#include "boards/avr/enable_pin.h"
#include "boards/avr/pins.h"
#include "stepramp/edge/board.h"

static uint8_t kept_level __attribute__((section(".noinit")));
static uint8_t kept_complement __attribute__((section(".noinit")));
static uint8_t cause __attribute__((section(".noinit")));
static uint16_t mark __attribute__((section(".noinit"))); /* NOTED: the watchdog's reset was to come */
enum { NOTED = 0xC35A };
/* At the end of the program memory, where optiboot has its version. From 5 on it hands the cause over in r2; before, as
 * Arduino's Uno comes, it keeps it to itself, and r2 is whatever it was. 0xFF: there is no boot loader. */
enum { LOADER_VERSION = 0x7FFF, FIRST_THAT_TELLS = 5, NO_LOADER = 0xFF };

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

void note_watchdog_reset(void)
{
    mark = NOTED;
    WDTCSR &= (uint8_t)~_BV(WDIE); /* the reset comes next, and no interrupt before it */
}

#ifdef STEPRAMP_WITHOUT_WATCHDOG
void watchdog_begin(void)
{
}
#else
ISR(WDT_vect)
{
    mark = NOTED;
}

void watchdog_begin(void)
{
    wdt_enable(WDTO_120MS);
    WDTCSR |= _BV(WDIE);
}
#endif

/* Runs a few cycles after the reset, before memory is cleared. After the watchdog its timeout is short until it is set
 * anew. A boot loader that has cleared MCUSR leaves its value in r2, or nowhere: then what was noted tells. */
void begin_after_reset(void) __attribute__((naked, used, section(".init3")));
void begin_after_reset(void)
{
    register uint8_t from_boot_loader __asm__("r2");
    __asm__ volatile("" : "=r"(from_boot_loader));
    uint8_t flags = MCUSR, version = pgm_read_byte(LOADER_VERSION);
    if (flags == 0 && version >= FIRST_THAT_TELLS && version != NO_LOADER) {
        flags = from_boot_loader;
    }
    cause = flags & 0x0F;
    if (mark == NOTED) {
        cause |= RESET_WATCHDOG;
    }
    mark = 0;
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
