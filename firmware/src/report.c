#include "report.h"

#include "limits.h"
#include "machine.h"
#include "ramp_store.h"
#include "reply.h"

enum { MS_A_SECOND = 1000 };

static uint8_t rate_hz; /* 0: no reports */
static uint16_t due_ms;
static uint8_t tag;

void report_start(uint8_t new_rate_hz, uint16_t now_ms)
{
    rate_hz = new_rate_hz;
    due_ms = now_ms;
}

static void write_report(uint16_t session, uint16_t now_ms)
{
    uint8_t states = 0;
    notice_begin(KIND_REPORT_NOTICE, session, tag++);
    reply_u16(now_ms);
    uint8_t *states_byte = reply_reserved_byte();
    for (uint8_t i = 0; i < AXES; i++) {
        struct axis_report axis = machine_report(i);
        states = (uint8_t)(states >> 2 | axis.state << (8 - 2));
        if (i < ramp_store_axes()) {
            reply_numbers(&axis.position, 1);
            reply_numbers(&axis.interval, 1);
        }
    }
    *states_byte = states;
    notice_send();
}

bool report_poll(uint16_t session, uint16_t now_ms)
{
    uint16_t late_ms = (uint16_t)(now_ms - due_ms);
    if (rate_hz == 0 || notice_is_going_out() || late_ms > INT16_MAX) {
        return false;
    }
    uint16_t period_ms = (uint16_t)(MS_A_SECOND / rate_hz);
    /* A report that comes too late for the next one takes its place: reports never queue up. */
    due_ms = late_ms < period_ms ? (uint16_t)(due_ms + period_ms) : (uint16_t)(now_ms + period_ms);
    write_report(session, now_ms);
    return true;
}
