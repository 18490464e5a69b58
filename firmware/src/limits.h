/* What this controller can do: the numbers it reports in its hello. */
#ifndef STEPRAMP_LIMITS_H
#define STEPRAMP_LIMITS_H

#define PROTOCOL_VERSION 1
#define FIRMWARE_MAJOR 0
#define FIRMWARE_MINOR 1
#define FIRMWARE_PATCH 0

/* Step timer [Hz]. Given by the port: 16 MHz / 8 on an ATmega328P. All intervals are in ticks of it. */
#define TIMER_FREQUENCY_HZ 2000000ul

/* Shortest interval [ticks]; 40 = 20 us. Must be longer than the longest step interrupt, with time left for the main
 * loop to read the serial port. */
#define SHORTEST_INTERVAL_TICKS 40ul

/* Longest interval [ticks], at most 2^24 - 1: what an interval_t holds (ramp.h). */
#define LONGEST_INTERVAL_TICKS 16777215ul

/* Largest ramp image [bytes], at most 500: a slot of 512 bytes less its header of 12. */
#define LARGEST_IMAGE_BYTES 500u

/* Most segments of a ramp, up and down together, at most 250. Each takes 7 bytes of RAM. */
#define MOST_SEGMENTS 120u

#define AXES 1

#endif
