/* Charges the four or five cycles that the processor takes to accept an interrupt, which simavr doesn't, and counts what
 * interrupts take: from acceptance to the end of reti. */
#include <string.h>

#include <simavr/sim_interrupts.h>
#include <simavr/sim_irq.h>

#include "host.h"

enum { VECTORS = 64, DEEPEST = 8 };

static avr_t *avr;
static struct interrupt_times times[VECTORS];
static struct running {
    avr_cycle_count_t began;
    uint64_t of_others; /* what interrupts of this one took */
} stack[DEEPEST];
static int depth;

static void begin(void)
{
    if (depth < DEEPEST) {
        stack[depth++] = (struct running){avr->cycle, 0};
    }
    avr->cycle += chip->response_cycles;
}

static void end(struct interrupt_times *of)
{
    if (depth == 0) {
        return;
    }
    struct running *ended = &stack[--depth];
    uint64_t whole = avr->cycle + chip->response_cycles - ended->began;
    uint64_t own = whole - ended->of_others;
    if (depth > 0) {
        stack[depth - 1].of_others += whole;
    }
    of->count++;
    of->cycles += own;
    of->longest = own > of->longest ? own : of->longest;
    of->shortest = of->shortest == 0 || own < of->shortest ? own : of->shortest;
}

static void on_running(avr_irq_t *irq, uint32_t is_running, void *of)
{
    (void)irq;
    if (is_running) {
        begin();
    } else {
        end(of);
    }
}

void interrupts_attach(avr_t *mcu)
{
    avr = mcu;
    for (int i = 0; i < avr->interrupts.vector_count; i++) {
        avr_int_vector_t *vector = avr->interrupts.vector[i];
        avr_irq_register_notify(vector->irq + AVR_INT_IRQ_RUNNING, on_running, &times[vector->vector % VECTORS]);
    }
}

void interrupts_reset(void)
{
    depth = 0;
}

void interrupts_forget(void)
{
    memset(times, 0, sizeof times);
}

struct interrupt_times interrupt_times(int vector)
{
    return times[vector];
}

uint64_t longest_step_interrupt(void)
{
    uint64_t a = times[chip_step_vector()].longest, b = times[chip_step_vector() + 1].longest;
    return a > b ? a : b;
}
