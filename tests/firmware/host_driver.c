/* The portable part of the firmware on this machine, with EEPROM and timer made of variables. Reads commands, one a
 * line, and answers each with one line. Bytes are written in hexadecimal, `-` for none.
 *
 *   frame BYTES            the messages in a stream of bytes
 *   encode BYTES           a message as a frame
 *   image BYTES            `bad SEGMENT`, or the ramp: slew interval, up segments / down segments as first:count:add
 *   plan BYTES STEPS       intervals of up, slew and down of a move
 *   play BYTES STEPS POLLS [stop|hold|halt EVENT]   the intervals of a move, with so many rounds of the main loop after
 *                          each event; hold is a stop with one round at once
 *   begin                  start the controller
 *   serial BYTES           bytes to its serial port; what it answers
 *   poll ROUNDS            rounds of its main loop
 *   eeprom [BYTES]         its EEPROM; or set it
 *   cut WRITE              the EEPROM write, counted from 1, from which on no write is done, and that one only erased
 *   writes                 EEPROM writes so far
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "controller.h"
#include "frame.h"
#include "plan.h"
#include "player.h"
#include "port.h"
#include "ramp_image.h"

enum { LONGEST_LINE = 8192, EEPROM_BYTES = 1024, ERASED = 0xFF, BUSY_ROUNDS = 2 };

static uint8_t eeprom[EEPROM_BYTES];
static long writes, cut_write;
static unsigned busy_rounds;
static bool events_are_served;
static struct ramp ramp;

/* ---- the port ---- */

void port_start_events(bool forward)
{
    (void)forward;
    events_are_served = true;
}

void port_stop_events(void)
{
    events_are_served = false;
}

uint8_t port_eeprom_read(uint16_t address)
{
    busy_rounds = 0;
    return eeprom[address];
}

void port_eeprom_write(uint16_t address, uint8_t value)
{
    if (port_eeprom_is_busy() || events_are_served) {
        fprintf(stderr, "EEPROM written while busy or moving\n");
        abort();
    }
    writes++;
    if (cut_write == 0 || writes < cut_write) {
        eeprom[address] = value;
        busy_rounds = BUSY_ROUNDS;
    } else if (writes == cut_write) {
        eeprom[address] = ERASED;
    }
}

bool port_eeprom_is_busy(void)
{
    return busy_rounds != 0;
}

/* ---- text ---- */

static size_t bytes_of(const char *text, uint8_t *bytes)
{
    size_t count = 0;
    unsigned value;
    for (; text && *text != '-' && sscanf(text + 2 * count, "%2x", &value) == 1; count++) {
        bytes[count] = (uint8_t)value;
    }
    return count;
}

static void print_bytes(const uint8_t *bytes, size_t count)
{
    if (count == 0) {
        putchar('-');
    }
    for (size_t i = 0; i < count; i++) {
        printf("%02x", bytes[i]);
    }
}

static char *next_word(void)
{
    return strtok(NULL, " \n");
}

static unsigned long next_number(void)
{
    return strtoul(next_word(), NULL, 10);
}

/* ---- commands ---- */

static void decode_frames(void)
{
    uint8_t bytes[LONGEST_LINE];
    struct frame_receiver receiver = {{0}, 0, 0, false, false, 0};
    size_t count = bytes_of(next_word(), bytes);
    for (size_t i = 0; i < count; i++) {
        uint8_t length = frame_receive(&receiver, bytes[i]);
        if (length != 0) {
            print_bytes(receiver.bytes, length);
            putchar(' ');
        }
    }
}

static void encode_frame(void)
{
    uint8_t frame[LONGEST_FRAME];
    print_bytes(frame, frame_encode(frame, (uint8_t)bytes_of(next_word(), frame + 1)));
}

/* Unpacks an image into `ramp`. The copy has no byte to spare, so that the sanitizer sees a read beyond its end. */
static struct image_check unpack(const char *text)
{
    uint8_t bytes[LONGEST_LINE];
    size_t count = bytes_of(text, bytes);
    uint8_t *image = malloc(count ? count : 1);
    memcpy(image, bytes, count);
    struct image_check check = ramp_image_check(image, (uint16_t)count);
    if (check.good) {
        struct image_reader reader;
        ramp_image_begin_unpacking(&reader, image, (uint16_t)count, &ramp);
        while (ramp_image_unpack_segment(&reader, &ramp)) {
        }
    }
    free(image);
    return check;
}

