#include "stepramp/edge/step_queue.h"

#include "stepramp/edge/board.h"

uint8_t step_queue_ahead(const struct step_queue *lane)
{
    uint8_t bytes = (uint8_t)(lane->head - lane->tail);
    return line_is_on() ? bytes / LINE_SEGMENT_BYTES : (bytes & (QUEUE_BYTES - 1)) / QUEUED_SEGMENT_BYTES;
}

/* What segments of both kinds begin with. */
struct segment_head {
    uint16_t interval;
    int16_t add;
    uint16_t count_less_1;
};

static volatile struct segment_head *head_of(uint8_t axis, uint8_t offset)
{
    uint8_t *segment = (uint8_t *)stepramp_queues[axis] + (offset & (QUEUE_BYTES - 1));
    return (volatile struct segment_head *)(line_is_on() ? (uint8_t *)line_segment(offset) : segment);
}

/* Places are written through volatile pointers: before the head is moved past them. */
void step_queue_push(uint8_t axis, uint16_t interval, int16_t add, uint16_t count_less_1, bool is_step, uint8_t turns)
{
    struct step_queue *lane = step_queue_of(axis);
    uint8_t offset = lane->head;
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
    lane->head = step_queue_next(offset);
}

void step_queue_loaded(uint8_t axis, uint8_t offset, struct loaded *loaded)
{
    const volatile struct segment_head *head = head_of(axis, offset);
    uint8_t steps, turns;
    if (line_is_on()) {
        const volatile struct line_segment *segment = (const volatile struct line_segment *)head;
        steps = segment->axes;
        turns = (uint8_t)(segment->turn_axes >> axis) & 1;
    } else {
        const volatile struct queued_segment *segment = (const volatile struct queued_segment *)head;
        steps = segment->step_mask;
        turns = segment->turn_mask;
    }
    loaded->time = head->interval;
    loaded->steps = 0;
    if (steps != 0) {
        loaded->steps = (uint16_t)(head->count_less_1 + 1u);
    }
    loaded->turns = turns != 0;
}
