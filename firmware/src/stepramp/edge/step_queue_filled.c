/* Filling the queues, and the places of their segments. */
#include "stepramp/edge/engine.h"
#include "stepramp/edge/line_pieces.h"
#include "stepramp/edge/out_of_line.h"
#include "stepramp/edge/step_places.h"
#include "stepramp/edge/step_queue.h"

struct ring_ends *step_places_ends(uint8_t axis)
{
    return (struct ring_ends *)(line_is_on() ? &stepramp_line_player.tail : &stepramp_axis_players[axis].tail);
}

uint8_t step_places_after(uint8_t offset)
{
    if (line_is_on()) {
        return (uint8_t)(offset + LINE_SEGMENT_BYTES);
    }
    return (uint8_t)((offset & QUEUE_BYTES) | ((offset + QUEUED_SEGMENT_BYTES) & (QUEUE_BYTES - 1)));
}

/* What segments of both kinds begin with. */
struct segment_head {
    uint16_t interval;
    int16_t add;
    uint16_t count_less_1;
};

static OUT_OF_LINE volatile struct segment_head *head_of(uint8_t axis, uint8_t offset)
{
    uint8_t *segment = (uint8_t *)stepramp_queues[axis] + (offset & (QUEUE_BYTES - 1));
    return (volatile struct segment_head *)(line_is_on() ? (uint8_t *)step_places_line(offset) : segment);
}

uint16_t step_places_time(uint8_t axis, uint8_t offset)
{
    return head_of(axis, offset)->interval;
}

void step_places_read(uint8_t axis, uint8_t offset, struct step_played *segment)
{
    const volatile struct segment_head *head = head_of(axis, offset);
    uint8_t steps, turns;
    if (line_is_on()) {
        const volatile struct line_segment *place = (const volatile struct line_segment *)head;
        steps = place->axes;
        turns = (uint8_t)(place->turn_axes >> axis) & 1;
    } else {
        const volatile struct queued_segment *place = (const volatile struct queued_segment *)head;
        steps = place->step_mask;
        turns = place->turn_mask;
    }
    segment->time = head->interval;
    segment->steps = 0;
    if (steps != 0) {
        segment->steps = (uint16_t)(head->count_less_1 + 1u);
    }
    segment->turned = turns != 0;
}

/* One segment stays free, so that a full ring doesn't look like an empty one. */
bool step_queue_has_room(uint8_t axis)
{
    const struct ring_ends *ends = step_places_ends(axis);
    return step_places_after(ends->head) != ends->retired;
}

uint8_t step_queue_ahead(uint8_t axis)
{
    const struct ring_ends *ends = step_places_ends(axis);
    uint8_t bytes = (uint8_t)(ends->head - ends->tail);
    return line_is_on() ? bytes / LINE_SEGMENT_BYTES : (bytes & (QUEUE_BYTES - 1)) / QUEUED_SEGMENT_BYTES;
}

/* Places are written through volatile pointers: before the head is moved past them. */
void step_queue_push(uint8_t axis, uint16_t interval, int16_t add, uint16_t count_less_1, bool is_step, uint8_t turns)
{
    struct ring_ends *ends = step_places_ends(axis);
    uint8_t offset = ends->head;
    volatile struct segment_head *head = head_of(axis, offset);
    head->interval = interval;
    head->add = add;
    head->count_less_1 = count_less_1;
    if (line_is_on()) {
        volatile struct line_segment *segment = (volatile struct line_segment *)head;
        line_fill_in(segment, is_step);
        segment->turn_axes = turns;
    } else {
        volatile struct queued_segment *segment = (volatile struct queued_segment *)head;
        segment->step_mask = is_step ? engine_step_mask(axis) : 0;
        segment->turn_mask = turns != 0 ? engine_turn_mask(axis) : 0;
    }
    ends->head = step_places_after(offset);
}
