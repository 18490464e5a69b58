/* A function that takes less room where it is called than in its place, though the compiler thinks otherwise: in a sketch it would put
 * nearly all into loop(). */
#ifndef STEPRAMP_OUT_OF_LINE_H
#define STEPRAMP_OUT_OF_LINE_H

#ifdef __GNUC__
#define OUT_OF_LINE __attribute__((noinline))
#else
#define OUT_OF_LINE
#endif

#endif
