#ifdef STEPRAMP_IN_ASSEMBLY

#include "boards/avr/avr_limits.h"

#include "stepramp/edge/board_limits.h"
#include "stepramp/store/eeprom_slots.h"

const IN_FLASH uint8_t stepramp_board_limits[BOARD_LIMITS_BYTES] = BOARD_LIMITS;

struct slot_content stepramp_slot_content = {.image = {[LARGEST_IMAGE_BYTES - 1] = 0}};

#endif
