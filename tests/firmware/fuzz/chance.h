/* Numbers by chance; all of them follow from the seed. */
#ifndef STEPRAMP_CHANCE_H
#define STEPRAMP_CHANCE_H

#include <stdbool.h>
#include <stdint.h>

void chance_seed(uint64_t seed);

uint32_t chance(void);

/* A number less than the bound. */
uint32_t below(uint32_t bound);

bool one_in(uint32_t n);

/* Numbers that have a meaning more often than others. */
uint32_t some_number(void);

#endif
