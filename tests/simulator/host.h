/* The parts of the simulated controller around libsimavr's processor: see avr_host.c. */
#ifndef HOST_H
#define HOST_H

#include <stdbool.h>
#include <stdint.h>

#include <simavr/sim_avr.h>

#define CLOCK_HZ 16000000ULL

/* ---- timer1.c: Timer1 in normal mode with compare A, to the cycle ---- */

void timer1_attach(avr_t *avr);
/* To be called after each reset of the processor. */
void timer1_reset(void);
/* [cycles] from the acceptance of the longest compare A interrupt to the end of its reti. */
uint64_t timer1_longest_interrupt(void);

/* ---- eeprom.c: EEPROM that takes its time, keeps its bytes in a file and can lose power ---- */

/* `file` may be NULL. In the middle of write number `cut_at` (from 1; 0: never) the power fails: the byte is left
 * erased and `on_power_cut` is called. */
bool eeprom_attach(avr_t *avr, const char *file, long cut_at, void (*on_power_cut)(void));
long eeprom_writes(void);

/* ---- serial_line.c: a pseudo-terminal, and bytes at the speed of the line ---- */

/* `link` becomes a symbolic link to the terminal. With a `boot_ms` above 0 opening the terminal counts as a reset. */
bool serial_line_attach(avr_t *avr, const char *link, unsigned boot_ms);
/* Moves bytes between the terminal and the line. Returns true when the terminal has just been opened, with boot_ms. */
bool serial_line_poll(void);
/* What arrives before this cycle is lost: the boot loader eats it. */
void serial_line_deaf_until(avr_cycle_count_t cycle);
/* Forgets the byte on its way after a reset of the processor. */
void serial_line_reset(void);
void serial_line_detach(void);
struct serial_counts {
    long received; /* bytes that reached the processor */
    long lost;     /* of them those that it didn't fetch in time */
    long sent;
    avr_cycle_count_t longest_answer; /* [cycles] from the zero that ends a frame to the first byte sent after it */
};
struct serial_counts serial_line_counts(void);

/* ---- edges.c: a log of the pins ---- */

/* Each edge of Arduino pins 0 to 13 becomes a record of 10 bytes: i64 cycle, i8 pin, i8 value. `file` may be NULL. */
bool edges_attach(avr_t *avr, const char *file);
/* A reset lets go of all pins. */
void edges_reset(void);
void edges_flush(void);
long edges_count(void);

#endif
