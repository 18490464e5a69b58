#include "playback.h"

#include "player.h"

/* A wait that is too long for one event is waited for in parts of this many ticks. */
#define PART_TICKS 16384u

/* For what the interrupt seldom does: inlined, it would make the interrupt save more registers each time. */
#ifdef __GNUC__
#define NOT_INLINED __attribute__((noinline))
#else
#define NOT_INLINED
#endif

struct playback playback;

/* The interval after `interval` in the same run. */
static inline interval_t next_of_run(interval_t interval)
{
    interval_t add = (interval_t)playback.run.add;
    return playback.phase == PHASE_DOWN ? interval - add : interval + add;
}

static inline void load_up(void)
{
    const struct segment *segment = playback.segment++;
    playback.run.interval += (interval_t)playback.run.add + segment->change;
    playback.run.add = segment->add;
    playback.run.left = --playback.segments_left == 0 ? playback.up_last_count : segment->count;
}

static inline void load_down(void)
{
    playback.run.interval -= playback.segment->change;
    const struct segment *segment = --playback.segment;
    playback.run.interval -= (interval_t)segment->add;
    playback.run.add = segment->add;
    playback.run.left = segment->count;
    playback.segments_left--;
}

/* Loads slew intervals: as many as a run can count. */
static inline void load_slew(void)
{
    playback.phase = PHASE_SLEW;
    playback.run.interval = playback.slew_interval;
    playback.run.add = 0;
    playback.run.left = playback.slew_left > UINT16_MAX ? UINT16_MAX : (uint16_t)playback.slew_left;
    playback.slew_left -= playback.run.left;
}

static inline void begin_way_down(void)
{
    const volatile struct way *way = playback.way;
    playback.phase = PHASE_DOWN;
    playback.run.interval = way->run.interval;
    playback.run.add = way->run.add;
    playback.run.left = way->run.left;
    playback.segment = way->segment;
    playback.segments_left = way->segments_left;
}

/* Loads what follows the last run; at the end of the move that is a run of no interval. */
static inline void load_run(void)
{
    if (playback.segments_left != 0) {
        if (playback.phase == PHASE_DOWN) {
            load_down();
        } else {
            load_up();
        }
    } else if (playback.phase == PHASE_DOWN) {
        playback.run.left = 0;
    } else if (playback.slew_left != 0) {
        load_slew();
    } else {
        begin_way_down();
    }
}

/* Plays the present interval once more, and then `turn`. */
static inline void take_turn(void)
{
    playback.run.interval = playback.present;
    playback.run.left = 1;
    playback.segments_left = 0;
    playback.slew_left = 0;
    playback.way = &playback.turn;
    playback.turn_pulses = playback.pulses;
    playback.request = REQUEST_NONE;
}

void playback_load_first_run(void)
{
    playback.run.interval = 0;
    playback.run.add = 0;
    load_run();
}

bool player_pulse_is_due(void)
{
    return playback.pulse_is_due;
}

/* Returns the next part of what is left to wait; after the last one comes a pulse, or the end of the move. */
NOT_INLINED static uint16_t wait_on(void)
{
    if (playback.wait_left > PLAYER_LONGEST_WAIT_TICKS) {
        playback.pulse_is_due = false;
        playback.wait_left -= PART_TICKS;
        return PART_TICKS;
    }
    uint16_t ticks = (uint16_t)playback.wait_left;
    playback.wait_left = 0;
    playback.pulse_is_due = playback.run.left != 0;
    return ticks;
}

NOT_INLINED static uint16_t silent_event(void)
{
    if (playback.wait_left == 0) {
        playback.moving = false;
        return 0;
    }
    if (playback.request == REQUEST_TURN && playback.phase != PHASE_DOWN) {
        take_turn();
    }
    return wait_on();
}

/* Begins the present interval, whatever it is and whatever comes next. */
static inline uint16_t begin_interval(void)
{
    if (playback.present > PLAYER_LONGEST_WAIT_TICKS) {
        playback.wait_left = playback.present;
        return wait_on();
    }
    playback.pulse_is_due = playback.run.left != 0;
    return (uint16_t)playback.present;
}

NOT_INLINED static uint16_t last_pulse_of_run(void)
{
    load_run();
    return begin_interval();
}

/* A pulse while the main loop wants something. To turn takes long, and so does loading a run: both never happen in one
 * event, as a turn at the end of the last run waits for the next event. */
NOT_INLINED static uint16_t pulse_while_stopping(void)
{
    if (playback.present < playback.run.interval) {
        playback.present = playback.run.interval;
    }
    bool way_is_next = playback.run.left == 1 && playback.segments_left == 0;
    if (playback.request == REQUEST_TURN && playback.phase != PHASE_DOWN && !way_is_next) {
        take_turn();
        return begin_interval();
    }
    if (--playback.run.left == 0) {
        return last_pulse_of_run();
    }
    playback.run.interval = next_of_run(playback.run.interval);
    return begin_interval();
}

uint16_t player_event(void)
{
    if (!playback.pulse_is_due) {
        return silent_event();
    }
    playback.pulses++;
    if (playback.request != REQUEST_NONE) {
        return pulse_while_stopping();
    }
    interval_t interval = playback.run.interval;
    playback.present = interval;
    if (--playback.run.left == 0) {
        return last_pulse_of_run();
    }
    playback.run.interval = next_of_run(interval);
    return interval > PLAYER_LONGEST_WAIT_TICKS ? begin_interval() : (uint16_t)interval;
}
