#include "stepramp/store/ramp_maker.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>

#include "stepramp/edge/board_limits.h"
#include "stepramp/edge/out_of_line.h"
#include "stepramp/protocol/message.h"
#include "stepramp/store/ramp_image.h"

/* Offsets of a ramp: see docs/serial_protocol.md. */
enum { KIND_AT = 0, LENGTH_AT = 1, FLAGS_AT = 3, UP_AT = 4, DOWN_AT = 5, SLEW_AT = 6, UP_BYTES_AT = 10, LISTS_AT = 12 };

enum { DOWN_IS_UP = 1, MOST_NUMBER_BYTES = 5, MOST_SEGMENT_BYTES = 3 * MOST_NUMBER_BYTES };

/* Of a segment. */
enum { MOST_INTERVALS = INT16_MAX };

/* An interval may be off by its 512th at first, by its 64th at last; by its 16th where the ramp has to keep pace, as less lets it. */
enum { FINEST = 512, COARSEST = 64, COARSEST_IN_PACE = 16 };

/* A segment is looked at in so many places at least. */
enum { PLACES = 8 };

/* So many segments are ready beforehand at least, with a round of loop() as late as it may be. */
enum { SEGMENTS_AHEAD = 3 };

/* One side of a ramp, from its slow end. */
struct side {
    float base_squared; /* [steps^2/s^2] of the base speed */
    float doubled;      /* [steps/s^2] twice the acceleration */
    float slew;         /* [ticks] */
    float doubled_clock_hz;
    float tolerance; /* so much of itself an interval may be off */
    uint16_t segment_ticks; /* preparing a segment takes */
    uint32_t steps, done;
    float exact; /* [ticks] the first interval after those that are done */
};

/* Whole numbers, as floats: they are computed with. */
struct segment {
    uint16_t count;   /* of intervals */
    float first, add; /* [ticks] */
};

/* A list that is being written. */
struct list {
    uint8_t *next, *end;
    uint8_t segments;
    uint32_t expected; /* [ticks] the interval that would continue the last segment */
    int16_t add;       /* [ticks] of the last segment */
};

OUT_OF_LINE int32_t ramp_maker_rounded(float number)
{
    return (int32_t)(number < 0 ? number - 0.5f : number + 0.5f);
}

uint32_t ramp_maker_interval(uint32_t clock_hz, float speed)
{
    return (uint32_t)((float)clock_hz / speed + 0.5f);
}

float ramp_maker_steps(const struct ramp_wish *wish, float acceleration)
{
    return (wish->speed * wish->speed - wish->base_speed * wish->base_speed) / (2 * acceleration);
}

/* The exact interval `i` steps on: the way of one step at the mean of the speeds at its ends. */
static float interval_of(const struct side *side, uint16_t i)
{
    float squared = side->base_squared + side->doubled * (float)(side->done + i);
    float interval = side->doubled_clock_hz / (sqrtf(squared) + sqrtf(squared + side->doubled));
    return interval > side->slew ? interval : side->slew;
}

static bool is_close(const struct side *side, const struct segment *segment, uint16_t i, float exact)
{
    float interval = segment->first + segment->add * i;
    return interval >= side->slew && fabsf(interval - exact) <= exact * side->tolerance + 1;
}

/* An interval, lowered by a share: as a ramp bends, what lies between two ends of a segment is too high. */
static OUT_OF_LINE float lowered(const struct side *side, float interval, float share)
{
    float low = interval - interval * share;
    return low > side->slew ? low : side->slew;
}

/* Makes a segment of `count` intervals. Returns false when they aren't close to the exact ones. */
static bool make_segment(const struct side *side, struct segment *segment, uint16_t count, float share)
{
    uint16_t last = (uint16_t)(count - 1);
    segment->count = count;
    segment->first = (float)ramp_maker_rounded(lowered(side, side->exact, share));
    segment->add = 0;
    if (last == 0) {
        return true;
    }
    float exact = interval_of(side, last);
    float rise = lowered(side, exact, share) - segment->first;
    segment->add = (float)ramp_maker_rounded(rise / last);
    if (segment->add < INT16_MIN) {
        return false;
    }
    /* As the slope is rounded, it would be off by more and more: by as much at either end, then. */
    segment->first += (float)ramp_maker_rounded((rise - segment->add * last) / 2);
    /* In the middle it is off most: what is too long is known soonest there. */
    if (!is_close(side, segment, last, exact) || (last > 2 && !is_close(side, segment, last / 2, interval_of(side, last / 2)))) {
        return false;
    }
    uint16_t stride = (uint16_t)(1 + last / PLACES);
    for (uint16_t i = 0; i < last; i = (uint16_t)(i + stride)) {
        if (!is_close(side, segment, i, interval_of(side, i))) {
            return false;
        }
    }
    return true;
}

