/* The engine's functions: how axes start, halt and park. What they leave to the interrupts is in step_interrupt.h.
 *
 * A blocked section delays steps, so each is short: 5 us at most. */
#ifdef STEPRAMP_IN_ASSEMBLY

#include "stepramp/edge/engine.h"

#include <avr/interrupt.h>
#include <avr/io.h>
#include <stddef.h>
#include <util/atomic.h>

#include "boards/avr/gauge.h"
#include "boards/avr/pins.h"
#include "boards/avr/step_interrupt.h"
#include "stepramp/edge/inputs.h"
#include "stepramp/edge/out_of_line.h"
#include "stepramp/edge/step_rings.h"

_Static_assert(sizeof(struct axis_player) == AXIS_PLAYER_BYTES, "known to engine.S");
_Static_assert(offsetof(struct axis_player, interval) == INTERVAL, "known to engine.S");
_Static_assert(offsetof(struct axis_player, step_mask) == STEP_MASK, "known to engine.S");
_Static_assert(offsetof(struct axis_player, tail) == TAIL, "known to engine.S");
_Static_assert(offsetof(struct axis_player, empty) == EMPTY, "known to engine.S");
_Static_assert(sizeof(struct queued_segment) == QUEUED_SEGMENT_BYTES, "known to engine.S");
_Static_assert(sizeof(struct line_player) == LINE_PLAYER_BYTES, "known to line.S");
_Static_assert(sizeof(struct line_segment) == LINE_SEGMENT_BYTES, "known to line.S");
_Static_assert(sizeof(struct line_follower) == LINE_FOLLOWER_BYTES, "known to line.S");
_Static_assert(offsetof(struct line_follower, step_add) == STEP_ADD, "known to line.S");
_Static_assert(offsetof(struct line_follower, due) == DUE_TO_STEP, "known to line.S");
_Static_assert(offsetof(struct line_player, follower_pins) == LINE_FOLLOWER_PINS, "known to line.S");
_Static_assert(offsetof(struct line_player, pins) == LINE_PINS, "known to line.S");
_Static_assert(offsetof(struct line_player, tail) == LINE_TAIL, "known to line.S");

#define IS_SET(bit) ((GPIOR0 & _BV(bit)) != 0)

/* From the choice of a start to it: the 20 us that are promised, and what it takes until it is set [ticks]. */
enum { FAST_START_DELAY_TICKS = 480, SLOW_START_DELAY_TICKS = 60 };

/* An axis can be put in the place of its channel's next one when its event is at least so far away [ticks]. */
enum { EXCHANGE_TICKS = 64 };

enum { ALL_AXES = (1 << MOST_AXES) - 1 };

/* The end masks of parked axes are 0; engine.S */
extern uint8_t stepramp_end_masks[MOST_AXES];

static uint16_t start_delay_ticks;

#ifndef STEPRAMP_IN_A_SKETCH
static uint8_t offset_of(const void *queue)
{
    return (uint8_t)(uintptr_t)queue;
}
#endif

void step_queue_set_clock(bool fast)
{
    start_delay_ticks = fast ? FAST_START_DELAY_TICKS : SLOW_START_DELAY_TICKS;
    TCCR1B = fast ? _BV(CS10) : _BV(CS11);
}

void step_queue_begin(void)
{
    TIMSK1 = 0;
    TCCR1A = 0;
#ifndef STEPRAMP_IN_A_SKETCH
    TCCR0B = 0; /* Timer0 stands still: see SAVED_R25 */
#endif
    GPIOR0 = 0;
    step_queue_set_clock(true);
#ifndef STEPRAMP_IN_A_SKETCH /* there, offsets begin with 0 */
    for (uint8_t axis = 0; axis < MOST_AXES; axis++) {
        stepramp_axis_players[axis].tail = offset_of(stepramp_queues[axis]);
    }
    stepramp_line_player.tail = offset_of(stepramp_line_queue);
#endif
    step_queue_clear(0xFF);
}

void engine_set_line(bool line)
{
    if (GAUGE_OUTPUTS) {
        return;
    }
    GPIOR0 = (uint8_t)((GPIOR0 & (_BV(WIDE) | _BV(LISTENS))) | (line ? _BV(OTHER_MODE) : 0));
    step_queue_clear(0xFF);
}

static inline bool is_line(void)
{
    return IS_SET(OTHER_MODE) && !GAUGE_OUTPUTS;
}

