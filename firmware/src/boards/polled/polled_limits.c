/* What a board that is polled can do. Without the Arduino API, as in tests: as much as an ATmega328P's controller. */
#ifndef STEPRAMP_IN_ASSEMBLY

#ifdef ARDUINO
#include "boards/polled/arduino_limits.h"
#else
#include "boards/avr/avr_limits.h"
#endif

#include "boards/polled/replaceable.h"
#include "stepramp/edge/board_limits.h"
#include "stepramp/store/eeprom_slots.h"

#ifdef stepramp_board_limits

static const IN_FLASH uint8_t limits[BOARD_LIMITS_BYTES] = BOARD_LIMITS;

REPLACEABLE const void *arduino_limits(void)
{
    return (const void *)limits;
}

#else

const IN_FLASH uint8_t stepramp_board_limits[BOARD_LIMITS_BYTES] = BOARD_LIMITS;

#endif

struct slot_content stepramp_slot_content = {.image = {[LARGEST_IMAGE_BYTES - 1] = 0}};

#endif
