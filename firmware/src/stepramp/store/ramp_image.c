#include "stepramp/store/ramp_image.h"

#include "stepramp/edge/board_limits.h"
#include "stepramp/edge/build_options.h"
#include "stepramp/motion/formula.h"
#include "stepramp/protocol/message.h"

enum { FORMAT = 2, DOWN_IS_UP = 1 };

/* Offsets: of the image's header, of a ramp's, and of what a ramp of segments begins with. */
enum { AXES_AT = RAMP_IMAGE_AXES_AT, RAMPS_AT = RAMP_IMAGE_RAMPS_AT, HEADER_BYTES = 4 };
enum { RAMP_LENGTH_AT = 1, RAMP_HEADER_BYTES = 3 };
enum { FLAGS_AT = 0, UP_AT = 1, DOWN_AT = 2, SLEW_AT = 3, UP_BYTES_AT = 7, LISTS_AT = 9 };

enum { MORE_FOLLOWS = 0x80, MOST_NUMBER_BYTES = 5, MOST_LAST_BYTE = 0x07 /* of 5: 28 bits come before it */ };

/* Reads a list of segments of which nothing is known yet. */
struct list_reader {
    const uint8_t *next;
    const uint8_t *end;
    uint16_t shortest; /* [ticks] */
    uint32_t expected; /* [ticks] the interval that would continue the last segment */
    int16_t add;
};

/* The longest interval is a power of 2 less 1, so that its highest byte tells. */
static bool is_allowed(uint16_t shortest, uint32_t interval)
{
    return interval >= shortest && (uint8_t)(interval >> 24) <= LONGEST_INTERVAL_TICKS >> 24;
}

/* Goes to the end of a number. Returns false when it doesn't end in time, or isn't less than 2^31: no segment that has
 * such a number can be good. */
static bool number_ends(struct list_reader *reader)
{
    for (uint8_t bytes = 1; bytes <= MOST_NUMBER_BYTES && reader->next != reader->end; bytes++) {
        uint8_t byte = *reader->next++;
        if ((byte & MORE_FOLLOWS) == 0) {
            return bytes < MOST_NUMBER_BYTES || byte <= MOST_LAST_BYTE;
        }
    }
    return false;
}

/* Reads the next segment. The byte before it ends a number, or is the high byte of a length: either is less than 128.
 * All sums are modulo 2^32: an interval is at most 2^28 ticks, and a segment changes it by at most 2^31, so that what
 * has left the allowed range can't be back in it. */
static bool segment_is_good(struct list_reader *reader)
{
    if (!number_ends(reader) || !number_ends(reader) || !number_ends(reader)) {
        return false;
    }
    const uint8_t *at = reader->next;
    int32_t add = reader->add + cursor_signed_before(&at);
    uint32_t first = reader->expected + (uint32_t)cursor_signed_before(&at);
    uint32_t after_first = cursor_number_before(&at) - 1;
    reader->add = (int16_t)add;
    if (after_first >= UINT16_MAX || add != reader->add) {
        return false;
    }
    uint32_t last = first + (uint32_t)((int32_t)reader->add * (int32_t)(uint16_t)after_first);
    reader->expected = last + (uint32_t)add;
    return is_allowed(reader->shortest, first) && is_allowed(reader->shortest, last);
}

/* Checks a list of `segments` that must fill what the reader has up to `end`. Returns how many are good: all of them,
 * too, when more bytes follow. */
static uint8_t good_segments(struct list_reader *reader, const uint8_t *end, uint8_t segments)
{
    uint8_t good = 0;
    reader->end = end;
    reader->expected = 0;
    reader->add = 0;
    while (good < segments && segment_is_good(reader)) {
        good++;
    }
    return good;
}

/* What bad_segment and bad_part_of_ramp return of a good ramp: no ramp has so many segments. */
enum { NO_PART = 0xFE };

/* Checks a ramp of segments. Returns its first bad segment, those of down after those of up; or BAD_RAMP_HEADER. */
static uint8_t bad_segment(const uint8_t *ramp, uint16_t length, uint16_t shortest)
{
    if (length < LISTS_AT) {
        return BAD_RAMP_HEADER;
    }
    uint8_t up = ramp[UP_AT], down = ramp[DOWN_AT];
    uint16_t up_bytes = read_u16(ramp + UP_BYTES_AT);
    if (ramp[FLAGS_AT] > DOWN_IS_UP || (uint16_t)up + down > MOST_SEGMENTS ||
        (ramp[FLAGS_AT] == DOWN_IS_UP && down != 0) || !is_allowed(shortest, read_u32(ramp + SLEW_AT)) ||
        up_bytes > length - LISTS_AT) {
        return BAD_RAMP_HEADER;
    }
    struct list_reader reader = {.next = ramp + LISTS_AT, .shortest = shortest};
    uint8_t good = good_segments(&reader, reader.next + up_bytes, up);
    if (good == up && reader.next == reader.end) {
        good = (uint8_t)(good + good_segments(&reader, ramp + length, down));
        if (good == up + down && reader.next == reader.end) {
            return NO_PART;
        }
    }
    return good;
}

