/* The firmware's machine on this machine, on the engine in C: time passes as it is told to. Reads commands, one a line,
 * and answers each with one line. Bytes are written in hexadecimal, `-` for none; times are in ticks since the start.
 *
 *   check BYTES                 an image: `good AXES RAMPS` or `bad DETAIL`
 *   use BYTES SETTINGS          uses an image and packed settings; what was played is forgotten
 *   round TICKS                 time between two rounds of the main loop
 *   put TICKS                   time that passes while steps are put into a queue, the engine playing meanwhile
 *   stop_comes 0 or 1           whether a stop is always waiting to be read, which ends the main loop's rounds early
 *   move MASK T T T T           `STATUS DETAIL`; also: run MASK I I I I, line MASK RAMP S S S S, zero MASK STEPS
 *   position MASK P P P P       sets positions
 *   stop MASK, halt MASK
 *   wait TICKS                  lets time pass
 *   rest TICKS                  lets time pass until nothing moves, at most so much: `rest TIME` or `moving TIME`
 *   report AXIS                 STATE POSITION TARGET INTERVAL STEPS STARVED
 *   trace AXIS K                traces from the next move on; `traced` gives STEP:VALUE ...
 *   events                      TIME:AXES:BACKWARD ... of the steps since the last time; axes a bit each
 *   enabled                     TIME:ON ... of the enable pin, all of them
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "boards/avr/avr_limits.h"
#include "boards/polled/polled_engine.h"
#include "stepramp/edge/board.h"
#include "stepramp/edge/engine.h"
#include "stepramp/motion/machine.h"
#include "stepramp/protocol/trace.h"
#include "stepramp/store/driver_settings.h"
#include "stepramp/store/ramp_image.h"

enum { LONGEST_LINE = 4096, MOST_EVENTS = 4000000, MOST_NOTES = 100000 };

struct event {
    uint64_t time;
    uint8_t axes, backward;
};

static bool a_stop_comes;
static uint64_t now, ticks_a_round = 100, ticks_a_put, ticks_a_ms = 2000;
static struct event *events;
static size_t event_count;
static uint8_t backward_pins;
static uint8_t image[LARGEST_IMAGE_BYTES];
static struct settings settings;
static char enabled_text[LONGEST_LINE];
static uint8_t traced_axis = 255;
static uint16_t traced_every;
static struct {
    uint32_t step;
    uint16_t value;
} traced[MOST_NOTES];
static size_t traced_count;

/* ---- the port ---- */

void board_configure(const struct settings *used)
{
    (void)used;
    backward_pins = 0;
}

uint8_t engine_step_mask(uint8_t axis)
{
    if (ticks_a_put != 0) {
        now += ticks_a_put;
        polled_engine_play((uint16_t)now);
    }
    return (uint8_t)(1u << axis);
}

uint8_t engine_turn_mask(uint8_t axis)
{
    return (uint8_t)(1u << axis);
}

void board_enable(bool on)
{
    size_t length = strlen(enabled_text);
    snprintf(enabled_text + length, sizeof enabled_text - length, " %llu:%d", (unsigned long long)now, on);
}

uint16_t board_time(void)
{
    return (uint16_t)(now * 1000 / 64 / ticks_a_ms);
}

uint16_t board_milliseconds(void)
{
    return (uint16_t)(now / ticks_a_ms);
}

bool board_has_received(void)
{
    return false;
}

bool board_skip_to_stop(void)
{
    return a_stop_comes;
}

/* ---- the trace ---- */

uint16_t trace_every(uint8_t axis)
{
    return axis == traced_axis ? traced_every : 0;
}

void trace_begin_move(uint8_t axis)
{
    (void)axis;
}

void trace_value(uint8_t axis, uint32_t step, uint16_t value)
{
    if (axis != traced_axis || traced_count == MOST_NOTES) {
        abort();
    }
    traced[traced_count].step = step;
    traced[traced_count++].value = value;
}

void trace_end_move(uint8_t axis)
{
    (void)axis;
}

/* ---- time ---- */

static void on_step(uint8_t axes)
{
    if (event_count == MOST_EVENTS) {
        abort();
    }
    uint16_t late = (uint16_t)((uint16_t)now - engine_now());
    events[event_count++] = (struct event){now - late, axes, backward_pins};
}

static void on_turn(uint8_t axes)
{
    backward_pins ^= axes;
}

static void pass(uint64_t ticks)
{
    for (uint64_t end = now + ticks; now < end;) {
        machine_poll();
        now += ticks_a_round;
        polled_engine_play((uint16_t)now);
    }
}

static bool rest(uint64_t ticks)
{
    for (uint64_t end = now + ticks; now < end && machine_is_moving();) {
        machine_poll();
        now += ticks_a_round;
        polled_engine_play((uint16_t)now);
    }
    return !machine_is_moving();
}

/* ---- commands ---- */

static size_t bytes_of(const char *text, uint8_t *bytes, size_t most)
{
    size_t count = 0;
    unsigned value;
    for (; text != NULL && *text != '-' && count < most && sscanf(text, "%2x", &value) == 1; text += 2) {
        bytes[count++] = (uint8_t)value;
    }
    return count;
}

static void numbers(int32_t values[MOST_AXES])
{
    for (int i = 0; i < MOST_AXES; i++) {
        const char *word = strtok(NULL, " \n");
        values[i] = word == NULL ? 0 : (int32_t)strtoll(word, NULL, 10);
    }
}

static uint8_t number(void)
{
    return (uint8_t)strtoul(strtok(NULL, " \n"), NULL, 10);
}

