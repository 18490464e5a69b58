#include "lane.h"

#include "port.h"

uint8_t lane_ahead(const struct lane *lane)
{
    uint8_t bytes = (uint8_t)(lane->head - lane->tail);
    return line_is_on() ? bytes / LINE_SEGMENT_BYTES : (bytes & (QUEUE_BYTES - 1)) / QUEUED_SEGMENT_BYTES;
}

static struct queued_segment *in_queue(uint8_t axis, uint8_t place)
{
    return &queues[axis][(place & (QUEUE_BYTES - 1)) / QUEUED_SEGMENT_BYTES];
}

/* Places are written through volatile pointers: before the head is moved past them. */
void lane_put(uint8_t axis, uint16_t interval, int16_t add, uint16_t count_less_1, bool is_step, uint8_t turns)
{
    struct lane *lane = lane_of(axis);
    uint8_t place = lane->head;
    if (line_is_on()) {
        volatile struct line_segment *segment = &line_queue[place / LINE_SEGMENT_BYTES];
        segment->interval = interval;
        segment->add = add;
        segment->count_less_1 = count_less_1;
        line_fill_in(segment, is_step);
        segment->turn_axes = turns;
    } else {
        volatile struct queued_segment *segment = in_queue(axis, place);
        segment->interval = interval;
        segment->add = add;
        segment->count_less_1 = count_less_1;
        segment->step_mask = is_step ? engine_step_mask(axis) : 0;
        segment->turn_mask = turns != 0 ? engine_turn_mask(axis) : 0;
    }
    lane->head = lane_next(place);
}

struct loaded lane_loaded(uint8_t axis, uint8_t place)
{
    const struct line_segment *of_line = &line_queue[place / LINE_SEGMENT_BYTES];
    const struct queued_segment *queued = in_queue(axis, place);
    bool on = line_is_on(), steps = on ? of_line->axes != 0 : queued->step_mask != 0;
    uint16_t count = (uint16_t)((on ? of_line->count_less_1 : queued->count_less_1) + 1u);
    struct loaded loaded = {on ? of_line->interval : queued->interval, steps ? count : 0,
                            on ? (of_line->turn_axes >> axis & 1) != 0 : queued->turn_mask != 0};
    return loaded;
}
