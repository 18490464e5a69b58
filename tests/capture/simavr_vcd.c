/* Writes a VCD file with simavr's own writer. Takes lines of "cycle signal value" at 16 MHz.
 * usage: simavr_vcd FILE NAME... < changes */
#include <stdio.h>
#include <stdlib.h>

#include <simavr/sim_avr.h>
#include <simavr/sim_vcd_file.h>

int main(int count, char **words)
{
    avr_t *avr = avr_make_mcu_by_name("atmega328p");
    avr_init(avr);
    avr->frequency = 16000000;
    avr_vcd_t vcd;
    avr_vcd_init(avr, words[1], &vcd, 1000);
    avr_irq_t *signals = avr_alloc_irq(&avr->irq_pool, 0, (uint32_t)count - 2, NULL);
    for (int i = 0; i < count - 2; i++) {
        avr_vcd_add_signal(&vcd, signals + i, 1, words[i + 2]);
    }
    avr_vcd_start(&vcd);
    unsigned long long cycle;
    int signal;
    unsigned value;
    while (scanf("%llu %d %u", &cycle, &signal, &value) == 3) {
        avr->cycle = cycle;
        avr_cycle_timer_process(avr);
        avr_raise_irq(signals + signal, value);
    }
    avr_vcd_stop(&vcd);
    return 0;
}
