#include "stepramp/motion/ramp_cursor.h"

enum { MORE_FOLLOWS = 0x80, NUMBERS_OF_A_SEGMENT = 3 };

/* Shifts by 8 bits and one back: on a processor that moves bytes, much faster than by 7. */
uint32_t cursor_number_before(const uint8_t **end)
{
    const uint8_t *byte = *end - 1;
    uint32_t number = *byte;
    while ((byte[-1] & MORE_FOLLOWS) != 0) {
        byte--;
        number = (number << 8 | (uint8_t)(*byte << 1)) >> 1;
    }
    *end = byte;
    return number;
}

int32_t cursor_signed_before(const uint8_t **end)
{
    uint32_t number = cursor_number_before(end);
    return (number & 1) != 0 ? (int32_t)~(number >> 1) : (int32_t)(number >> 1);
}

/* The beginning of the last of so many numbers back from `byte`. */
static const uint8_t *before_numbers(const uint8_t *byte, uint8_t numbers)
{
    while (numbers != 0) {
        byte--;
        if ((byte[-1] & MORE_FOLLOWS) == 0) {
            numbers--;
        }
    }
    return byte;
}

/* The byte after the segment that begins at `byte`. */
static const uint8_t *end_of_segment(const uint8_t *byte)
{
    for (uint8_t numbers = NUMBERS_OF_A_SEGMENT; numbers != 0; byte++) {
        if ((*byte & MORE_FOLLOWS) == 0) {
            numbers--;
        }
    }
    return byte;
}

/* Makes the segment after the present one the present one. */
static void enter_next(struct ramp_cursor *cursor)
{
    uint32_t expected = cursor_interval(cursor, cursor->count);
    cursor->before += cursor->count;
    cursor->next = end_of_segment(cursor->next);
    const uint8_t *byte = cursor->next;
    cursor->add = (int16_t)(cursor->add + cursor_signed_before(&byte));
    cursor->first = expected + (uint32_t)cursor_signed_before(&byte);
    cursor->count = (uint16_t)cursor_number_before(&byte);
    cursor->taken = 0;
}

void cursor_begin(struct ramp_cursor *cursor, const struct packed_list *list)
{
    *cursor = (struct ramp_cursor){list->begin, 0, 0, 0, 0, 0};
    if (list->begin != list->end) {
        enter_next(cursor);
    }
}

void cursor_face_forward(struct ramp_cursor *cursor, const struct packed_list *list)
{
    if (cursor->taken == cursor->count && cursor->next != list->end) {
        enter_next(cursor);
    }
}

void cursor_forward(struct ramp_cursor *cursor, const struct packed_list *list, uint16_t steps)
{
    cursor->taken = (uint16_t)(cursor->taken + steps);
    cursor_face_forward(cursor, list);
}

void cursor_face_back(struct ramp_cursor *cursor)
{
    if (cursor->taken != 0 || cursor->before == 0) {
        return;
    }
    const uint8_t *byte = cursor->next;
    int16_t add = (int16_t)(cursor->add - cursor_signed_before(&byte));
    uint32_t expected = cursor->first - (uint32_t)cursor_signed_before(&byte);
    cursor->next = before_numbers(byte, 1);
    byte = before_numbers(cursor->next, 2);
    cursor->count = (uint16_t)cursor_number_before(&byte);
    cursor->taken = cursor->count;
    cursor->add = add;
    cursor->first = expected - (uint32_t)((int32_t)add * (int32_t)cursor->count);
    cursor->before -= cursor->count;
}

/* The division comes last: it takes as long as all the rest. */
uint16_t cursor_count_longer_from(const struct ramp_cursor *cursor, uint16_t index, uint32_t bound, uint16_t most)
{
    uint32_t first = cursor_interval(cursor, index);
    if (most == 0 || first <= bound) {
        return 0;
    }
    if (cursor->add >= 0 || cursor_interval(cursor, (uint16_t)(index + most - 1)) > bound) {
        return most;
    }
    uint16_t fall = (uint16_t)(0u - (uint16_t)cursor->add);
    uint32_t span = first - bound - 1;
    return (uint16_t)(span <= UINT16_MAX ? (uint16_t)span / fall + 1u : span / fall + 1u);
}

bool cursor_seek_forward(struct ramp_cursor *cursor, const struct packed_list *list, uint32_t bound)
{
    uint16_t left = (uint16_t)(cursor->count - cursor->taken);
    uint16_t longer = cursor_count_longer(cursor, bound, left);
    cursor_forward(cursor, list, longer);
    return longer != left || cursor_is_at_end(cursor);
}

/* Falling intervals are counted from the first one, as those that are longer come first. Of others the last one tells
 * of all. */
uint16_t cursor_count_not_longer_back(const struct ramp_cursor *cursor, uint32_t bound)
{
    uint16_t index = cursor->add < 0 ? 0 : (uint16_t)(cursor->taken - 1);
    return (uint16_t)(cursor->taken - cursor_count_longer_from(cursor, index, bound, cursor->taken));
}

bool cursor_seek_back(struct ramp_cursor *cursor, uint32_t bound)
{
    cursor_face_back(cursor);
    uint16_t not_longer = cursor_count_not_longer_back(cursor, bound);
    cursor->taken = (uint16_t)(cursor->taken - not_longer);
    return cursor->taken != 0 || cursor->before == 0;
}
