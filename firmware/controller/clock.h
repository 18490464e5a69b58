/* The clock behind board_milliseconds (board.h). */
#ifndef STEPRAMP_CLOCK_H
#define STEPRAMP_CLOCK_H

void clock_begin(void);

#endif
