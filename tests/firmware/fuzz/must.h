/* What ends the program when something doesn't hold. */
#ifndef STEPRAMP_MUST_H
#define STEPRAMP_MUST_H

#include <stdbool.h>

extern long frame_number;

void must(bool holds, const char *what);

#endif
