/* The parts of the simulated controller around libsimavr's processor: see avr_host.c. */
#ifndef HOST_H
#define HOST_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include <simavr/sim_avr.h>

#define CLOCK_HZ 16000000ULL

/* ---- chips.c ---- */

enum { MOST_STEP_TIMERS = 4, MOST_CHANNELS = 3, MOST_PINS = 70 };

struct chip {
    const char *name;
    const char *timers; /* those of 16 bits, by their numbers */
    unsigned timer_channels;
    char uart; /* whose line is simulated */
    avr_io_addr_t uart_registers;
    bool has_timer2;
    unsigned response_cycles; /* to an interrupt, and from it */
    int receive_vector;
    int step_vectors[MOST_STEP_TIMERS]; /* the first one that plays steps, of each timer; the other is the next */
    const char *pins;                   /* port and bit of each, in the board's order */
};

extern const struct chip *chip;

/* `timer`: which plays steps. Returns false when there is no such chip or timer. */
bool chip_choose(const char *name, char timer);
int chip_pins(void);
struct port_bit {
    char port;
    int bit;
};
struct port_bit chip_pin(int pin);
int chip_step_vector(void);

/* ---- step_timers.c: the 16-bit timers in normal mode with their compare channels, to the cycle ---- */

void step_timers_attach(avr_t *avr);
void step_timers_reset(void);

/* ---- other_timers.c: Timer0 standing still, Timer2 counting ---- */

void other_timers_attach(avr_t *avr);
void other_timers_reset(void);

/* ---- interrupts.c: what they cost ---- */

struct interrupt_times {
    uint64_t count;
    uint64_t cycles; /* from acceptance to the end of reti, without other interrupts in between; all together */
    uint64_t shortest, longest;
};

void interrupts_attach(avr_t *avr);
void interrupts_reset(void);
/* Begins to count anew. */
void interrupts_forget(void);
struct interrupt_times interrupt_times(int vector);
/* [cycles] of both. */
uint64_t longest_step_interrupt(void);

/* ---- eeprom.c: EEPROM that takes its time, keeps its bytes in a file and can lose power ---- */

/* `file` may be NULL. In the middle of write number `cut_at` (from 1; 0: never) the power fails: the byte is left
 * erased and `on_power_cut` is called. */
bool eeprom_attach(avr_t *avr, const char *file, long cut_at, void (*on_power_cut)(void));
long eeprom_writes(void);

/* ---- serial_line.c: a pseudo-terminal, and bytes at the speed of the line ---- */

/* `link` becomes a symbolic link to the terminal. With a `boot_ms` above 0 opening the terminal counts as a reset. */
bool serial_line_attach(avr_t *avr, const char *link, unsigned boot_ms);
/* Without a terminal: what the processor sends goes to `sent` (may be NULL), and when `is_busy` bytes come in one after the
 * other from when the receiver has been enabled. */
void serial_line_attach_to_file(avr_t *avr, FILE *sent, bool is_busy);
/* Without a terminal: what the processor sends goes to `on_sent`, byte by byte. */
void serial_line_attach_to(avr_t *avr, void (*on_sent)(uint8_t byte));
/* Bytes for the processor: they come in one after the other, the first one when the line has carried it. */
void serial_line_send(const uint8_t *bytes, unsigned count);
/* [cycles] that the line takes for a byte. */
avr_cycle_count_t serial_line_byte_cycles(void);
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

/* Each edge of the board's pins, on an Uno 0 to 13 and A0 to A5, which are 14 to 19, becomes a record of 10 bytes: i64 cycle, i8 pin, i8 value. `file` may be NULL.
 * Pin 1 while the transmitter has it is left out. */
bool edges_attach(avr_t *avr, const char *file);
/* A reset lets go of all pins. */
void edges_reset(void);
void edges_flush(void);
long edges_count(void);
/* Of one pin. */
long edges_of_pin(int pin);
/* When there was one of a step pin, the last time. */
avr_cycle_count_t edges_last_step(void);

/* ---- button.c ---- */

/* `press` as "16:200-300,9:1000.05-1001": pin 16 is connected to ground from 200 to 300 ms, and so on. Returns
 * false when it can't be. */
bool button_attach(avr_t *avr, const char *press);

/* ---- switch.c ---- */

/* `switches` as "9:0<-40,10:0>500": pin 9 is connected to ground while axis 0 is at -40 or below, pin 10 at 500 or above. Returns
 * false when it can't be. */
bool switch_attach(avr_t *avr, const char *switches);
/* Called at each edge of a pin. */
void switch_note_edge(int pin, bool is_high);

/* ---- ground.c ---- */

bool ground_has_pin(unsigned pin);
/* Connects a pin to ground, or lets go of it: then its pull-up has it. */
void ground_pin(avr_t *avr, unsigned pin, bool is_down);

/* ---- conversation.c: requests at moments that are the same each time ---- */

/* `requests` has a line for each frame: "wait quiet pin edges hex". It begins to come in `wait` cycles after the answer to the one
 * before has gone, and no sooner than `quiet` cycles after the last edge of a step pin; but at once when `pin` has had so many `edges`
 * since that answer (0: it is not asked). A request without an answer is given up after 0.2 s. `log` gets a line for each frame, in the
 * order of their ends: "> begin end hex" for what comes in, "< begin end hex" for what has been sent [cycles]. */
bool conversation_attach(avr_t *avr, const char *requests, const char *log);
/* Goes on. Returns false when the last answer has gone. */
bool conversation_goes_on(void);
void conversation_end(void);

#endif
