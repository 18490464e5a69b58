/* The engine in C, for every machine but the stand-alone controller on an ATmega328P. A sketch may put that of a timer in its place. */
#ifndef STEPRAMP_IN_ASSEMBLY

#include "boards/polled/polled_engine.h"

#include <stddef.h>

#include "boards/polled/replaceable.h"
#include "stepramp/edge/engine.h"
#include "stepramp/edge/inputs.h"
#include "stepramp/edge/play_event.h"

/* From step_queue_start to the first event: at least 20 us [ticks]. */
enum { FAST_START_DELAY_TICKS = 480, SLOW_START_DELAY_TICKS = 60 };

struct axis_player stepramp_axis_players[MOST_AXES];
struct queued_segment stepramp_queues[MOST_AXES][QUEUE_SEGMENTS];
struct line_player stepramp_line_player;
#ifdef STEPRAMP_SHARED_QUEUES
typedef char line_fits_into_the_queues[sizeof stepramp_queues >= LINE_SEGMENTS * sizeof(struct line_segment) ? 1 : -1];
#else
struct line_segment stepramp_line_queue[LINE_SEGMENTS];
#endif

static uint16_t timer; /* [ticks] while an event is played, its time */
static bool is_fast;
static uint16_t start_delay_ticks;
static uint16_t line_due;
static uint8_t running; /* a bit for each axis; the line is bit 0 */
static bool is_line;
static void (*step_output)(uint8_t axes);
static void (*turn_output)(uint8_t axes);

static void step(uint8_t axes)
{
    if (axes != 0 && step_output != NULL) {
        step_output(axes);
    }
}

static void turn(uint8_t axes)
{
    if (axes != 0 && turn_output != NULL) {
        turn_output(axes);
    }
}

void polled_engine_set_outputs(void (*step_function)(uint8_t axes), void (*turn_function)(uint8_t axes))
{
    step_output = step_function;
    turn_output = turn_function;
}

static void park_line(void)
{
    stepramp_line_player.interval = LONGEST_WAIT_TICKS;
    stepramp_line_player.add = 0;
    stepramp_line_player.count_less_1 = 0;
    stepramp_line_player.pins = 0;
    stepramp_line_player.leader_pins = 0;
}

REPLACEABLE void step_queue_clear(uint8_t axes)
{
    for (uint8_t axis = 0; axis < MOST_AXES; axis++) {
        if ((axes & ~running & 1 << axis) != 0) {
            struct axis_player *player = &stepramp_axis_players[axis];
            park_player(player);
            player->head = player->retired = player->tail;
        }
    }
    if (is_line && running == 0) {
        park_line();
        stepramp_line_player.head = stepramp_line_player.retired = stepramp_line_player.tail;
    }
}

REPLACEABLE void step_queue_set_clock(bool fast)
{
    is_fast = fast;
    start_delay_ticks = fast ? FAST_START_DELAY_TICKS : SLOW_START_DELAY_TICKS;
}

bool polled_engine_is_fast(void)
{
    return is_fast;
}

REPLACEABLE void engine_set_line(bool line)
{
    is_line = line;
    step_queue_clear(0xFF);
}

REPLACEABLE void step_queue_begin(void)
{
    running = 0;
    step_queue_set_clock(true);
    engine_set_line(true);
    engine_set_line(false);
}

REPLACEABLE uint8_t engine_running(void)
{
    return running;
}

REPLACEABLE uint16_t engine_now(void)
{
    return timer;
}

REPLACEABLE struct engine_progress engine_progress(uint8_t axis)
{
    if (is_line) {
        return (struct engine_progress){stepramp_line_player.count_less_1, stepramp_line_player.tail, stepramp_line_player.empty};
    }
    const struct axis_player *player = &stepramp_axis_players[axis];
    return (struct engine_progress){player->count_less_1, player->tail, player->empty};
}

static void start_line(uint16_t first, uint16_t setup_ticks)
{
    if (running != 0 || stepramp_line_player.head == stepramp_line_player.tail) {
        return;
    }
    park_line();
    stepramp_line_player.interval = setup_ticks;
    stepramp_line_player.empty = 0;
    line_due = first;
    running = 1;
}

static void start_axis(uint8_t axis, uint16_t first, uint16_t setup_ticks)
{
    struct axis_player *player = &stepramp_axis_players[axis];
    if (player->head == player->tail) {
        return;
    }
    park_player(player);
    player->interval = setup_ticks;
    player->empty = 0;
    player->due = first;
    running |= (uint8_t)(1 << axis);
}

