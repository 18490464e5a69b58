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

static struct queued_segment *in_queue(uint8_t axis, uint8_t place)
{
    return &queues[axis][(place & (QUEUE_BYTES - 1)) / QUEUED_SEGMENT_BYTES];
}

static struct line_segment *in_line(uint8_t place)
{
    return &line_queue[place / LINE_SEGMENT_BYTES];
}

static volatile struct segment_head *head_of(uint8_t axis, uint8_t place)
{
    return (volatile struct segment_head *)(line_is_on() ? (void *)in_line(place) : (void *)in_queue(axis, place));
}

/* Places are written through volatile pointers: before the head is moved past them. */
void lane_put(uint8_t axis, uint16_t interval, int16_t add, uint16_t count_less_1, bool is_step, uint8_t turns)
{
    struct lane *lane = lane_of(axis);
    uint8_t place = lane->head;
    volatile struct segment_head *head = head_of(axis, place);
    head->interval = interval;
    head->add = add;
    head->count_less_1 = count_less_1;
    if (line_is_on()) {
        volatile struct line_segment *segment = in_line(place);
        line_fill_in(segment, is_step);
        segment->turn_axes = turns;
    } else {
        volatile struct queued_segment *segment = in_queue(axis, place);
        segment->step_mask = is_step ? engine_step_mask(axis) : 0;
        segment->turn_mask = turns != 0 ? engine_turn_mask(axis) : 0;
    }
    lane->head = lane_next(place);
}

struct loaded lane_loaded(uint8_t axis, uint8_t place)
{
    const volatile struct segment_head *head = head_of(axis, place);
    bool on = line_is_on();
    uint8_t steps = on ? in_line(place)->axes : in_queue(axis, place)->step_mask;
    uint8_t turns = on ? in_line(place)->turn_axes >> axis & 1 : in_queue(axis, place)->turn_mask;
    struct loaded loaded = {head->interval, steps != 0 ? (uint16_t)(head->count_less_1 + 1u) : 0, turns != 0};
    return loaded;
}
