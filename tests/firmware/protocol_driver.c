/* The controller on this machine, behind text. Reads commands, one a line, and answers each with one line. Bytes are
 * written in hexadecimal, `-` for none. A round is as long as a byte of the serial line takes.
 *
 *   frame BYTES           the messages in a stream of bytes
 *   encode BYTES          a message as a frame
 *   crc BYTES             their CRC
 *   settings BYTES        the first bad byte of packed settings, then what they are when unpacked and packed again
 *   begin                 switch the controller on
 *   serial BYTES          bytes to its serial port, and rounds until its line is quiet; what it sends
 *   run ROUNDS [BYTES]    so many rounds, the bytes coming in at the first ones; what it sends, each with its round
 *   poll ROUNDS           so many rounds; what is sent is lost
 *   pass MILLISECONDS     lets so much time pass, in longer rounds; what it sends
 *   eeprom [BYTES]        its EEPROM; or set it
 *   cut WRITE [VALUE]     the EEPROM write, counted from 1, in whose middle the power fails, and what that leaves there
 *   writes                EEPROM writes so far
 *   levels BITS           with inputs: the levels of their pins, a bit each
 *   tap                   with inputs: what has stopped is acknowledged, and meanwhile an emergency stop comes and goes
 *   switch INPUT AXIS BACKWARD AT   with inputs: a switch that pulls its pin down where the axis is there or beyond
 *   late BY               with inputs: the axis that runs is late by so many 256 ticks more
 *   steps                 steps that the pins have shown, of each axis
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "protocol_port.h"
#include "stepramp/edge/engine.h"
#include "stepramp/edge/lateness.h"
#include "stepramp/edge/step_rings.h"
#include "stepramp/motion/machine_inputs.h"
#include "stepramp/protocol/controller.h"
#include "stepramp/store/driver_settings.h"
#include "whole_message.h"

enum { LONGEST_LINE = 16384, MOST_ROUNDS_OF_AN_ANSWER = 4000 };

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
    static uint8_t bytes[LONGEST_LINE];
    struct whole_message message = {{{0}, 0, 0, 0}, {0}};
    size_t count = bytes_of(next_word(), bytes);
    for (size_t i = 0; i < count; i++) {
        uint8_t length = message_receive(&message, bytes[i]);
        if (length != 0) {
            print_bytes(message.bytes, length);
            putchar(' ');
        }
    }
}

static void encode_frame(void)
{
    uint8_t frame[LONGEST_FRAME];
    print_bytes(frame, frame_encode(frame, (uint8_t)bytes_of(next_word(), frame + 1)));
}

static void compute_crc(void)
{
    static uint8_t bytes[LONGEST_LINE];
    size_t count = bytes_of(next_word(), bytes);
    uint16_t crc = CRC16_START;
    for (size_t i = 0; i < count; i++) {
        crc = frame_crc16_update(crc, bytes[i]);
    }
    printf("%u", crc);
}

static void check_settings(void)
{
    uint8_t bytes[SETTINGS_BYTES];
    bytes_of(next_word(), bytes);
    printf("%u ", settings_check(bytes));
    struct settings settings = settings_unpack(bytes);
    settings_pack(&settings, bytes);
    print_bytes(bytes, sizeof bytes);
}

/* A quiet line: nothing has been sent for the time of a few bytes. */
static void serial(void)
{
    static uint8_t bytes[LONGEST_LINE], sent[MOST_ROUNDS_OF_AN_ANSWER + LONGEST_LINE];
    size_t count = bytes_of(next_word(), bytes);
    size_t sent_bytes = port_run(count, bytes, count, sent);
    for (unsigned round = 0, quiet = 0; round < MOST_ROUNDS_OF_AN_ANSWER && quiet < 4; round++) {
        size_t now = port_run(1, NULL, 0, sent + sent_bytes);
        sent_bytes += now;
        quiet = now == 0 ? quiet + 1 : 0;
    }
    print_bytes(sent, sent_bytes);
}

