#include "stepramp/store/ramp_maker.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>

#include "stepramp/edge/board_limits.h"
#include "stepramp/protocol/message.h"
#include "stepramp/store/ramp_image.h"

/* Offsets of a ramp: see docs/serial_protocol.md. */
enum { KIND_AT = 0, LENGTH_AT = 1, FLAGS_AT = 3, UP_AT = 4, DOWN_AT = 5, SLEW_AT = 6, UP_BYTES_AT = 10, LISTS_AT = 12 };

enum { DOWN_IS_UP = 1, MOST_NUMBER_BYTES = 5, MOST_SEGMENT_BYTES = 3 * MOST_NUMBER_BYTES };

/* An interval may be off by its 512th at first, by its 64th at last. */
enum { FINEST = 512, COARSEST = 64 };

/* A segment is looked at in so many places at least. */
enum { PLACES = 8 };

/* One side of a ramp, from its slow end. */
struct side {
    float base_squared; /* [steps^2/s^2] of the base speed */
    float doubled;      /* [steps/s^2] twice the acceleration */
    uint32_t steps;
    float slew; /* [ticks] */
    float doubled_clock_hz;
    uint16_t fineness;
};

/* A list that is being written. */
struct list {
    uint8_t *next, *end;
    uint8_t segments;
    uint32_t expected; /* [ticks] the interval that would continue the last segment */
    int16_t add;       /* [ticks] of the last segment */
};

uint32_t ramp_maker_interval(uint32_t clock_hz, float speed)
{
    return (uint32_t)((float)clock_hz / speed + 0.5f);
}

float ramp_maker_steps(const struct ramp_wish *wish, float acceleration)
{
    return (wish->speed * wish->speed - wish->base_speed * wish->base_speed) / (2 * acceleration);
}

/* The exact interval after step `i`, counted from 0: the way of one step at the mean of the speeds at its ends. */
static float interval_of(const struct side *side, uint32_t i)
{
    float begins = sqrtf(side->base_squared + side->doubled * (float)i);
    float ends = sqrtf(side->base_squared + side->doubled * (float)(i + 1));
    float interval = side->doubled_clock_hz / (begins + ends);
    return interval > side->slew ? interval : side->slew;
}

static bool is_close(const struct side *side, uint32_t i, float interval)
{
    float exact = interval_of(side, i);
    return interval >= side->slew && fabsf(interval - exact) <= exact / side->fineness + 1;
}

struct segment {
    uint32_t first; /* [ticks] */
    int16_t add;    /* [ticks] */
};

/* The exact interval, or one that is as low as allowed: as a ramp bends, what lies between two ends of a segment is too high. */
static float lowered(const struct side *side, uint32_t i, bool is_low)
{
    float exact = interval_of(side, i), low = is_low ? exact - exact / side->fineness : exact;
    return low > side->slew ? low : side->slew;
}

/* Makes a segment of `count` intervals from step `begin` on. Returns false when they aren't close to the exact ones. */
static bool segment_fits(const struct side *side, uint32_t begin, uint16_t count, bool is_low, struct segment *segment)
{
    segment->first = (uint32_t)ceilf(lowered(side, begin, is_low) - 0.5f);
    segment->add = 0;
    if (count == 1) {
        return true;
    }
    uint16_t last = (uint16_t)(count - 1);
    float slope = (lowered(side, begin + last, is_low) - (float)segment->first) / last;
    if (slope < INT16_MIN) {
        return false;
    }
    segment->add = (int16_t)lroundf(slope);
    uint16_t stride = (uint16_t)(1 + last / PLACES);
    for (uint16_t i = 0; i < last; i = (uint16_t)(i + stride)) {
        if (!is_close(side, begin + i, (float)segment->first + (float)segment->add * i)) {
            return false;
        }
    }
    return is_close(side, begin + last, (float)segment->first + (float)segment->add * last);
}

