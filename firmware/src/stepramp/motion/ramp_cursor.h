/* A place in a packed list of segments, which can be moved both ways: forward as a motor speeds up, back as it slows
 * down. Nothing is unpacked beforehand: a list lies in the ramp image, and a step from segment to segment reads one.
 *
 * A packed segment is three numbers of 7 bits a byte, low bits first, the top bit set on all bytes but the last: so a
 * number can be read from either end. See docs/serial_protocol.md. */
#ifndef STEPRAMP_RAMP_CURSOR_H
#define STEPRAMP_RAMP_CURSOR_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The bytes of a list. It begins at the slow end. */
struct packed_list {
    const uint8_t *begin;
    const uint8_t *end;
};

struct ramp_cursor {
    const uint8_t *next; /* the byte after the present segment */
    uint32_t first;      /* [ticks] first interval of the present segment */
    uint32_t before;     /* intervals of the list before the present segment */
    int16_t add;         /* [ticks] */
    uint16_t count;      /* intervals of the present segment; 0 when the list is empty */
    uint16_t taken;      /* of them, those before the cursor */
};

void cursor_begin(struct ramp_cursor *cursor, const struct packed_list *list);

/* Intervals of the list before the cursor. */
static inline uint32_t cursor_steps(const struct ramp_cursor *cursor)
{
    return cursor->before + cursor->taken;
}

/* No interval comes after the cursor. It is never at the end of a segment that isn't the last. */
static inline bool cursor_is_at_end(const struct ramp_cursor *cursor)
{
    return cursor->taken == cursor->count;
}

/* Interval number `index`, from 0, of the present segment [ticks]. */
static inline uint32_t cursor_interval(const struct ramp_cursor *cursor, uint16_t index)
{
    return cursor->first + (uint32_t)((int32_t)cursor->add * (int32_t)index);
}

/* Moves forward by `steps` intervals of the present segment. */
void cursor_forward(struct ramp_cursor *cursor, const struct packed_list *list, uint16_t steps);

/* Before the cursor is moved back: makes the segment of the interval before it the present one. */
void cursor_face_back(struct ramp_cursor *cursor);

/* After it has been moved back: makes the segment of the interval after it the present one. */
void cursor_face_forward(struct ramp_cursor *cursor, const struct packed_list *list);

/* Of `most` intervals of the present segment from number `index` on, those before the first that isn't longer than
 * `bound` ticks. */
uint16_t cursor_count_longer_from(const struct ramp_cursor *cursor, uint16_t index, uint32_t bound, uint16_t most);

/* The same, of the next intervals. */
static inline uint16_t cursor_count_longer(const struct ramp_cursor *cursor, uint32_t bound, uint16_t most)
{
    return cursor_count_longer_from(cursor, cursor->taken, bound, most);
}

/* Of the intervals before the cursor in the present segment, from the last one back: those before the first that is
 * longer than `bound` ticks. */
uint16_t cursor_count_not_longer_back(const struct ramp_cursor *cursor, uint32_t bound);

/* The seek below passes the rest of the present segment when its bound is less than this [ticks]. */
static inline uint32_t cursor_to_pass(const struct ramp_cursor *cursor)
{
    return cursor_interval(cursor, cursor->add < 0 ? (uint16_t)(cursor->count - 1) : cursor->taken);
}

/* Moves forward to the first interval that isn't longer than `bound`, at most over one segment. Returns true when it is
 * there. */
bool cursor_seek_forward(struct ramp_cursor *cursor, const struct packed_list *list, uint32_t bound);

/* Moves back to where the interval before the cursor is longer than `bound`, at most over one segment. Returns true
 * when it is there. */
bool cursor_seek_back(struct ramp_cursor *cursor, uint32_t bound);

/* Reads the number, less than 2^31, that ends before `*end`, and sets that to its beginning. */
uint32_t cursor_number_before(const uint8_t **end);

/* The same of a number that has a sign: 0, -1, 1, -2 … as 0, 1, 2, 3 … */
int32_t cursor_signed_before(const uint8_t **end);

#ifdef __cplusplus
}
#endif

#endif