static void run(void)
{
    static uint8_t bytes[LONGEST_LINE];
    unsigned long rounds = next_number();
    size_t count = bytes_of(next_word(), bytes);
    for (unsigned long round = 0; round < rounds; round++) {
        uint8_t sent;
        if (port_run(1, bytes + round, round < count, &sent) != 0) {
            printf("%lu:%02x ", round, sent);
        }
    }
}

/* Bytes that a long round of the main loop has let come. */
static void hand_over(void)
{
    static uint8_t bytes[LONGEST_LINE];
    size_t count = bytes_of(next_word(), bytes);
    for (size_t i = 0; i < count; i++) {
        controller_receive(bytes[i]);
    }
}

static void show_or_set_eeprom(void)
{
    const char *bytes = next_word();
    if (bytes) {
        memset(port_eeprom, EEPROM_ERASED, sizeof port_eeprom);
        bytes_of(bytes, port_eeprom);
        port_eeprom_writes = 0;
        port_cut_write = 0;
    } else {
        print_bytes(port_eeprom, sizeof port_eeprom);
    }
}

static void set_cut(void)
{
    port_cut_write = (long)next_number();
    const char *value = next_word();
    port_cut_value = value ? (int)strtol(value, NULL, 10) : EEPROM_ERASED;
}

#if HAS_INPUTS
static void set_levels(void)
{
    port_levels = (uint16_t)next_number();
    port_look_at_edges();
}

/* As an engine is that has been kept from its events: a running axis goes on later by so much. */
static void be_late(void)
{
    uint8_t late = (uint8_t)next_number();
    stepramp_late = (uint8_t)(stepramp_late + late);
    for (uint8_t axis = 0; axis < MOST_AXES; axis++) {
        if ((engine_running() >> axis & 1) != 0) {
            stepramp_axis_players[axis].due = (uint16_t)(stepramp_axis_players[axis].due + (late << 8));
            return;
        }
    }
}

/* An emergency stop comes and goes while it is acknowledged. */
static void acknowledge_in_a_tap(void)
{
    port_is_tapped = true;
    machine_acknowledge();
}

static void add_switch(void)
{
    struct port_switch *one = &port_switches[port_switch_count++];
    one->input = (uint8_t)next_number();
    one->axis = (uint8_t)next_number();
    one->backward = next_number() != 0;
    one->at = (int32_t)strtol(next_word(), NULL, 10);
}
#endif

static void show_steps(void)
{
    for (int i = 0; i < PORT_AXES; i++) {
        printf("%d ", port_steps[i]);
    }
}

static void show_writes(void)
{
    printf("%ld", port_eeprom_writes);
}

static void poll_rounds(void)
{
    port_run(next_number(), NULL, 0, NULL);
}

static void pass(void)
{
    static uint8_t sent[LONGEST_LINE];
    print_bytes(sent, port_pass(next_number(), sent, sizeof sent));
}

static const struct {
    const char *name;
    void (*obey)(void);
} commands[] = {
    {"frame", decode_frames},       {"encode", encode_frame}, {"crc", compute_crc},    {"settings", check_settings},
    {"begin", port_begin},          {"serial", serial},       {"run", run},            {"poll", poll_rounds},
    {"eeprom", show_or_set_eeprom}, {"cut", set_cut},         {"writes", show_writes}, {"steps", show_steps},
    {"hand", hand_over},            {"pass", pass},
#if HAS_INPUTS
    {"levels", set_levels},         {"switch", add_switch}, {"late", be_late},
    {"tap", acknowledge_in_a_tap},
#endif
};

static bool obey(const char *command)
{
    for (size_t i = 0; i < sizeof commands / sizeof commands[0]; i++) {
        if (strcmp(command, commands[i].name) == 0) {
            commands[i].obey();
            return true;
        }
    }
    return false;
}

int main(void)
{
    static char line[2 * LONGEST_LINE];
    memset(port_eeprom, EEPROM_ERASED, sizeof port_eeprom);
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
