/* One event of an axis, in C: for the ports of the engine that aren't assembly. */
#ifndef STEPRAMP_PLAY_EVENT_H
#define STEPRAMP_PLAY_EVENT_H

#include "stepramp/edge/step_rings.h"

enum event_result {
    EVENT_STEP = 1,  /* the step pin is to be toggled */
    EVENT_TURN = 2,  /* then the direction pin */
    EVENT_PARKED = 4 /* the queue was empty: this was the last event */
};

/* The offset after another one in a queue [bytes]. Offsets keep bit 7, which belongs to the queue's address. */
static inline uint8_t offset_after(uint8_t offset)
{
    return (uint8_t)((offset & QUEUE_BYTES) | ((offset + QUEUED_SEGMENT_BYTES) & (QUEUE_BYTES - 1)));
}

static inline void park_player(struct axis_player *player)
{
    player->interval = LONGEST_WAIT_TICKS;
    player->add = 0;
    player->count_less_1 = 0;
    player->step_mask = 0;
}

/* Loads the next segment at an event at the timer's value `now`. */
static inline uint8_t load_segment(struct axis_player *player, struct queued_segment *queue, uint16_t now)
{
    uint8_t offset = player->tail;
    if (offset == player->head) {
        player->empty++;
        park_player(player);
        return EVENT_PARKED;
    }
    struct queued_segment *segment = queue + (offset & (QUEUE_BYTES - 1)) / QUEUED_SEGMENT_BYTES;
    player->interval = segment->interval;
    player->add = segment->add;
    player->count_less_1 = segment->count_less_1;
    player->step_mask = segment->step_mask;
    segment->interval = now;
    player->tail = offset_after(offset);
    return segment->turn_mask != 0 ? EVENT_TURN : 0;
}

/* Plays the event that is due. Returns a set of enum event_result. */
static inline uint8_t play_event(struct axis_player *player, struct queued_segment *queue, uint16_t now)
{
    uint8_t result = player->step_mask != 0 ? EVENT_STEP : 0;
    player->due = (uint16_t)(player->due + player->interval);
    player->interval = (uint16_t)(player->interval + (uint16_t)player->add);
    if (player->count_less_1-- == 0) {
        result |= load_segment(player, queue, now);
    }
    return result;
}

#endif
