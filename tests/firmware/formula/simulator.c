/* usage: simulator program.elf request reply length
 *
 * Hands requests to driver.c in a simulated ATmega328P: reads them as the driver does on this machine, and writes its
 * replies, each followed by the cycles that the call took. The last three arguments are addresses in its memory. */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include <simavr/sim_avr.h>
#include <simavr/sim_elf.h>

enum { GPIOR0 = 0x3E };

static avr_t *avr;
static elf_firmware_t firmware;
static avr_cycle_count_t cycles;

/* Runs until the program has set the length of its reply. */
static uint8_t run(unsigned length_at)
{
    avr_cycle_count_t began = 0;
    uint8_t was = 0;
    while (avr->data[length_at] == 0) {
        if (avr_run(avr) == cpu_Crashed) {
            exit(EXIT_FAILURE);
        }
        uint8_t is = avr->data[GPIOR0];
        if (is != was && is) {
            began = avr->cycle;
        } else if (is != was) {
            /* the instruction that ends it takes one cycle */
            cycles = avr->cycle - began - 1;
        }
        was = is;
    }
    return (uint8_t)(avr->data[length_at] - 1);
}

int main(int argc, char **argv)
{
    /* simavr prints what it loads */
    FILE *replies = fdopen(dup(STDOUT_FILENO), "wb");
    dup2(STDERR_FILENO, STDOUT_FILENO);
    if (argc != 5 || !replies || elf_read_firmware(argv[1], &firmware)) {
        return EXIT_FAILURE;
    }
    avr = avr_make_mcu_by_name("atmega328p");
    avr_init(avr);
    avr->log = LOG_ERROR;
    avr_load_firmware(avr, &firmware);
    unsigned request_at = (unsigned)strtoul(argv[2], NULL, 16) & 0xFFFF;
    unsigned reply_at = (unsigned)strtoul(argv[3], NULL, 16) & 0xFFFF;
    unsigned length_at = (unsigned)strtoul(argv[4], NULL, 16) & 0xFFFF;
    run(length_at);
    for (int size; (size = getchar()) != EOF;) {
        if (fread(avr->data + request_at, 1, (size_t)size, stdin) != (size_t)size) {
            return EXIT_FAILURE;
        }
        avr->data[length_at] = 0;
        cycles = 0;
        uint8_t length = run(length_at);
        putc(length, replies);
        fwrite(avr->data + reply_at, 1, length, replies);
        uint32_t taken = (uint32_t)cycles;
        fwrite(&taken, sizeof taken, 1, replies);
        fflush(replies);
    }
    return EXIT_SUCCESS;
}
