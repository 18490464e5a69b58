/* What play_job.c needs of the machine it runs on: play_job_chip.c and play_job_host.c. */
#ifndef PLAY_JOB_H
#define PLAY_JOB_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "stepramp/edge/step_rings.h"

enum mode { MODE_AXES = 0, MODE_LINE = 1, MODE_GAUGES = 2 };

/* A job begins with this; then come its segments, of 8 bytes, or 16 on a line. */
struct job_head {
    uint8_t fast, mode, both_edges, step_inverted, direction_inverted, pulse_width_us;
    uint16_t setup_ticks;
    uint8_t first_axes;
    uint8_t later_axes; /* started when the watched axis has loaded so many segments */
    uint16_t later_loads;
    uint8_t watched_axis;
    uint8_t halt_axes; /* likewise halted */
    uint16_t halt_loads;
    uint8_t is_busy; /* sends bytes all the time */
    uint8_t unused;
    struct {
        uint16_t first, count, repeats;
    } axes[MOST_AXES];
};

/* All writes before it are done before those after it. */
#define KEEP_ORDER() __asm__ volatile("" ::: "memory")

void job_begin(int count, char **words);
void job_read_head(struct job_head *head);
void job_read_segment(uint16_t index, void *segment, uint8_t size);

/* Called in each round of the main loop. */
void job_time_passes(void);

/* Called when axes have been halted. */
void job_halted(void);

/* Takes a byte that has come and counts it. Returns false when there is none. */
bool job_takes_byte(uint16_t *count);
bool job_sends_byte(uint8_t byte);

void job_end(const void *result, size_t size);

#endif
