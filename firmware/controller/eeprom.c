#include <avr/io.h>
#include <util/atomic.h>

#include "stepramp/edge/board.h"

uint8_t board_eeprom_read(uint16_t address)
{
    while (board_eeprom_is_busy()) {
    }
    EEAR = address;
    EECR |= _BV(EERE);
    return EEDR;
}

/* The second bit must follow the first within four cycles. */
void board_eeprom_write(uint16_t address, uint8_t value)
{
    EEAR = address;
    EEDR = value;
    EECR = 0; /* erase and write */
    ATOMIC_BLOCK(ATOMIC_RESTORESTATE)
    {
        EECR |= _BV(EEMPE);
        EECR |= _BV(EEPE);
    }
}

bool board_eeprom_is_busy(void)
{
    return (EECR & _BV(EEPE)) != 0;
}
