#include "stepramp/protocol/report.h"

#include "stepramp/edge/board_limits.h"
#include "stepramp/motion/machine.h"
#include "stepramp/protocol/reply.h"
#include "stepramp/store/ramp_keeper.h"

enum { MS_A_SECOND = 1000 };

/* Of the message: up to the states, and of each axis. */
enum { HEAD_BYTES = MESSAGE_HEADER_BYTES + 3, AXIS_BYTES = 8 };

static uint8_t rate_hz; /* 0: no reports */
static uint16_t due_ms;
static uint8_t tag;

/* The report that is being written, an axis at a time: each takes a millisecond when interrupts take nearly all of the
 * processor. */
static uint8_t length; /* of its message so far; 0: none is written */
static uint8_t end_length, states;

void report_start(uint8_t new_rate_hz, uint16_t now_ms)
{
    rate_hz = new_rate_hz;
    due_ms = now_ms;
    length = 0;
}

static void begin(uint16_t session, uint16_t now_ms)
{
    notice_begin(KIND_REPORT_NOTICE, session, tag++);
    reply_u16(now_ms);
    length = HEAD_BYTES;
    end_length = (uint8_t)(HEAD_BYTES + AXIS_BYTES * ramp_keeper_axes());
    states = 0;
}

static void write_axis(void)
{
    uint8_t index = (uint8_t)(length - HEAD_BYTES) / AXIS_BYTES;
    struct axis_report axis = machine_report(index);
    states |= (uint8_t)(axis.state << 2 * index);
    notice_go_on(length);
    reply_numbers(&axis.position, 1);
    reply_u32(machine_interval(index));
    length += AXIS_BYTES;
}

static void end(void)
{
    notice_go_on(HEAD_BYTES - 1);
    reply_u8(states);
    notice_go_on(length);
    notice_send();
    length = 0;
}

bool report_poll(uint16_t session, uint16_t now_ms)
{
    if (length != 0) {
        if (length == end_length) {
            end();
        } else {
            write_axis();
        }
        return true;
    }
    uint16_t late_ms = (uint16_t)(now_ms - due_ms);
    if (rate_hz == 0 || notice_is_going_out() || late_ms > INT16_MAX) {
        return false;
    }
    uint16_t period_ms = (uint16_t)MS_A_SECOND / rate_hz;
    /* A report that comes too late for the next one takes its place: reports never queue up. */
    due_ms = late_ms < period_ms ? (uint16_t)(due_ms + period_ms) : (uint16_t)(now_ms + period_ms);
    begin(session, now_ms);
    return true;
}
