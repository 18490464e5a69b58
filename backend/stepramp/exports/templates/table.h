/* $title
 *
 * Lookup table: {last ramp index of the row, delay in $unit}. The delay at a ramp index is that of the first row whose
 * index is at least as large, beyond the last row that of the last one. An acceleration begins at ramp index 2, and a
 * deceleration ends at 0. */
#ifndef $guard
#define $guard

#include <stdint.h>
$include
#define ${prefix}_ROWS $rows

static const $type ${name}_table[${prefix}_ROWS][2]$place = {
$lines
};

/* The delay at a ramp index, in $unit. */
static inline $type ${name}_delay(uint32_t ramp_index)
{
    uint16_t row = 0;
    while (row + 1 < ${prefix}_ROWS && $index_of_row < ramp_index) row++;
    return $delay_of_row;
}

#endif