/* ---- the two channels ----
 *
 * A channel is named by the bit of its first axis: 1 is A, 2 is B. All its other bits are a shift away. */

_Static_assert(OCIE1B == OCIE1A + 1 && OCF1A == OCIE1A && A_SECOND == 1 && B_SECOND == 2 && A_SHARED == 3 && B_SHARED == 4,
               "a shift away");

enum { CHANNEL_A = 1, CHANNEL_B = 2 };

static inline uint8_t second_axis(uint8_t channel)
{
    return (uint8_t)(channel << 2);
}

/* In GPIOR0 */
static inline uint8_t second_flag(uint8_t channel)
{
    return (uint8_t)(channel << 1);
}

static inline uint8_t shared_flag(uint8_t channel)
{
    return (uint8_t)(channel << 3);
}

/* In TIMSK1, and of the flag in TIFR1 */
static inline uint8_t enable_flag(uint8_t channel)
{
    return (uint8_t)(channel << OCIE1A);
}

static inline volatile uint16_t *compare_of(uint8_t channel)
{
    return &OCR1A + (channel - CHANNEL_A);
}

/* That of the first axis; that of the second one is two later. */
static inline struct axis_player *players_of(uint8_t channel)
{
    return &stepramp_axis_players[channel - CHANNEL_A];
}

uint16_t engine_now(void)
{
    uint16_t now;
    ATOMIC_BLOCK(ATOMIC_RESTORESTATE) { now = TCNT1; }
    return now;
}

/* The axes of a channel that run, as bits. `flags` are GPIOR0's, `enabled` TIMSK1's. */
static uint8_t running_in_channel(uint8_t channel, uint8_t flags, uint8_t enabled)
{
    if ((enabled & enable_flag(channel)) == 0) {
        return 0;
    }
    if ((flags & shared_flag(channel)) != 0) {
        return channel | second_axis(channel);
    }
    return (flags & second_flag(channel)) != 0 ? second_axis(channel) : channel;
}

uint8_t engine_running(void)
{
    uint8_t enabled, flags;
    ATOMIC_BLOCK(ATOMIC_RESTORESTATE)
    {
        enabled = TIMSK1;
        flags = GPIOR0;
    }
    if (GAUGE_OUTPUTS) {
        return gauges_running();
    }
    if ((flags & _BV(OTHER_MODE)) != 0) {
        return enabled != 0;
    }
    return running_in_channel(CHANNEL_A, flags, enabled) | running_in_channel(CHANNEL_B, flags, enabled);
}

struct engine_progress engine_progress(uint8_t axis)
{
    struct engine_progress progress;
    const volatile uint8_t *tail = &stepramp_line_player.tail;
    const volatile uint16_t *count_less_1 = &stepramp_line_player.count_less_1;
    if (!is_line()) {
        tail = &stepramp_axis_players[axis].tail;
        count_less_1 = &stepramp_axis_players[axis].count_less_1;
    }
    ATOMIC_BLOCK(ATOMIC_RESTORESTATE)
    {
        progress.count_less_1 = *count_less_1;
        progress.tail = tail[0];
        progress.empty = tail[offsetof(struct axis_player, empty) - offsetof(struct axis_player, tail)];
    }
    return progress;
}

/* ---- start ---- */

/* A parked axis plays one silent event, which loads its first segment. */
static void OUT_OF_LINE prepare(struct axis_player *player, uint16_t setup_ticks)
{
    player->interval = setup_ticks;
    player->add = 0;
    player->count_less_1 = 0;
    player->step_mask = 0;
    player->empty = 0;
    stepramp_end_masks[player - stepramp_axis_players] = 0;
}

/* The same of a parked line. */
static void OUT_OF_LINE prepare_line(uint16_t setup_ticks)
{
    stepramp_line_player.interval = setup_ticks;
    stepramp_line_player.add = 0;
    stepramp_line_player.count_less_1 = 0;
    stepramp_line_player.leader_pins = 0;
    stepramp_line_player.pins = 0;
    stepramp_line_player.empty = 0;
}

/* Asked with interrupts blocked, by whoever is about to enable those of the timer. */
static inline bool may_start(void)
{
#if HAS_INPUTS
    return !emergency_is_latched();
#else
    return true;
#endif
}

/* In engine.S */
bool engine_start_at(uint16_t start, uint16_t latest, uint8_t axes);