static void print_list(const struct segment_list *list)
{
    uint32_t next = 0;
    for (uint8_t i = 0; i < list->length; i++) {
        const struct segment *segment = &list->segments[i];
        uint32_t first = next + segment->change;
        printf(" %u:%u:%d", first, segment->count, segment->add);
        next = segment_interval(first, segment, segment->count);
    }
}

static void show_image(void)
{
    struct image_check check = unpack(next_word());
    if (!check.good) {
        printf("bad %u", check.bad_segment);
        return;
    }
    printf("%u", ramp.slew_interval);
    print_list(&ramp.up);
    printf(" /");
    print_list(&ramp.down);
}

static void plan_a_move(void)
{
    struct plan plan;
    unpack(next_word());
    plan_move(&ramp, (uint32_t)next_number(), &plan);
    printf("%u %u %u", plan.up.steps, plan.slew_steps, plan.down.steps);
}

static void act(const char *action)
{
    if (strcmp(action, "halt") == 0) {
        player_halt();
    } else {
        player_stop();
    }
    if (strcmp(action, "hold") == 0) {
        player_poll();
    }
}

/* Prints the interval after each pulse. A move that is halted ends with the pulse before. */
static void play_a_move(void)
{
    unpack(next_word());
    uint32_t steps = (uint32_t)next_number();
    unsigned long polls = next_number();
    const char *action = next_word();
    unsigned long action_at = action ? next_number() : 0;
    int32_t began_at = player_report().position;
    unsigned long interval = 0;
    player_move(&ramp, steps, true);
    for (unsigned long event = 0; player_is_moving(); event++) {
        if (action && event == action_at) {
            act(action);
            if (!player_is_moving()) {
                break;
            }
        }
        if (player_pulse_is_due() && event != 0) {
            printf("%lu ", interval);
            interval = 0;
        }
        interval += player_event();
        for (unsigned long i = 0; i < polls; i++) {
            player_poll();
        }
    }
    struct motor_report report = player_report();
    printf("%lu position %d target %d made %u", interval, report.position - began_at, report.target - began_at,
           report.steps_made);
}

static void serial(void)
{
    uint8_t bytes[LONGEST_LINE], answer[LONGEST_LINE];
    size_t count = bytes_of(next_word(), bytes), answered = 0;
    for (size_t i = 0; i < count; i++) {
        controller_receive(bytes[i]);
        while (controller_next_byte(&answer[answered])) {
            answered++;
        }
    }
    print_bytes(answer, answered);
}

static void poll_controller(void)
{
    for (unsigned long rounds = next_number(); rounds != 0; rounds--) {
        controller_poll();
        busy_rounds -= busy_rounds != 0;
    }
}

static void show_or_set_eeprom(void)
{
    const char *bytes = next_word();
    if (bytes) {
        memset(eeprom, ERASED, sizeof eeprom);
        bytes_of(bytes, eeprom);
        writes = 0;
        cut_write = 0;
    } else {
        print_bytes(eeprom, sizeof eeprom);
    }
}

static bool obey(const char *command)
{
    if (strcmp(command, "frame") == 0) {
        decode_frames();
    } else if (strcmp(command, "encode") == 0) {
        encode_frame();
    } else if (strcmp(command, "image") == 0) {
        show_image();
    } else if (strcmp(command, "plan") == 0) {
        plan_a_move();
    } else if (strcmp(command, "play") == 0) {
        play_a_move();
    } else if (strcmp(command, "begin") == 0) {
        controller_begin();
    } else if (strcmp(command, "serial") == 0) {
        serial();
    } else if (strcmp(command, "poll") == 0) {
        poll_controller();
    } else if (strcmp(command, "eeprom") == 0) {
        show_or_set_eeprom();
    } else if (strcmp(command, "cut") == 0) {
        cut_write = (long)next_number();
    } else if (strcmp(command, "writes") == 0) {
        printf("%ld", writes);
    } else {
        return false;
    }
    return true;
}

int main(void)
{
    static char line[LONGEST_LINE];
    memset(eeprom, ERASED, sizeof eeprom);
    while (fgets(line, sizeof line, stdin)) {
        if (!obey(strtok(line, " \n"))) {
            fprintf(stderr, "unknown command\n");
            return 2;
        }
        putchar('\n');
        fflush(stdout);
    }
    return 0;
}
