/* Plays a job on the engine and tells what came of it; see jobs.py, which writes jobs. The same program runs on the
 * chip, with the assembly, and on this machine, with boards/polled/polled_engine.c. It does what a main loop must: fill the queues,
 * count what has been played, and move bytes over the serial port. */
#include "play_job.h"

#include "stepramp/edge/board.h"
#include "stepramp/edge/engine.h"
#include "stepramp/store/driver_settings.h"

enum { TRACED = 8, NEVER = 0xFFFF };

struct axis_job {
    uint16_t next, end; /* of its segments */
    uint16_t first, repeats;
};

/* What is reported at the end, little-endian as it is in memory. */
static struct result {
    int32_t position[MOST_AXES];
    uint16_t traced[MOST_AXES][TRACED];
    uint16_t received;
    uint8_t empty[MOST_AXES];
} result;

static struct job_head head;
static struct axis_job axis_jobs[MOST_AXES];
static bool backward[MOST_AXES];
static uint8_t loads[MOST_AXES];
static uint16_t watched_loads;
static bool has_begun;
static uint8_t lanes; /* queues in use: 4, or 1 on a line */

static void begin_axis(uint8_t axis)
{
    uint16_t first = head.axes[axis].first, count = head.axes[axis].count;
    axis_jobs[axis] = (struct axis_job){first, (uint16_t)(first + count), first, count == 0 ? 0 : head.axes[axis].repeats};
}

/* Gives the index of the next segment. Returns false when there is none. */
static bool next_index(uint8_t axis, uint16_t *index)
{
    struct axis_job *job = &axis_jobs[axis];
    if (job->next == job->end) {
        if (job->repeats <= 1 || job->first == job->end) {
            return false;
        }
        job->repeats--;
        job->next = job->first;
    }
    *index = job->next;
    return true;
}

static void fill_axis(uint8_t axis)
{
    struct axis_player *player = &stepramp_axis_players[axis];
    uint8_t offset = player->head;
    uint8_t after = (uint8_t)((offset & QUEUE_BYTES) | ((offset + QUEUED_SEGMENT_BYTES) & (QUEUE_BYTES - 1)));
    uint16_t index;
    if (after == player->retired || !next_index(axis, &index)) {
        return;
    }
    axis_jobs[axis].next++;
    struct queued_segment *segment = &stepramp_queues[axis][(offset & (QUEUE_BYTES - 1)) / QUEUED_SEGMENT_BYTES];
    job_read_segment(index, segment, sizeof *segment);
    segment->step_mask = segment->step_mask != 0 ? engine_step_mask(axis) : 0;
    segment->turn_mask = segment->turn_mask != 0 ? engine_turn_mask(axis) : 0;
    KEEP_ORDER();
    player->head = after;
}

static void fill_line(void)
{
    uint8_t offset = stepramp_line_player.head, after = (uint8_t)(offset + LINE_SEGMENT_BYTES);
    uint16_t index;
    if (after == stepramp_line_player.retired || !next_index(0, &index)) {
        return;
    }
    axis_jobs[0].next++;
    struct line_segment *segment = &stepramp_line_queue[offset / LINE_SEGMENT_BYTES];
    job_read_segment(index, segment, sizeof *segment);
    KEEP_ORDER();
    stepramp_line_player.head = after;
}

static void note_load(uint8_t axis, uint16_t trace)
{
    if (loads[axis] < TRACED) {
        result.traced[axis][loads[axis]++] = trace;
    }
    has_begun = true;
    watched_loads = (uint16_t)(watched_loads + (axis == head.watched_axis));
}

/* Counts a segment as soon as it is loaded; what is left of it is taken off again when it doesn't come. */
static void count_axis(uint8_t axis)
{
    struct axis_player *player = &stepramp_axis_players[axis];
    uint8_t offset = player->retired;
    if (offset == player->tail) {
        return;
    }
    struct queued_segment *segment = &stepramp_queues[axis][(offset & (QUEUE_BYTES - 1)) / QUEUED_SEGMENT_BYTES];
    backward[axis] ^= segment->turn_mask != 0;
    if (segment->step_mask != 0) {
        int32_t steps = (int32_t)segment->count_less_1 + 1;
        result.position[axis] += backward[axis] ? -steps : steps;
    }
    note_load(axis, segment->interval);
    player->retired = (uint8_t)((offset & QUEUE_BYTES) | ((offset + QUEUED_SEGMENT_BYTES) & (QUEUE_BYTES - 1)));
}