REPLACEABLE void step_queue_start(uint8_t axes, uint16_t setup_ticks)
{
#if HAS_INPUTS
    if (emergency_is_latched()) {
        return;
    }
#endif
    uint16_t first = (uint16_t)(timer + start_delay_ticks);
    if (is_line) {
        start_line(first, setup_ticks);
        return;
    }
    axes &= (uint8_t)~running;
    for (uint8_t axis = 0; axis < MOST_AXES; axis++) {
        if ((axes & 1 << axis) != 0) {
            start_axis(axis, first, setup_ticks);
        }
    }
}

REPLACEABLE void step_queue_halt(uint8_t axes)
{
    running = is_line ? 0 : (uint8_t)(running & ~axes);
}

/* The followers' pins in the order of their axes; here a pin is the bit of its axis. */
static void set_followers(uint8_t axes)
{
    uint8_t count = 0;
    for (uint8_t axis = 0; axis < MOST_AXES && count < MOST_FOLLOWERS; axis++) {
        if ((axes & 1 << axis) != 0) {
            stepramp_line_player.follower_pins[count++] = (uint8_t)(1 << axis);
        }
    }
    while (count < MOST_FOLLOWERS) {
        stepramp_line_player.follower_pins[count++] = 0;
    }
}

static void begin_piece(const struct line_segment *segment)
{
    for (uint8_t k = 0; k < MOST_FOLLOWERS; k++) {
        struct line_follower *follower = &stepramp_line_player.followers[k];
        follower->wait_add = (int16_t)segment->delta[k];
        follower->step_add = (int16_t)(segment->delta[k] - segment->total);
        follower->due = (int16_t)(follower->step_add + segment->total / 2);
    }
    set_followers(segment->axes >> 4);
}

static void load_line_segment(void)
{
    if (stepramp_line_player.tail == stepramp_line_player.head) {
        stepramp_line_player.empty++;
        running = 0;
        park_line();
        return;
    }
    struct line_segment *segment = stepramp_line_queue + stepramp_line_player.tail / LINE_SEGMENT_BYTES;
    stepramp_line_player.interval = segment->interval;
    stepramp_line_player.add = segment->add;
    stepramp_line_player.count_less_1 = segment->count_less_1;
    stepramp_line_player.leader_pins = segment->axes & 0x0F;
    if (segment->total != 0) {
        begin_piece(segment);
    }
    segment->interval = timer;
    stepramp_line_player.tail = (uint8_t)(stepramp_line_player.tail + LINE_SEGMENT_BYTES);
    turn(segment->turn_axes);
}

/* The pins of the leaders' next step. */
static uint8_t next_pins(void)
{
    uint8_t pins = stepramp_line_player.leader_pins;
    for (uint8_t k = 0; k < MOST_FOLLOWERS && stepramp_line_player.leader_pins != 0; k++) {
        struct line_follower *follower = &stepramp_line_player.followers[k];
        bool steps = follower->due >= 0;
        follower->due = (int16_t)(follower->due + (steps ? follower->step_add : follower->wait_add));
        pins |= steps ? stepramp_line_player.follower_pins[k] : 0;
    }
    return pins;
}

static void play_line(void)
{
    step(stepramp_line_player.pins);
    line_due = (uint16_t)(line_due + stepramp_line_player.interval);
    stepramp_line_player.interval = (uint16_t)(stepramp_line_player.interval + (uint16_t)stepramp_line_player.add);
    if (stepramp_line_player.count_less_1-- == 0) {
        load_line_segment();
    }
    stepramp_line_player.pins = next_pins();
}

static void play_axis(uint8_t axis)
{
    uint8_t result = play_event(&stepramp_axis_players[axis], stepramp_queues[axis], timer);
    uint8_t bit = (uint8_t)(1 << axis);
    step((result & EVENT_STEP) != 0 ? bit : 0);
    turn((result & EVENT_TURN) != 0 ? bit : 0);
    if ((result & EVENT_PARKED) != 0) {
        running &= (uint8_t)~bit;
    }
}

/* The running axis with the earliest event; its time in `due`. MOST_AXES when none runs. */
static uint8_t next_axis(uint16_t *due)
{
    uint8_t next = MOST_AXES;
    for (uint8_t axis = 0; axis < MOST_AXES; axis++) {
        uint16_t time = is_line ? line_due : stepramp_axis_players[axis].due;
        if ((running & 1 << axis) != 0 && (next == MOST_AXES || (int16_t)(time - *due) < 0)) {
            next = axis;
            *due = time;
        }
    }
    return next;
}

uint16_t polled_engine_play(uint16_t now)
{
    uint16_t due = 0;
    uint8_t axis;
    while ((axis = next_axis(&due)) != MOST_AXES && (int16_t)(due - now) <= 0) {
        timer = due;
        if (is_line) {
            play_line();
        } else {
            play_axis(axis);
        }
    }
    timer = now;
    return axis == MOST_AXES ? LONGEST_WAIT_TICKS : (uint16_t)(due - now);
}

#else

typedef int engine_is_in_assembly; /* ISO C wants something in each file */

#endif
