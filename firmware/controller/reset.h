/* The watchdog, and what tells its reset from others behind a boot loader that doesn't. */
#ifndef STEPRAMP_RESET_H
#define STEPRAMP_RESET_H

/* Begins to watch: who doesn't come round for 0.12 s is interrupted, which notes it, and is reset after as long again.
 * Built without the watchdog it does nothing: then who hangs stays so, and makes no step. */
void watchdog_begin(void);

/* Notes that the next reset is the watchdog's: for who waits for it with interrupts disabled. */
void note_watchdog_reset(void);

#endif
