/* What a board that is polled can do. Without the Arduino API, as in tests: as much as an ATmega328P's controller. */
#ifndef STEPRAMP_IN_ASSEMBLY

#ifdef ARDUINO
#include "boards/polled/arduino_limits.h"
#else
#include "boards/avr/avr_limits.h"
#endif

#include "stepramp/edge/board_limits.h"
#include "stepramp/store/eeprom_slots.h"

const IN_FLASH uint8_t stepramp_board_limits[BOARD_LIMITS_BYTES] = BOARD_LIMITS;

struct slot_content stepramp_slot_content = {.image = {[LARGEST_IMAGE_BYTES - 1] = 0}};

#endif
