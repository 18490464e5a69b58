#include "stepramp/edge/board_limits.h"

uint16_t board_limit(uint8_t at)
{
    const IN_FLASH uint8_t *limit = stepramp_board_limits + at;
    return (uint16_t)(limit[0] | limit[1] << 8);
}
