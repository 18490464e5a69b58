/* The inputs of a controller that has some. */
#ifndef FUZZ_INPUTS_H
#define FUZZ_INPUTS_H

/* Now and then something is pressed, or let go of. */
void inputs_change(void);

/* No step has been made since an emergency stop that has not been acknowledged. */
void inputs_check(void);

#endif
