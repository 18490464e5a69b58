/* What of the queues has been played. */
#include "stepramp/edge/engine.h"
#include "stepramp/edge/line_pieces.h"
#include "stepramp/edge/step_places.h"
#include "stepramp/edge/step_queue.h"

bool step_queue_has_parked(uint8_t axis)
{
    return step_places_ends(axis)->empty != 0;
}

/* That loaded last, the one before the tail, is being played, unless the axis has parked. The time of a segment's last event
 * is that of loading the next. */
bool step_queue_take(uint8_t axis, struct step_played *played)
{
    struct ring_ends *ends = step_places_ends(axis);
    uint8_t offset = ends->retired, next = step_places_after(offset);
    if (offset == ends->tail || (next == ends->tail && ends->empty == 0)) {
        return false;
    }
    step_places_read(axis, offset, played);
    if (line_is_on()) {
        line_play(&stepramp_line_taken, step_places_line(offset), played->steps);
    }
    ends->retired = next;
    played->has_time = next != ends->tail;
    played->time = step_places_time(axis, next);
    return true;
}

void step_queue_played(uint8_t axis, struct step_played *played)
{
    struct engine_progress now = engine_progress(axis);
    uint8_t offset = step_places_ends(axis)->retired;
    played->steps = 0;
    played->turned = false;
    line_look();
    while (offset != now.tail) {
        struct step_played segment;
        step_places_read(axis, offset, &segment);
        uint16_t steps = segment.steps;
        uint8_t next = step_places_after(offset);
        if (steps != 0 && next == now.tail && now.empty == 0) {
            steps = (uint16_t)(steps - 1u - now.count_less_1);
        }
        played->steps = (uint16_t)(played->steps + steps);
        played->turned = played->turned != segment.turned;
        if (line_is_on()) {
            line_play(&stepramp_line_looked, step_places_line(offset), steps);
        }
        offset = next;
    }
}

struct step_interval step_queue_passing(uint8_t axis)
{
    const struct axis_player *player = &stepramp_axis_players[axis];
    const volatile uint16_t *present = line_is_on() ? &stepramp_line_player.interval : &player->interval;
    uint16_t ticks;
    do {
        ticks = *present;
    } while (ticks != *present); /* an event came in between the two bytes */
    return (struct step_interval){ticks, (line_is_on() ? stepramp_line_player.leader_pins : player->step_mask) != 0};
}

struct step_interval step_queue_next(uint8_t axis)
{
    struct ring_ends *ends = step_places_ends(axis);
    struct step_played segment;
    step_places_read(axis, ends->tail, &segment);
    return (struct step_interval){segment.time, segment.steps != 0 && ends->tail != ends->head};
}
