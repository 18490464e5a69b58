/* What the hardware must do for the portable part. A port implements these functions; it also calls the player from
 * its timer interrupt (player.h) and moves bytes between its serial port and the controller (controller.h). */
#ifndef STEPRAMP_PORT_H
#define STEPRAMP_PORT_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Sets the direction pin, then begins to serve the player's events; the first one not earlier than 20 us from now. */
void port_start_events(bool forward);

/* From its return on no event is served. May be called at rest. */
void port_stop_events(void);

/* A byte of EEPROM. While one is being written, this waits for it: up to 3.4 ms. */
uint8_t port_eeprom_read(uint16_t address);

/* Begins to write a byte of EEPROM; only when none is being written, and no event can come. */
void port_eeprom_write(uint16_t address, uint8_t value);

/* A byte is being written. */
bool port_eeprom_is_busy(void);

#ifdef __cplusplus
}
#endif

#endif