static void count_line(void)
{
    uint8_t offset = stepramp_line_player.retired;
    if (offset == stepramp_line_player.tail) {
        return;
    }
    const struct line_segment *segment = &stepramp_line_queue[offset / LINE_SEGMENT_BYTES];
    result.position[0] += (segment->axes & 0x0F) != 0 ? (int32_t)segment->count_less_1 + 1 : 0;
    note_load(0, segment->interval);
    stepramp_line_player.retired = (uint8_t)(offset + LINE_SEGMENT_BYTES);
}

static void serve_queues(void)
{
    if (head.mode == MODE_LINE) {
        count_line();
        fill_line();
        return;
    }
    for (uint8_t axis = 0; axis < lanes; axis++) {
        if (axis_jobs[axis].repeats != 0) {
            count_axis(axis);
            fill_axis(axis);
        }
    }
}

/* After a halt: what of the loaded segment didn't come. */
static void take_off(uint8_t axis)
{
    struct axis_player *player = &stepramp_axis_players[axis];
    struct engine_progress progress = engine_progress(axis);
    while (player->retired != progress.tail) {
        count_axis(axis);
    }
    if (player->step_mask != 0) {
        int32_t left = (int32_t)progress.count_less_1 + 1;
        result.position[axis] -= backward[axis] ? -left : left;
    }
}

static void take_off_line(void)
{
    struct engine_progress progress = engine_progress(0);
    while (stepramp_line_player.retired != progress.tail) {
        count_line();
    }
    result.position[0] -= stepramp_line_player.leader_pins != 0 ? (int32_t)progress.count_less_1 + 1 : 0;
}

static void halt(uint8_t axes)
{
    step_queue_halt(axes);
    job_halted();
    if (head.mode == MODE_LINE) {
        take_off_line();
    }
    for (uint8_t axis = 0; axis < lanes && head.mode != MODE_LINE; axis++) {
        if ((axes & 1 << axis) != 0) {
            take_off(axis);
            axis_jobs[axis].next = axis_jobs[axis].end = axis_jobs[axis].first;
        }
    }
    step_queue_clear(axes);
}

static struct settings default_settings(void)
{
    struct settings settings;
    settings_set_defaults(&settings);
    return settings;
}

static void begin(void)
{
    struct settings settings = default_settings();
    job_read_head(&head);
    settings.outputs = head.mode == MODE_GAUGES ? OUTPUTS_GAUGES : OUTPUTS_STEP_AND_DIRECTION;
    settings.both_edges = head.both_edges;
    settings.step_inverted = head.step_inverted;
    settings.direction_inverted = head.direction_inverted;
    settings.pulse_width_us = head.pulse_width_us;
    step_queue_begin();
    board_configure(&settings);
    step_queue_set_clock(head.fast != 0);
    engine_set_line(head.mode == MODE_LINE);
    lanes = head.mode == MODE_LINE ? 1 : MOST_AXES;
    for (uint8_t axis = 0; axis < lanes; axis++) {
        begin_axis(axis);
    }
    for (uint8_t i = 0; i < QUEUE_SEGMENTS; i++) {
        serve_queues();
    }
}

/* Does what is to be done once in the middle. Returns true when nothing runs any more. */
static bool go_on(void)
{
    if (watched_loads >= head.later_loads && head.later_axes != 0) {
        step_queue_start(head.later_axes, head.setup_ticks);
        head.later_axes = 0;
    }
    if (watched_loads >= head.halt_loads && head.halt_axes != 0) {
        halt(head.halt_axes);
        head.halt_axes = 0;
    }
    return engine_running() == 0 && has_begun;
}

static uint8_t move_bytes(uint8_t next)
{
    if (job_takes_byte(&result.received) || head.is_busy == 0) {
        return next;
    }
    return job_sends_byte(next) ? (uint8_t)(next + 1) : next;
}

int main(int count, char **words)
{
    uint8_t next_byte = 0;
    job_begin(count, words);
    begin();
    step_queue_start(head.first_axes, head.setup_ticks);
    do {
        job_time_passes();
        serve_queues();
        next_byte = move_bytes(next_byte);
    } while (!go_on());
    for (uint8_t i = 0; i < QUEUE_SEGMENTS; i++) {
        serve_queues();
    }
    for (uint8_t axis = 0; axis < MOST_AXES; axis++) {
        result.empty[axis] = engine_progress(axis).empty;
    }
    job_end(&result, sizeof result);
    return 0;
}
