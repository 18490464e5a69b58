#include "chance.h"

static uint64_t chance_state;

void chance_seed(uint64_t seed)
{
    chance_state = seed;
}

uint32_t chance(void)
{
    chance_state = chance_state * 6364136223846793005u + 1442695040888963407u;
    return (uint32_t)(chance_state >> 32);
}

uint32_t below(uint32_t bound)
{
    return chance() % bound;
}

bool one_in(uint32_t n)
{
    return below(n) == 0;
}

uint32_t some_number(void)
{
    static const uint32_t marked[] = {0, 1, 2, 0x7FFF, 0x8000, 0xFFFF, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF, 0x0FFFFFFF};
    switch (below(4)) {
    case 0:
        return marked[below(sizeof marked / sizeof marked[0])];
    case 1:
        return chance();
    case 2:
        return below(2000);
    default:
        return 0u - below(2000);
    }
}
