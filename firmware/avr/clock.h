/* The clock behind port_milliseconds (port.h). */
#ifndef STEPRAMP_CLOCK_H
#define STEPRAMP_CLOCK_H

void clock_begin(void);

#endif