/* Makes the longest segment that goes: more intervals are doubled as long as that goes, from as many as the last one has, then halved. */
static void make_longest(const struct side *side, struct segment *longest)
{
    uint32_t left = side->steps - side->done;
    uint16_t most = left < MOST_INTERVALS ? (uint16_t)left : MOST_INTERVALS;
    bool grows = true;
    uint16_t more = longest->count;
    make_segment(side, longest, 1, 0);
    for (; more != 0; more = grows ? (uint16_t)(more * 2) : more / 2) {
        struct segment segment;
        uint32_t count = (uint32_t)longest->count + more;
        if (count <= most && make_segment(side, &segment, (uint16_t)count, side->tolerance / 2)) {
            *longest = segment;
        } else {
            grows = false;
        }
    }
}

static OUT_OF_LINE void write_number(struct list *list, uint32_t number)
{
    for (; number > 0x7F; number >>= 7) {
        *list->next++ = (uint8_t)(number | 0x80);
    }
    *list->next++ = (uint8_t)number;
}

static OUT_OF_LINE void write_signed(struct list *list, int32_t number)
{
    write_number(list, number < 0 ? ~((uint32_t)number << 1) : (uint32_t)number << 1);
}

/* Returns false when there is no room, or when it doesn't keep pace. */
static bool write_side(struct side *side, struct list *list, uint8_t most_segments)
{
    uint32_t behind = 0; /* [ticks] preparing the segments is by then, at most */
    struct segment segment = {.count = 1};
    list->segments = 0;
    list->expected = 0;
    list->add = 0;
    for (; side->done < side->steps; list->segments++) {
        if (list->end - list->next < MOST_SEGMENT_BYTES || list->segments == most_segments) {
            return false;
        }
        side->exact = interval_of(side, 0);
        make_longest(side, &segment);
        uint32_t first = (uint32_t)segment.first;
        int16_t add = (int16_t)segment.add;
        write_number(list, segment.count);
        write_signed(list, (int32_t)(first - list->expected));
        write_signed(list, (int32_t)add - list->add);
        list->expected = first + (uint32_t)((int32_t)add * segment.count);
        list->add = add;
        side->done += segment.count;
        if (first >= side->segment_ticks) {
            behind = 0;
            continue;
        }
        uint32_t lasts = (first + list->expected) * segment.count / 2;
        behind += side->segment_ticks;
        behind = behind > lasts ? behind - lasts : 0;
        if (behind > (uint32_t)side->segment_ticks * SEGMENTS_AHEAD) {
            return false;
        }
    }
    return true;
}

static OUT_OF_LINE void begin_side(struct side *side, const struct ramp_wish *wish, float acceleration)
{
    side->doubled = 2 * acceleration;
    side->steps = (uint32_t)ramp_maker_steps(wish, acceleration);
    side->done = 0;
}

/* Both sides. Returns their end, or NULL: there is no room. */
static uint8_t *write_sides(struct side *side, const struct ramp_wish *wish, uint8_t *bytes, uint8_t *end)
{
    struct list list = {.next = bytes + LISTS_AT, .end = end};
    bool is_mirrored = wish->deceleration == wish->acceleration;
    begin_side(side, wish, wish->acceleration);
    if (!write_side(side, &list, is_mirrored ? MOST_SEGMENTS : MOST_SEGMENTS / 2)) {
        return NULL;
    }
    bytes[UP_AT] = list.segments;
    write_u16(bytes + UP_BYTES_AT, (uint16_t)(list.next - bytes - LISTS_AT));
    bytes[FLAGS_AT] = DOWN_IS_UP;
    bytes[DOWN_AT] = 0;
    if (is_mirrored) {
        return list.next;
    }
    bytes[FLAGS_AT] = 0;
    begin_side(side, wish, wish->deceleration);
    if (!write_side(side, &list, MOST_SEGMENTS / 2)) {
        return NULL;
    }
    bytes[DOWN_AT] = list.segments;
    return list.next;
}

uint16_t ramp_maker_write(const struct ramp_wish *wish, uint8_t *bytes, uint16_t room)
{
    uint32_t slew = ramp_maker_interval(wish->clock_hz, wish->speed);
    struct side side = {.base_squared = wish->base_speed * wish->base_speed,
                        .slew = (float)slew,
                        .doubled_clock_hz = 2 * (float)wish->clock_hz,
                        .segment_ticks = wish->segment_ticks};
    uint8_t *end = NULL;
    uint16_t coarsest = wish->segment_ticks != 0 ? COARSEST_IN_PACE : COARSEST;
    for (uint16_t fineness = FINEST; room >= LISTS_AT && end == NULL && fineness >= coarsest; fineness /= 2) {
        side.tolerance = 1.0f / fineness;
        end = write_sides(&side, wish, bytes, bytes + room);
    }
    if (end == NULL) {
        return 0;
    }
    uint16_t length = (uint16_t)(end - bytes);
    bytes[KIND_AT] = RAMP_OF_SEGMENTS;
    write_u16(bytes + LENGTH_AT, (uint16_t)(length - FLAGS_AT));
    write_u32(bytes + SLEW_AT, slew);
    return length;
}
