/* play_job.c on this machine: play_job_host JOB. Prints `step TICK AXES`, `turn TICK AXES` and `result BYTES`. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "boards/polled/polled_engine.h"
#include "play_job.h"
#include "stepramp/edge/board.h"
#include "stepramp/edge/engine.h"

static uint8_t job[65536];
static uint64_t now; /* [ticks] the engine's timer, which doesn't run over */

static uint64_t event_time(void)
{
    return now - (uint16_t)((uint16_t)now - engine_now());
}

static void on_step(uint8_t axes)
{
    printf("step %llu %u\n", (unsigned long long)event_time(), axes);
}

static void on_turn(uint8_t axes)
{
    printf("turn %llu %u\n", (unsigned long long)event_time(), axes);
}

void job_begin(int count, char **words)
{
    FILE *file = count == 2 ? fopen(words[1], "rb") : NULL;
    if (!file || fread(job, 1, sizeof job, file) < sizeof(struct job_head)) {
        exit(2);
    }
    fclose(file);
    polled_engine_set_outputs(on_step, on_turn);
}

void job_read_head(struct job_head *head)
{
    memcpy(head, job, sizeof *head);
}

void job_read_segment(uint16_t index, void *segment, uint8_t size)
{
    memcpy(segment, job + sizeof(struct job_head) + (size_t)index * size, size);
}

void job_time_passes(void)
{
    now += polled_engine_play((uint16_t)now);
    polled_engine_play((uint16_t)now);
}

void job_halted(void)
{
}

bool job_takes_byte(uint16_t *count)
{
    (void)count;
    return false;
}

bool job_sends_byte(uint8_t byte)
{
    (void)byte;
    return false;
}

void job_end(const void *result, size_t size)
{
    printf("result ");
    for (size_t i = 0; i < size; i++) {
        printf("%02x", ((const uint8_t *)result)[i]);
    }
    printf("\n");
}

void board_configure(const struct settings *settings)
{
    (void)settings;
}

uint8_t engine_step_mask(uint8_t axis)
{
    return (uint8_t)(1 << axis);
}

uint8_t engine_turn_mask(uint8_t axis)
{
    return (uint8_t)(1 << axis);
}
