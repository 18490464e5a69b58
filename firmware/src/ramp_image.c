#include "ramp_image.h"

enum { FORMAT = 1, DOWN_IS_UP = 1, HEADER_BYTES = 8 };

static uint8_t segments_of(const uint8_t *image)
{
    return (uint8_t)(image[2] + image[3]);
}

static void begin_reading(struct image_reader *reader, const uint8_t *image, uint16_t length)
{
    reader->image = image;
    reader->next = image + HEADER_BYTES;
    reader->end = image + length;
    reader->read = 0;
}

/* A number of 7 bits a byte, low bits first. Returns false when it doesn't end, or doesn't fit 32 bits. */
static bool read_number(struct image_reader *reader, uint32_t *number)
{
    *number = 0;
    for (uint8_t shift = 0; shift < 32 && reader->next != reader->end; shift += 7) {
        uint8_t byte = *reader->next++;
        uint32_t bits = byte & 0x7Fu;
        if (shift == 28 && bits > 0x0F) {
            return false;
        }
        *number |= bits << shift;
        if (byte < 0x80) {
            return true;
        }
    }
    return false;
}

/* 0, 1, 2, 3 ... as 0, -1, 1, -2 ..., modulo 2^32. */
static uint32_t zigzag_decoded(uint32_t number)
{
    return (number >> 1) ^ (0u - (number & 1u));
}

static bool interval_is_allowed(uint32_t interval)
{
    return interval >= SHORTEST_INTERVAL_TICKS && interval <= LONGEST_INTERVAL_TICKS;
}

/* The last interval of the segment that was read last. */
static uint32_t last_interval(const struct image_reader *reader)
{
    return segment_interval(reader->first, &reader->segment, (uint16_t)(reader->segment.count - 1));
}

/* Reads the next segment, which is packed as the change from the one before it in its list, or from zeros. All sums are
 * modulo 2^32: none of them is further than 2^31 + 2^26 from 0, so that one that leaves the allowed range can't come
 * back into it. Returns false when the segment is bad. */
static bool read_segment(struct image_reader *reader)
{
    struct segment *segment = &reader->segment;
    bool list_begins = reader->read == 0 || reader->read == reader->image[2];
    if (list_begins) {
        *segment = (struct segment){0, 0, 0};
        reader->first = 0;
    }
    uint32_t count, interval_change, add_change;
    if (!read_number(reader, &count) || !read_number(reader, &interval_change) || !read_number(reader, &add_change)) {
        return false;
    }
    uint32_t change = zigzag_decoded(interval_change);
    uint32_t first = segment_interval(reader->first, segment, segment->count) + change;
    uint32_t add_above_lowest = (uint32_t)segment->add + zigzag_decoded(add_change) + 0x8000u;
    if (count < 1 || count > 0xFFFF || add_above_lowest > 0xFFFF || !interval_is_allowed(first)) {
        return false;
    }
    reader->first = first;
    segment->change = (interval_t)change;
    segment->add = (int16_t)((int32_t)add_above_lowest - 0x8000);
    segment->count = (uint16_t)count;
    reader->read++;
    return interval_is_allowed(last_interval(reader));
}

static uint32_t slew_interval_of(const uint8_t *image)
{
    return image[4] | (uint32_t)image[5] << 8 | (uint32_t)image[6] << 16 | (uint32_t)image[7] << 24;
}

static bool down_is_up(const uint8_t *image)
{
    return (image[1] & DOWN_IS_UP) != 0;
}

static bool header_is_good(const uint8_t *image, uint16_t length)
{
    if (length < HEADER_BYTES || image[0] != FORMAT || (image[1] & ~DOWN_IS_UP) != 0) {
        return false;
    }
    uint16_t segments = (uint16_t)(image[2] + image[3]);
    bool lists_agree = !down_is_up(image) || image[3] == 0;
    return segments <= MOST_SEGMENTS && lists_agree && interval_is_allowed(slew_interval_of(image));
}

struct image_check ramp_image_check(const uint8_t *image, uint16_t length)
{
    struct image_check check = {false, BAD_IMAGE_HEADER, 0, 0};
    if (!header_is_good(image, length)) {
        return check;
    }
    struct image_reader reader;
    begin_reading(&reader, image, length);
    uint8_t segments = segments_of(image);
    check.bad_segment = 0;
    while (check.bad_segment < segments && read_segment(&reader)) {
        check.bad_segment++;
    }
    check.good = check.bad_segment == segments && reader.next == reader.end;
    check.up_segments = image[2];
    check.down_segments = down_is_up(image) ? image[2] : image[3];
    return check;
}

void ramp_image_begin_unpacking(struct image_reader *reader, const uint8_t *image, uint16_t length, struct ramp *ramp)
{
    begin_reading(reader, image, length);
    ramp->slew_interval = (interval_t)slew_interval_of(image);
    ramp->up = (struct segment_list){ramp->segments, image[2], 0, 0};
    ramp->down = (struct segment_list){ramp->segments + image[2], image[3], 0, 0};
}

bool ramp_image_unpack_segment(struct image_reader *reader, struct ramp *ramp)
{
    uint8_t index = reader->read;
    if (index == segments_of(reader->image)) {
        if (down_is_up(reader->image)) {
            ramp->down = ramp->up;
        }
        return false;
    }
    read_segment(reader);
    ramp->segments[index] = reader->segment;
    struct segment_list *list = index < ramp->up.length ? &ramp->up : &ramp->down;
    list->steps += reader->segment.count; /* at most 120 * 65535 in all, far below 2^31 */
    list->last_interval = (interval_t)last_interval(reader);
    return true;
}
