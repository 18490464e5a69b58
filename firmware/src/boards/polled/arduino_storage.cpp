/* Where ramps and settings are kept: in an AVR's EEPROM when it has the kilobyte that two slots take, else in RAM, which
 * forgets them when the power goes. */
#include <Arduino.h>

#include "stepramp/edge/board.h"
#include "stepramp/store/eeprom_slots.h"

/* Newer AVRs say how much they have; on others the last address, which begins from 0, tells. */
#if defined(__AVR__) && defined(EEPROM_SIZE)
#define HAS_TWO_SLOTS (EEPROM_SIZE >= 1024)
#elif defined(__AVR__) && defined(E2END)
#define HAS_TWO_SLOTS (E2END >= 1023)
#else
#define HAS_TWO_SLOTS 0
#endif

#if HAS_TWO_SLOTS

#include <avr/eeprom.h>

uint8_t board_eeprom_read(uint16_t address)
{
    return eeprom_read_byte((const uint8_t *)address);
}

void board_eeprom_write(uint16_t address, uint8_t value)
{
    eeprom_write_byte((uint8_t *)address, value);
}

bool board_eeprom_is_busy(void)
{
    return !eeprom_is_ready();
}

#else

static uint8_t bytes[2 * SLOT_BYTES];

uint8_t board_eeprom_read(uint16_t address)
{
    return bytes[address];
}

void board_eeprom_write(uint16_t address, uint8_t value)
{
    bytes[address] = value;
}

bool board_eeprom_is_busy(void)
{
    return false;
}

#endif

/* A boot loader may have cleared it: then nothing is known. */
uint8_t board_reset_cause(void)
{
#ifdef MCUSR
    return MCUSR & (RESET_POWER_ON | RESET_EXTERNAL | RESET_BROWN_OUT | RESET_WATCHDOG);
#else
    return 0;
#endif
}
