#include "damage.h"

#include <string.h>

#include "chance.h"
#include "requests.h"

static size_t flip(uint8_t *bytes, size_t count)
{
    for (uint32_t flips = 1 + below(3); flips != 0; flips--) {
        bytes[below((uint32_t)count)] ^= (uint8_t)(1u << below(8));
    }
    return count;
}

static size_t insert(uint8_t *bytes, size_t count)
{
    size_t at = below((uint32_t)count + 1), length = 1 + below(one_in(10) ? 80 : 4);
    memmove(bytes + at + length, bytes + at, count - at);
    for (size_t i = 0; i < length; i++) {
        bytes[at + i] = (uint8_t)chance();
    }
    return count + length;
}

static size_t repeat_part(uint8_t *bytes, size_t count)
{
    size_t at = below((uint32_t)count), length = 1 + below((uint32_t)(count - at));
    memmove(bytes + at + length, bytes + at, count - at);
    return count + length;
}

/* The beginning of one frame and the end of another. */
static size_t splice(uint8_t *bytes, size_t count)
{
    uint8_t other[LONGEST_FRAME];
    size_t other_length = make_frame(other), keep = below((uint32_t)count), from = below((uint32_t)other_length);
    memcpy(bytes + keep, other + from, other_length - from);
    return keep + other_length - from;
}

size_t damage(uint8_t *bytes, size_t count)
{
    switch (below(6)) {
    case 0:
        return flip(bytes, count);
    case 1:
        return 1 + below((uint32_t)count);
    case 2:
        return insert(bytes, count);
    case 3:
        return repeat_part(bytes, count);
    case 4:
        return splice(bytes, count);
    default: /* the frame twice: a repeat */
        memcpy(bytes + count, bytes, count);
        return 2 * count;
    }
}
