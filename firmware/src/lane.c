#include "lane.h"

#include "port.h"

uint8_t lane_ahead(const struct lane *lane)
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

static struct queued_segment *in_queue(uint8_t axis, uint8_t offset)
{
    return &queues[axis][(offset & (QUEUE_BYTES - 1)) / QUEUED_SEGMENT_BYTES];
}

static struct line_segment *in_line(uint8_t offset)
{
    return &line_queue[offset / LINE_SEGMENT_BYTES];
}

static volatile struct segment_head *head_of(uint8_t axis, uint8_t offset)
{
    return (volatile struct segment_head *)(line_is_on() ? (void *)in_line(offset) : (void *)in_queue(axis, offset));
}

/* Places are written through volatile pointers: before the head is moved past them. */
void lane_put(uint8_t axis, uint16_t interval, int16_t add, uint16_t count_less_1, bool is_step, uint8_t turns)
{
    struct lane *lane = lane_of(axis);
    uint8_t offset = lane->head;
    volatile struct segment_head *head = head_of(axis, offset);
    head->interval = interval;
    head->add = add;
    head->count_less_1 = count_less_1;
    if (line_is_on()) {
        volatile struct line_segment *segment = in_line(offset);
        line_fill_in(segment, is_step);
        segment->turn_axes = turns;
    } else {
        volatile struct queued_segment *segment = in_queue(axis, offset);
        segment->step_mask = is_step ? engine_step_mask(axis) : 0;
        segment->turn_mask = turns != 0 ? engine_turn_mask(axis) : 0;
    }
    lane->head = lane_next(offset);
}

struct loaded lane_loaded(uint8_t axis, uint8_t offset)
{
    const volatile struct segment_head *head = head_of(axis, offset);
    bool on = line_is_on();
    uint8_t steps = on ? in_line(offset)->axes : in_queue(axis, offset)->step_mask;
    uint8_t turns = on ? in_line(offset)->turn_axes >> axis & 1 : in_queue(axis, offset)->turn_mask;
    struct loaded loaded = {head->interval, steps != 0 ? (uint16_t)(head->count_less_1 + 1u) : 0, turns != 0};
    return loaded;
}
