/* Sends frames to the controller, most of them wrong in some way, and watches what it does.
 *
 * usage: fuzz_controller FRAMES SEED IMAGE...   the ramp images in hexadecimal
 *
 * Ends with 0 when all was well, and prints what has been reached. All of it follows from the seed. What must hold:
 *
 *  - a good hello is always answered, soon;
 *  - the ramp in use is one that was stored, or tried, whole; the stored one and the one before it too;
 *  - the positions change only by the steps that the pins show, and by set_position and zero;
 *  - the settings in use are allowed ones;
 *  - with inputs: no step is made between an emergency stop and its acknowledgement;
 *  - a request that comes twice gets the same reply. */
#define _POSIX_C_SOURCE 200809L /* alarm */

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "chance.h"
#include "damage.h"
#include "images.h"
#include "inputs.h"
#include "model.h"
#include "must.h"
#include "protocol_port.h"
#include "requests.h"
#include "stepramp/protocol/message.h"
#include "talk.h"

enum { LONGEST_BURST = 512, HELLO_EVERY = 256, HANG_SECONDS = 30, ALARM_EVERY = 10000 };

static void send_a_frame(void)
{
    uint8_t bytes[LONGEST_BURST];
    size_t count = make_frame(bytes);
    while (one_in(3) && 3 * count < LONGEST_BURST - LONGEST_FRAME) {
        count = damage(bytes, count);
    }
    talk_send(bytes, count);
}

/* After whatever came before. */
static void send_a_good_hello(void)
{
    uint8_t frame[1 + LONGEST_FRAME] = {0, 0, KIND_HELLO, 0, 0, 0, PROTOCOL_VERSION};
    put_u16(frame, 3, 1 + below(0xFFFF));
    frame[5] = ++tag;
    long before = accepted[KIND_HELLO];
    talk_send(frame, 1u + frame_encode(frame + 1, MESSAGE_HEADER_BYTES + 1));
    must(accepted[KIND_HELLO] > before, "a good hello isn't answered");
}

static void print_counts(void)
{
    printf("{\"frames\": %ld", frame_number);
    for (int kind = 0; kind < 0x40; kind++) {
        if (accepted[kind] != 0) {
            printf(", \"%d\": [%ld, %ld]", kind, counts[kind], accepted[kind]);
        }
    }
    printf(", \"steps\": [%d, %d, %d, %d]}\n", port_steps[0], port_steps[1], port_steps[2], port_steps[3]);
}

int main(int count, char **words)
{
    if (count < 4) {
        fprintf(stderr, "usage: fuzz_controller FRAMES SEED IMAGE...\n");
        return 2;
    }
    long frames = strtol(words[1], NULL, 10);
    chance_seed(strtoul(words[2], NULL, 10));
    images_read(words + 3, count - 3);
    memset(port_eeprom, EEPROM_ERASED, sizeof port_eeprom);
    port_eeprom_write_ticks = 1; /* written by the next round */
    port_begin();
    for (frame_number = 0; frame_number < frames; frame_number++) {
        if (frame_number % ALARM_EVERY == 0) {
            alarm(HANG_SECONDS); /* ends the program */
        }
        if (frame_number % HELLO_EVERY == 0) {
            send_a_good_hello();
        }
        inputs_change();
        send_a_frame();
        talk_let_time_pass();
        inputs_check();
        model_check();
    }
    send_a_good_hello();
    print_counts();
    return 0;
}