/* Rounded up, so that no interval is shorter than allowed. */
static uint16_t shortest_of(const uint8_t *image, uint8_t kind)
{
    enum { FAST_TICKS = FAST_CLOCK_HZ / SLOW_CLOCK_HZ }; /* in a slow tick */
    uint16_t shortest = board_limit(kind == RAMP_BY_FORMULA ? LIMIT_SHORTEST_FORMULA : LIMIT_SHORTEST_1_AXIS);
    return ramp_image_is_fast(image) ? shortest : (uint16_t)(shortest + FAST_TICKS - 1) / FAST_TICKS;
}

/* Checks the ramp that begins at `ramp`. Returns as bad_segment does. */
static uint8_t bad_part_of_ramp(const uint8_t *image, const uint8_t *ramp, uint16_t length)
{
    uint8_t kind = ramp[0];
    uint16_t shortest = shortest_of(image, kind);
    const uint8_t *body = ramp + RAMP_HEADER_BYTES;
    if (kind == RAMP_OF_SEGMENTS) {
        return bad_segment(body, length, shortest);
    }
    bool is_good = HAS_FORMULAS && kind == RAMP_BY_FORMULA && length <= UINT8_MAX &&
                   formula_check(body, (uint8_t)length, shortest, LONGEST_INTERVAL_TICKS);
    return is_good ? NO_PART : BAD_RAMP_HEADER;
}

/* The axes' ramps are there, and each ramp is some axis'. */
static bool assignment_is_good(const uint8_t *image)
{
    uint8_t used = 0, all = 0;
    for (uint8_t ramp = 0; ramp < image[RAMPS_AT]; ramp++) {
        all = (uint8_t)(all << 1 | 1);
    }
    for (uint8_t axis = 0; axis < image[AXES_AT]; axis++) {
        used |= (uint8_t)(1u << (image[HEADER_BYTES + axis] & 7));
        if (image[HEADER_BYTES + axis] >= image[RAMPS_AT]) {
            return false;
        }
    }
    return used == all;
}

static bool header_is_good(const uint8_t *image, uint16_t length)
{
    /* Less 1, none of a number is the largest of all. */
    uint8_t axes_less_1 = (uint8_t)(image[AXES_AT] - 1), ramps_less_1 = (uint8_t)(image[RAMPS_AT] - 1);
    return image[0] == FORMAT && image[RAMP_IMAGE_CLOCK_AT] <= RAMP_IMAGE_FAST_CLOCK && axes_less_1 < AXES && ramps_less_1 <= axes_less_1 &&
           length > (uint16_t)(HEADER_BYTES + axes_less_1) && assignment_is_good(image);
}

static struct image_check bad_at(uint8_t ramp, uint8_t part)
{
    struct image_check check = {false, (uint16_t)(ramp << 8 | part)};
    return check;
}

struct image_check ramp_image_check(const uint8_t *image, uint16_t length)
{
    struct image_check check = bad_at(BAD_IMAGE_HEADER, BAD_RAMP_HEADER);
    if (length < HEADER_BYTES || !header_is_good(image, length)) {
        return check;
    }
    const uint8_t *at = image + HEADER_BYTES + image[AXES_AT], *end = image + length;
    for (uint8_t ramp = 0; ramp < image[RAMPS_AT]; ramp++) {
        uint16_t left = (uint16_t)(end - at);
        if (left < RAMP_HEADER_BYTES) {
            return bad_at(ramp, BAD_RAMP_HEADER);
        }
        uint16_t ramp_bytes = read_u16(at + RAMP_LENGTH_AT);
        if (ramp_bytes > left - RAMP_HEADER_BYTES) {
            return bad_at(ramp, BAD_RAMP_HEADER);
        }
        uint8_t bad = bad_part_of_ramp(image, at, ramp_bytes);
        if (bad != NO_PART) {
            return bad_at(ramp, bad);
        }
        at += RAMP_HEADER_BYTES + ramp_bytes;
    }
    check.good = at == end;
    return check;
}

/* The lists of a ramp of segments, of `length` bytes. */
static void find_lists(struct image_ramp *ramp, const uint8_t *body, uint16_t length)
{
    const uint8_t *middle = body + LISTS_AT + read_u16(body + UP_BYTES_AT);
    ramp->slew_interval = read_u32(body + SLEW_AT);
    ramp->up = (struct packed_list){body + LISTS_AT, middle};
    ramp->down = (struct packed_list){middle, body + length};
    if (body[FLAGS_AT] == DOWN_IS_UP) {
        ramp->down = ramp->up;
    }
}

struct image_ramp ramp_image_ramp(const uint8_t *image, uint8_t axis)
{
    struct image_ramp ramp;
    const uint8_t *at = image + HEADER_BYTES + image[AXES_AT];
    for (uint8_t before = image[HEADER_BYTES + axis]; before != 0; before--) {
        at += RAMP_HEADER_BYTES + read_u16(at + RAMP_LENGTH_AT);
    }
    const uint8_t *body = at + RAMP_HEADER_BYTES;
    ramp.kind = at[0];
    ramp.formula = body;
    if (ramp.kind == RAMP_OF_SEGMENTS) {
        find_lists(&ramp, body, read_u16(at + RAMP_LENGTH_AT));
    } else if (HAS_FORMULAS) {
        ramp.slew_interval = formula_slew_interval(body);
    }
    return ramp;
}

uint32_t ramp_image_slew_interval(const uint8_t *image, uint8_t axis)
{
    return ramp_image_ramp(image, axis).slew_interval;
}
