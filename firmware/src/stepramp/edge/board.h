/* What a board must do for the portable part, besides the step queue (step_queue.h). It also hands the controller the bytes
 * that come in (controller.h). */
#ifndef STEPRAMP_BOARD_H
#define STEPRAMP_BOARD_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

struct settings; /* driver_settings.h */

/* At rest, and not on a line; empties the queues. The pins take their resting levels: every direction is forward
 * then, step pins are inactive. A step pin of which each edge is a step stays as it is when it was one before. Gauges
 * stay where they are. */
void board_configure(const struct settings *settings);

/* The enable pin of all drivers. Gauges have none. After a reset by the watchdog it stays as it was until the first
 * call, so that no motor coasts. */
void board_enable(bool on);

/* Two clocks that count up and over [64 us], [ms]. To be called at least every 10 ms. */
uint16_t board_time(void);
uint16_t board_milliseconds(void);

/* Bytes wait to be handed to the controller. */
bool board_has_received(void);

/* A stop or halt has been received last. What has been received before it is dropped, but for the zero byte that ends it: at
 * busy times a stop would wait until all of that has been looked at. A board may hand over all in turn: false. */
bool board_skip_to_stop(void);

/* Sends a frame: up to its zero byte, the only one. It must stay as it is until then. Only when none is on its way. */
void board_send(const uint8_t *frame);

/* A frame is on its way. */
bool board_is_sending(void);

/* Ends the frame that is on its way: a zero byte takes the place of its rest, which is not looked at any more. Whoever
 * receives it will find it damaged. */
void board_cut_frame(void);

/* Why the processor began: bits of enum reset_cause. */
uint8_t board_reset_cause(void);
enum reset_cause { RESET_POWER_ON = 1, RESET_EXTERNAL = 2, RESET_BROWN_OUT = 4, RESET_WATCHDOG = 8 };

/* A byte of EEPROM. While one is being written, this waits for it: up to 3.4 ms. */
uint8_t board_eeprom_read(uint16_t address);

/* Begins to write a byte of EEPROM; only when none is being written. */
void board_eeprom_write(uint16_t address, uint8_t value);

/* A byte is being written. */
bool board_eeprom_is_busy(void);

#ifdef __cplusplus
}
#endif

#endif
