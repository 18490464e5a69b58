/* Damaging frames. */
#ifndef STEPRAMP_DAMAGE_H
#define STEPRAMP_DAMAGE_H

#include <stddef.h>
#include <stdint.h>

/* Damages bytes by chance; they may get longer by as many as there are, and a frame. Returns their number. */
size_t damage(uint8_t *bytes, size_t count);

#endif