/* Interrupts may come between the choice of the start and the start. When they take too long, it is chosen anew. */
static void start_axes(uint8_t axes)
{
    uint16_t start;
    do {
        start = (uint16_t)(engine_now() + start_delay_ticks);
        struct axis_player *player = stepramp_axis_players;
        for (uint8_t left = axes; left != 0; left >>= 1, player++) {
            if ((left & 1) != 0) {
                player->due = start;
            }
        }
        __asm__ volatile("" ::: "memory"); /* all that the interrupts will read is written */
    } while (!engine_start_at(start, (uint16_t)(start - start_delay_ticks / 4), axes));
}

static void start_line(uint16_t setup_ticks)
{
    if (TIMSK1 != 0 || stepramp_line_player.head == stepramp_line_player.tail) {
        return;
    }
    prepare_line(setup_ticks);
    ATOMIC_BLOCK(ATOMIC_RESTORESTATE)
    {
        OCR1A = TCNT1 + start_delay_ticks;
        TIFR1 = _BV(OCF1A);
        TIMSK1 = may_start() ? _BV(OCIE1A) : 0;
    }
}

void step_queue_start(uint8_t axes, uint16_t setup_ticks)
{
    if (is_line()) {
        start_line(setup_ticks);
        return;
    }
    struct axis_player *player = stepramp_axis_players;
    uint8_t starting = axes & (uint8_t)~engine_running() & ALL_AXES;
    for (uint8_t bit = 1; bit <= ALL_AXES; bit = (uint8_t)(bit << 1), player++) {
        if (player->head == player->tail) {
            starting &= (uint8_t)~bit;
        }
        if ((starting & bit) != 0) {
            prepare(player, setup_ticks);
        }
    }
    if (GAUGE_OUTPUTS) {
        gauges_start(starting, start_delay_ticks);
    } else if (starting != 0) {
        start_axes(starting);
    }
}

/* ---- halt ---- */

/* The other axis of the channel is the next one from now on. Returns false when its event is too near for that. */
static bool exchange_next(uint8_t channel, uint16_t due)
{
    if ((int16_t)(due - TCNT1) < EXCHANGE_TICKS) {
        return false;
    }
    *compare_of(channel) = due;
    TIFR1 = enable_flag(channel); /* the event that doesn't come any more may have been waiting */
    GPIOR0 ^= second_flag(channel);
    return true;
}

/* Returns false when it has to be tried again. */
static bool halt_in_channel(uint8_t channel, uint8_t axes)
{
    uint8_t running = running_in_channel(channel, GPIOR0, TIMSK1);
    uint8_t staying = running & (uint8_t)~axes;
    if (staying == running) {
        return true;
    }
    if (staying == 0) {
        TIMSK1 &= (uint8_t)~enable_flag(channel);
    } else {
        uint8_t next = (GPIOR0 & second_flag(channel)) != 0 ? second_axis(channel) : channel;
        if (next != staying && !exchange_next(channel, players_of(channel)[staying == channel ? 0 : 2].due)) {
            return false;
        }
    }
    GPIOR0 &= (uint8_t)~shared_flag(channel);
    return true;
}

void step_queue_halt(uint8_t axes)
{
    if (GAUGE_OUTPUTS) {
        gauges_halt(axes);
        return;
    }
    if (is_line()) {
        TIMSK1 = 0;
        return;
    }
    for (uint8_t channel = CHANNEL_A; channel <= CHANNEL_B; channel++) {
        bool is_done = false;
        while (!is_done) { /* in between the interrupts may come */
            ATOMIC_BLOCK(ATOMIC_RESTORESTATE) { is_done = halt_in_channel(channel, axes); }
        }
    }
}

/* ---- park ---- */

void step_queue_clear(uint8_t axes)
{
    if (is_line()) {
        if (TIMSK1 == 0) {
            prepare_line(LONGEST_WAIT_TICKS);
            stepramp_line_player.head = stepramp_line_player.retired = stepramp_line_player.tail;
        }
        return;
    }
    struct axis_player *player = stepramp_axis_players;
    for (uint8_t left = axes & (uint8_t)~engine_running() & ALL_AXES; left != 0; left >>= 1, player++) {
        if ((left & 1) != 0) {
            prepare(player, LONGEST_WAIT_TICKS);
            player->head = player->retired = player->tail;
        }
    }
}

#endif