static void use(void)
{
    size_t length = bytes_of(strtok(NULL, " \n"), image, sizeof image);
    uint8_t packed[SETTINGS_BYTES];
    bytes_of(strtok(NULL, " \n"), packed, sizeof packed);
    settings = settings_unpack(packed);
    machine_use(length == 0 ? NULL : image, &settings);
    ticks_a_ms = length != 0 && ramp_image_is_fast(image) ? 16000 : 2000;
    event_count = 0;
}

/* The values of the axes of a mask, one after the other, as they are asked for. */
static void numbers_of(uint8_t mask, int32_t values[MOST_AXES])
{
    int32_t all[MOST_AXES];
    numbers(all);
    for (uint8_t axis = 0; axis < MOST_AXES; axis++) {
        if ((mask >> axis & 1) != 0) {
            *values++ = all[axis];
        }
    }
}

static void ask_machine(const char *command)
{
    int32_t values[MOST_AXES];
    uint16_t detail = 0;
    uint8_t status = 0, mask = number();
    if (strcmp(command, "move") == 0) {
        numbers_of(mask, values);
        status = machine_move_to(mask, values, &detail);
    } else if (strcmp(command, "run") == 0) {
        numbers_of(mask, values);
        status = machine_run(mask, values, &detail);
    } else if (strcmp(command, "line") == 0) {
        uint8_t ramp = number();
        numbers_of(mask, values);
        status = machine_line(mask, ramp, values, &detail);
    } else {
        status = machine_zero(mask, (uint16_t)strtoul(strtok(NULL, " \n"), NULL, 10), &detail);
    }
    printf("%u %u\n", status, status == 0 ? 0 : detail);
}

static void do_command(const char *command)
{
    int32_t values[MOST_AXES];
    if (strcmp(command, "check") == 0) {
        uint8_t bytes[2 * LARGEST_IMAGE_BYTES];
        size_t length = bytes_of(strtok(NULL, " \n"), bytes, sizeof bytes);
        uint8_t *exact = malloc(length + 1); /* so that the sanitizer sees a read past the end */
        memcpy(exact + 1, bytes, length);
        struct image_check check = ramp_image_check(exact + 1, (uint16_t)length);
        uint8_t axes = check.good ? ramp_image_axes(exact + 1) : 0, ramps = check.good ? ramp_image_ramps(exact + 1) : 0;
        free(exact);
        if (check.good) {
            printf("good %u %u\n", axes, ramps);
        } else {
            printf("bad %u\n", check.bad);
        }
    } else if (strcmp(command, "use") == 0) {
        use();
        printf("ok\n");
    } else if (strcmp(command, "round") == 0) {
        ticks_a_round = strtoull(strtok(NULL, " \n"), NULL, 10);
        printf("ok\n");
    } else if (strcmp(command, "put") == 0) {
        ticks_a_put = strtoull(strtok(NULL, " \n"), NULL, 10);
        printf("ok\n");
    } else if (strcmp(command, "stop_comes") == 0) {
        a_stop_comes = number() != 0;
        printf("ok\n");
    } else if (strcmp(command, "position") == 0) {
        uint8_t mask = number();
        numbers_of(mask, values);
        machine_set_position(mask, values);
        printf("ok\n");
    } else if (strcmp(command, "stop") == 0) {
        machine_stop(number());
        printf("ok\n");
    } else if (strcmp(command, "halt") == 0) {
        machine_halt(number());
        printf("ok\n");
    } else if (strcmp(command, "wait") == 0) {
        pass(strtoull(strtok(NULL, " \n"), NULL, 10));
        printf("ok\n");
    } else if (strcmp(command, "rest") == 0) {
        bool is_at_rest = rest(strtoull(strtok(NULL, " \n"), NULL, 10));
        printf("%s %llu\n", is_at_rest ? "rest" : "moving", (unsigned long long)now);
    } else if (strcmp(command, "report") == 0) {
        uint8_t axis = number();
        struct axis_report report = machine_report(axis);
        printf("%u %ld %ld %lu %lu %u\n", report.state, (long)report.position, (long)machine_target(axis),
               (unsigned long)machine_interval(axis), (unsigned long)report.steps_made, machine_starved());
    } else if (strcmp(command, "trace") == 0) {
        traced_axis = number();
        traced_every = (uint16_t)strtoul(strtok(NULL, " \n"), NULL, 10);
        traced_count = 0;
        printf("ok\n");
    } else {
        ask_machine(command);
    }
}

static void list(const char *command)
{
    if (strcmp(command, "events") == 0) {
        for (size_t i = 0; i < event_count; i++) {
            printf("%llu:%u:%u ", (unsigned long long)events[i].time, events[i].axes, events[i].backward);
        }
        event_count = 0;
    } else if (strcmp(command, "traced") == 0) {
        for (size_t i = 0; i < traced_count; i++) {
            printf("%lu:%u ", (unsigned long)traced[i].step, traced[i].value);
        }
    } else {
        printf("%s ", enabled_text);
    }
    printf(".\n");
}

int main(void)
{
    static char line[LONGEST_LINE];
    events = malloc(MOST_EVENTS * sizeof *events);
    settings_set_defaults(&settings);
    machine_begin();
    polled_engine_set_outputs(on_step, on_turn);
    machine_use(NULL, &settings);
    while (fgets(line, sizeof line, stdin) != NULL) {
        const char *command = strtok(line, " \n");
        if (strcmp(command, "events") == 0 || strcmp(command, "traced") == 0 || strcmp(command, "enabled") == 0) {
            list(command);
        } else {
            do_command(command);
        }
        fflush(stdout);
    }
    free(events);
    return 0;
}
