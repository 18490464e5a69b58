/* A client that asks at moments which are the same each time, to the cycle: no terminal and no clock is between it and the
 * processor. See host.h for its files. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "host.h"

enum { LONGEST_LINE = 512, LONGEST_FRAME_BYTES = 128, FIRST_REPLY = 0x80, FIRST_NOTICE = 0xC0, KIND_AT = 1 };
enum { BYTES_IN_TRANSMITTER = 2 };
#define GIVE_UP_CYCLES (CLOCK_HZ / 5)
#define BEGIN_CYCLES (CLOCK_HZ / 50)

struct request {
    avr_cycle_count_t wait, quiet;
    int pin;
    long edges;
    uint8_t frame[LONGEST_FRAME_BYTES];
    unsigned length;
};

static avr_t *avr;
static FILE *requests_file, *log_file;
static struct request next;
static enum { WAITING, ASKED, OVER } state;
static avr_cycle_count_t from;  /* when the last answer had gone */
static avr_cycle_count_t asked; /* when the last request began to come in */
static long edges_before;       /* of the next request's pin */

/* What the processor is sending. */
static uint8_t sent[LONGEST_FRAME_BYTES];
static unsigned sent_count;
static avr_cycle_count_t sent_from;

static void write_log(char direction, avr_cycle_count_t begin, avr_cycle_count_t end, const uint8_t *bytes, unsigned count)
{
    fprintf(log_file, "%c %" PRIu64 " %" PRIu64 " ", direction, (uint64_t)begin, (uint64_t)end);
    for (unsigned i = 0; i < count; i++) {
        fprintf(log_file, "%02x", bytes[i]);
    }
    fputc('\n', log_file);
}

static bool read_hex(const char *hex, struct request *request)
{
    request->length = 0;
    unsigned byte;
    for (; sscanf(hex, "%2x", &byte) == 1 && request->length < LONGEST_FRAME_BYTES; hex += 2) {
        request->frame[request->length++] = (uint8_t)byte;
    }
    return request->length > 0;
}

static void read_next(void)
{
    char line[LONGEST_LINE], hex[2 * LONGEST_FRAME_BYTES + 1];
    uint64_t wait, quiet;
    bool is_there = fgets(line, sizeof line, requests_file) &&
                    sscanf(line, "%" SCNu64 " %" SCNu64 " %d %ld %256s", &wait, &quiet, &next.pin, &next.edges, hex) == 5 &&
                    read_hex(hex, &next);
    state = is_there ? WAITING : OVER;
    if (is_there) {
        next.wait = wait;
        next.quiet = quiet;
        edges_before = edges_of_pin(next.pin);
    }
}

/* The last byte may still be in the transmitter, behind another one. */
static void on_sent(uint8_t byte)
{
    if (sent_count == 0) {
        sent_from = avr->cycle;
    }
    if (sent_count < LONGEST_FRAME_BYTES) {
        sent[sent_count++] = byte;
    }
    if (byte != 0) {
        return;
    }
    write_log('<', sent_from, avr->cycle, sent, sent_count);
    if (state == ASKED && sent[KIND_AT] >= FIRST_REPLY && sent[KIND_AT] < FIRST_NOTICE) {
        from = avr->cycle + BYTES_IN_TRANSMITTER * serial_line_byte_cycles();
        read_next();
    }
    sent_count = 0;
}

bool conversation_attach(avr_t *mcu, const char *requests, const char *log)
{
    avr = mcu;
    requests_file = fopen(requests, "r");
    log_file = fopen(log, "w");
    if (!requests_file || !log_file) {
        perror(requests_file ? log : requests);
        return false;
    }
    serial_line_attach_to(avr, on_sent);
    from = BEGIN_CYCLES;
    read_next();
    return true;
}

static bool is_due(void)
{
    avr_cycle_count_t now = avr->cycle;
    if (next.edges != 0 && edges_of_pin(next.pin) - edges_before >= next.edges && now >= from) {
        return true;
    }
    return now >= from + next.wait && now >= edges_last_step() + next.quiet;
}

static void ask(void)
{
    asked = avr->cycle;
    avr_cycle_count_t end = asked + next.length * serial_line_byte_cycles();
    write_log('>', asked, end, next.frame, next.length);
    serial_line_send(next.frame, next.length);
    state = ASKED;
}

bool conversation_goes_on(void)
{
    if (state == WAITING && is_due()) {
        ask();
    } else if (state == ASKED && avr->cycle >= asked + GIVE_UP_CYCLES) {
        from = avr->cycle;
        read_next();
    }
    return state != OVER;
}

void conversation_end(void)
{
    if (log_file) {
        fclose(log_file);
    }
}
