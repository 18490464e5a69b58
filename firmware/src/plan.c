#include "plan.h"

/* How much shorter each interval of a falling segment is than the one before [ticks]: 1 to 32768. */
static uint16_t fall_of(const struct segment *segment)
{
    return (uint16_t)(0u - (uint16_t)segment->add);
}

/* Finds the stretch that begins `taken` intervals into the segment. */
static void find_stretch(struct walk *walk)
{
    if (walk->segment == walk->list->length) {
        walk->count = 0;
        return;
    }
    const struct segment *segment = &walk->list->segments[walk->segment];
    uint32_t interval = segment_interval(walk->first, segment, walk->taken);
    bool rose = interval > walk->shortest;
    walk->interval = rose ? walk->shortest : interval;
    walk->count = (uint16_t)(segment->count - walk->taken);
    walk->fall = rose || segment->add >= 0 ? 0 : fall_of(segment);
    if (rose && segment->add < 0) {
        uint32_t longer = (interval - walk->shortest - 1) / fall_of(segment) + 1;
        if (longer < walk->count) {
            walk->count = (uint16_t)longer;
        }
    }
}

void walk_begin(struct walk *walk, const struct segment_list *list)
{
    walk->list = list;
    walk->segment = 0;
    walk->first = list->length == 0 ? 0 : list->segments[0].change;
    walk->taken = 0;
    walk->last = 0;
    walk->shortest = UINT32_MAX;
    walk->steps = 0;
    find_stretch(walk);
}

/* Interval `index`, from 0, of the stretch. */
static uint32_t stretch_interval(const struct walk *walk, uint16_t index)
{
    return walk->interval - (uint32_t)walk->fall * index;
}

/* The number of intervals of the stretch that are `bound` ticks or longer. */
static uint16_t count_from(const struct walk *walk, uint32_t bound)
{
    if (walk->count == 0 || walk->interval < bound) {
        return 0;
    }
    if (stretch_interval(walk, (uint16_t)(walk->count - 1)) >= bound) {
        return walk->count;
    }
    return (uint16_t)((walk->interval - bound) / walk->fall + 1);
}

/* Goes on to the next segment, if there is one. */
static void enter_next_segment(struct walk *walk)
{
    const struct segment *segment = &walk->list->segments[walk->segment];
    walk->taken = 0;
    if (++walk->segment != walk->list->length) {
        uint32_t expected = segment_interval(walk->first, segment, segment->count);
        walk->first = (interval_t)(expected + segment[1].change);
    }
}

/* Goes on by `count` intervals of the stretch. */
static void take(struct walk *walk, uint16_t count)
{
    if (count == 0) {
        return;
    }
    const struct segment *segment = &walk->list->segments[walk->segment];
    walk->shortest = stretch_interval(walk, (uint16_t)(count - 1));
    walk->interval = walk->shortest - walk->fall;
    walk->count = (uint16_t)(walk->count - count);
    walk->taken = (uint16_t)(walk->taken + count);
    walk->steps += count;
    walk->last = segment_interval(walk->first, segment, (uint16_t)(walk->taken - 1));
    if (walk->count == 0) {
        if (walk->taken == segment->count) {
            enter_next_segment(walk);
        }
        find_stretch(walk);
    }
}

bool walk_on_while_longer(struct walk *walk, uint32_t bound)
{
    uint16_t longer = count_from(walk, bound + 1);
    bool to_the_end = longer == walk->count;
    take(walk, longer);
    return to_the_end && walk->count != 0;
}

struct reach walk_reach(const struct walk *walk)
{
    struct reach reach = {walk->segment, 0, (interval_t)walk->last, walk->steps};
    if (walk->taken != 0) {
        reach.segments++;
        reach.last_count = walk->taken;
    } else if (walk->segment != 0) {
        reach.last_count = walk->list->segments[walk->segment - 1].count;
    }
    return reach;
}

/* Of the first `steps` intervals of the two stretches merged, how many are of the up stretch. At most `most_up` and
 * `most_down` of them are of either. Found by bisection: the more are taken from up, the shorter its last one, and the
 * longer the first that is left in down. */
static uint16_t split(const struct walk *up, const struct walk *down, uint32_t steps, uint16_t most_up,
                      uint16_t most_down)
{
    uint16_t low = steps > most_down ? (uint16_t)(steps - most_down) : 0;
    uint16_t high = steps < most_up ? (uint16_t)steps : most_up;
    while (low < high) {
        uint16_t middle = (uint16_t)(high - (high - low) / 2);
        if (stretch_interval(up, (uint16_t)(middle - 1)) >= stretch_interval(down, (uint16_t)(steps - middle))) {
            low = middle;
        } else {
            high = (uint16_t)(middle - 1);
        }
    }
    return low;
}

/* Merges the two stretches until one of them is at its end or no step is left. Returns the steps left. */
static uint32_t merge_stretches(struct walk *up, struct walk *down, uint32_t steps)
{
    uint16_t from_up = up->count;
    uint16_t from_down = down->count;
    if (from_up != 0 && from_down != 0) {
        uint32_t up_last = stretch_interval(up, (uint16_t)(from_up - 1));
        uint32_t down_last = stretch_interval(down, (uint16_t)(from_down - 1));
        if (up_last >= down_last) {
            from_down = count_from(down, up_last + 1);
        } else {
            from_up = count_from(up, down_last);
        }
    }
    uint32_t both = (uint32_t)from_up + from_down;
    if (both > steps) {
        both = steps;
        from_up = split(up, down, steps, from_up, from_down);
        from_down = (uint16_t)(steps - from_up);
    }
    take(up, from_up);
    take(down, from_down);
    return steps - both;
}

static struct reach whole(const struct segment_list *list)
{
    struct reach reach = {list->length, 0, list->last_interval, list->steps};
    if (list->length != 0) {
        reach.last_count = list->segments[list->length - 1].count;
    }
    return reach;
}

void plan_move(const struct ramp *ramp, uint32_t steps, struct plan *plan)
{
    uint32_t both_lists = ramp->up.steps + ramp->down.steps;
    if (steps >= both_lists) {
        plan->up = whole(&ramp->up);
        plan->slew_steps = steps - both_lists;
        plan->down = whole(&ramp->down);
        return;
    }
    struct walk up, down;
    walk_begin(&up, &ramp->up);
    walk_begin(&down, &ramp->down);
    while (steps != 0) {
        steps = merge_stretches(&up, &down, steps);
    }
    plan->up = walk_reach(&up);
    plan->slew_steps = 0;
    plan->down = walk_reach(&down);
}
