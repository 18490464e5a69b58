#include "stepramp/protocol/controller.h"

#include "stepramp/edge/board.h"
#include "stepramp/motion/homing.h"
#include "stepramp/motion/machine.h"
#include "stepramp/motion/machine_inputs.h"
#include "stepramp/protocol/answers.h"
#include "stepramp/protocol/message.h"
#include "stepramp/protocol/reply.h"
#include "stepramp/protocol/report.h"
#include "stepramp/protocol/request.h"
#include "stepramp/protocol/trace.h"
#include "stepramp/store/ramp_keeper.h"

/* So long motors that need all of the time keep requests and notices waiting [ms]. */
enum { MOST_PATIENCE_MS = 40 };

enum { ALL_AXES = (1 << AXES) - 1 };

static bool is_written; /* the reply to the request that waits, which is not a frame yet */
static uint8_t heard;                       /* when the last request came: board_milliseconds() / 256 */

/* Makes what has been written a frame. */
static void send_reply(void)
{
    reply_end();
    reply_send();
    stepramp_requests.waiting_length = 0;
    is_written = false;
}

/* The same request as the last one: its reply was lost. A hello never counts as one, as it begins anew; nor does a
 * request of another session, which changes nothing and so is simply answered again. */
static bool is_repeat(void)
{
    const uint8_t *request = stepramp_requests.kept;
    return request[KIND_AT] == stepramp_answered_kind && request[TAG_AT] == stepramp_answered_tag && stepramp_answered_kind != KIND_HELLO &&
           answer_is_of_session(request);
}

/* What waits or is being sent gives way to a stop or halt: what has not begun then doesn't begin any more. Other requests
 * wait until there is time for them, one at a time. */
void controller_obey(uint8_t length)
{
    heard = (uint8_t)(board_milliseconds() >> 8);
    const uint8_t *message = stepramp_requests.is_beside ? stepramp_requests.urgent : stepramp_requests.kept;
    if (is_urgent(message[KIND_AT])) {
        reply_cut();
        answer(message, (uint8_t)(length - MESSAGE_HEADER_BYTES));
        send_reply();
    } else if (!stepramp_requests.is_beside && !reply_is_going_out()) {
        stepramp_requests.waiting_length = length;
    }
}

/* Goes on with the request that waits. Returns false when none does. */
static bool answer_waiting(void)
{
    if (stepramp_requests.waiting_length == 0) {
        return false;
    }
    if (is_written) {
        send_reply();
    } else if (is_repeat()) {
        reply_send();
        stepramp_requests.waiting_length = 0;
    } else {
        answer(stepramp_requests.kept, (uint8_t)(stepramp_requests.waiting_length - MESSAGE_HEADER_BYTES));
        is_written = !stepramp_answer_gave_way;
        if (stepramp_answer_gave_way) {
            stepramp_answered_kind = KIND_HELLO; /* nothing has been answered that could be asked for again */
            stepramp_answer_gave_way = false;
        }
    }
    return true;
}

void controller_begin(void)
{
    machine_begin();
    ramp_keeper_begin();
}

/* A run has no end of its own: it ends when nobody has asked for anything for so long. A program that has died, or a cable that
 * has been pulled, leaves no motor running. */
static void end_in_silence(uint8_t silence)
{
#if HAS_INPUTS
    if (silence <= stepramp_machine_settings->silence) {
        return;
    }
    if (has_homing()) {
        WITH_HOMING(homing_end)(ALL_AXES);
    }
    if ((stepramp_machine_settings->silence_flags & SILENCE_ENDS_MOVES) != 0) {
        machine_stop(ALL_AXES);
    }
#else
    if (silence <= USUAL_SILENCE) {
        return;
    }
#endif
    machine_stop_runs();
}

/* Goes on with what can wait until motors have what they need. Reports come at fixed times, so they go before traces,
 * which have room for all that waits in the meantime. */
static void go_on(uint16_t now_ms)
{
    end_in_silence((uint8_t)((now_ms >> 8) - heard));
    ramp_keeper_poll();
    if (!answer_waiting() && !report_poll(stepramp_session, now_ms)) {
        trace_poll(stepramp_session, now_ms);
    }
}

void controller_poll(void)
{
    static uint8_t had_time_ms;
    reply_poll();
    uint16_t now_ms = board_milliseconds();
#if HAS_INPUTS
    if (has_inputs()) {
        WITH_INPUTS(machine_watch_inputs)(now_ms);
    }
#endif
    if (machine_poll() || (uint8_t)(now_ms - had_time_ms) >= MOST_PATIENCE_MS) {
        had_time_ms = (uint8_t)now_ms;
        go_on(now_ms);
    }
}
