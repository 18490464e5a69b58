/* The stream of reports: positions and intervals of all axes, so many times a second. */
#ifndef STEPRAMP_REPORT_H
#define STEPRAMP_REPORT_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Reports so many times a second from now on, up to 50; 0: no more. */
void report_start(uint8_t rate_hz, uint16_t now_ms);

/* Goes on, by a little, with the next report when it is time for one and the line has room. Returns true when it has. */
bool report_poll(uint16_t session, uint16_t now_ms);

#ifdef __cplusplus
}
#endif

#endif