/* The most intervals that one segment can have from step `begin` on: doubled as long as that goes, then halved. */
static uint16_t longest_segment(const struct side *side, uint32_t begin)
{
    uint32_t left = side->steps - begin;
    uint16_t most = left < UINT16_MAX / 2 ? (uint16_t)left : UINT16_MAX / 2;
    uint16_t count = 1, more = 1;
    struct segment segment;
    while (count + more <= most && segment_fits(side, begin, (uint16_t)(count + more), true, &segment)) {
        count = (uint16_t)(count + more);
        more = (uint16_t)(more * 2);
    }
    for (; more != 0; more /= 2) {
        if (count + more <= most && segment_fits(side, begin, (uint16_t)(count + more), true, &segment)) {
            count = (uint16_t)(count + more);
        }
    }
    return count;
}

static void write_number(struct list *list, uint32_t number)
{
    for (; number > 0x7F; number >>= 7) {
        *list->next++ = (uint8_t)(number | 0x80);
    }
    *list->next++ = (uint8_t)number;
}

static void write_signed(struct list *list, int32_t number)
{
    write_number(list, number < 0 ? ~((uint32_t)number << 1) : (uint32_t)number << 1);
}

/* Returns false when there is no room. */
static bool write_side(const struct side *side, struct list *list, uint8_t most_segments)
{
    list->segments = 0;
    list->expected = 0;
    list->add = 0;
    for (uint32_t begin = 0; begin < side->steps; list->segments++) {
        if (list->end - list->next < MOST_SEGMENT_BYTES || list->segments == most_segments) {
            return false;
        }
        uint16_t count = longest_segment(side, begin);
        struct segment segment;
        if (!segment_fits(side, begin, count, false, &segment)) {
            segment_fits(side, begin, count, true, &segment);
        }
        write_number(list, count);
        write_signed(list, (int32_t)(segment.first - list->expected));
        write_signed(list, (int32_t)segment.add - list->add);
        list->expected = segment.first + (uint32_t)((int32_t)segment.add * count);
        list->add = segment.add;
        begin += count;
    }
    return true;
}

static struct side side_of(const struct ramp_wish *wish, float acceleration, uint16_t fineness)
{
    return (struct side){.base_squared = wish->base_speed * wish->base_speed,
                         .doubled = 2 * acceleration,
                         .steps = (uint32_t)ramp_maker_steps(wish, acceleration),
                         .slew = (float)ramp_maker_interval(wish->clock_hz, wish->speed),
                         .doubled_clock_hz = 2 * (float)wish->clock_hz,
                         .fineness = fineness};
}

/* Both sides, each interval off by its 1/`fineness` at most. Returns their end, or NULL: there is no room. */
static uint8_t *write_sides(const struct ramp_wish *wish, uint8_t *bytes, uint8_t *end, uint16_t fineness)
{
    struct list list = {.next = bytes + LISTS_AT, .end = end};
    struct side side = side_of(wish, wish->acceleration, fineness);
    bool is_mirrored = wish->deceleration == wish->acceleration;
    if (!write_side(&side, &list, is_mirrored ? MOST_SEGMENTS : MOST_SEGMENTS / 2)) {
        return NULL;
    }
    bytes[UP_AT] = list.segments;
    write_u16(bytes + UP_BYTES_AT, (uint16_t)(list.next - bytes - LISTS_AT));
    bytes[FLAGS_AT] = DOWN_IS_UP;
    bytes[DOWN_AT] = 0;
    if (is_mirrored) {
        return list.next;
    }
    side = side_of(wish, wish->deceleration, fineness);
    bytes[FLAGS_AT] = 0;
    if (!write_side(&side, &list, MOST_SEGMENTS / 2)) {
        return NULL;
    }
    bytes[DOWN_AT] = list.segments;
    return list.next;
}

uint16_t ramp_maker_write(const struct ramp_wish *wish, uint8_t *bytes, uint16_t room)
{
    uint8_t *end = NULL;
    for (uint16_t fineness = FINEST; room >= LISTS_AT && end == NULL && fineness >= COARSEST; fineness /= 2) {
        end = write_sides(wish, bytes, bytes + room, fineness);
    }
    if (end == NULL) {
        return 0;
    }
    uint16_t length = (uint16_t)(end - bytes);
    bytes[KIND_AT] = RAMP_OF_SEGMENTS;
    write_u16(bytes + LENGTH_AT, (uint16_t)(length - FLAGS_AT));
    write_u32(bytes + SLEW_AT, ramp_maker_interval(wish->clock_hz, wish->speed));
    return length;
}
