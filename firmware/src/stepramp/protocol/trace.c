#include "stepramp/protocol/trace.h"

#include "stepramp/protocol/message.h"
#include "stepramp/protocol/reply.h"

/* A frame is made of so many values or more, when the line has room. Those that come in the time of such a frame, a
 * report and a long reply, 12 at 1000 a second, wait for the next one. */
enum { ENOUGH_FOR_A_FRAME = 6 };

/* Longest that values wait for a frame to become full [ms]. */
enum { MOST_PATIENCE_MS = 50 };

/* What goes on. */
enum {
    IN_A_MOVE = 1,  /* that began when the trace was armed */
    END_IS_DUE = 2, /* the move has ended, but its last frame has not been made */
    GAP_FOLLOWS = 4 /* a value was dropped: what waits goes first, and then others may come */
};

/* The values that wait: of consecutive ones of the steps asked for. */
static uint16_t waiting[MOST_TRACE_VALUES];
static uint8_t waiting_count;
static uint32_t next_step; /* that of the value that would continue them */

static uint8_t traced_axis;
static uint16_t every; /* 0: no trace */
static uint8_t flags;
static uint8_t tag;
static uint8_t sent_ms; /* when the last frame was made */

void trace_arm(uint8_t axis, uint16_t every_steps)
{
    traced_axis = axis;
    every = every_steps;
    waiting_count = 0;
    flags = 0;
}

void trace_off(void)
{
    trace_arm(0, 0);
}

uint16_t trace_every(uint8_t axis)
{
    return (flags & IN_A_MOVE) != 0 && axis == traced_axis ? every : 0;
}

void trace_begin_move(uint8_t axis)
{
    if (every != 0 && axis == traced_axis) {
        flags |= IN_A_MOVE;
    }
}

void trace_value(uint8_t axis, uint32_t step, uint16_t value)
{
    if (trace_every(axis) == 0 || (flags & END_IS_DUE) != 0) {
        return; /* while the end of the move before is due, the beginning of this one is lost */
    }
    if (waiting_count == 0) {
        next_step = step;
        flags = IN_A_MOVE;
    }
    if ((flags & GAP_FOLLOWS) != 0 || waiting_count == MOST_TRACE_VALUES || step != next_step) {
        flags |= GAP_FOLLOWS;
        return;
    }
    waiting[waiting_count++] = value;
    next_step += every;
}

void trace_end_move(uint8_t axis)
{
    if (trace_every(axis) != 0) {
        flags = (uint8_t)((flags & ~IN_A_MOVE) | END_IS_DUE);
    }
}

static void write_frame(uint16_t session)
{
    notice_begin(KIND_TRACE_NOTICE, session, tag++);
    reply_u8((flags & END_IS_DUE) != 0 ? traced_axis | TRACE_LAST : traced_axis);
    reply_u16(every);
    reply_u32(next_step - (uint32_t)waiting_count * every);
    for (uint8_t i = 0; i < waiting_count; i++) {
        reply_u16(waiting[i]);
    }
    notice_send();
    waiting_count = 0;
    flags &= IN_A_MOVE;
}

/* It is time for a frame: a move has ended, or enough values wait, or some for long enough or with a gap after them. */
static bool is_time(uint8_t now_ms)
{
    bool is_patient = (uint8_t)(now_ms - sent_ms) < MOST_PATIENCE_MS && (flags & GAP_FOLLOWS) == 0;
    return (flags & END_IS_DUE) != 0 || waiting_count >= ENOUGH_FOR_A_FRAME || (waiting_count != 0 && !is_patient);
}

bool trace_poll(uint16_t session, uint16_t now_ms)
{
    if (notice_is_going_out() || !is_time((uint8_t)now_ms)) {
        return false;
    }
    write_frame(session);
    sent_ms = (uint8_t)now_ms;
    return true;
}
