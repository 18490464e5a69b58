/* Tables that stay in the program memory: an AVR would copy others into its RAM. */
#ifndef STEPRAMP_IN_FLASH_H
#define STEPRAMP_IN_FLASH_H

#if defined(__FLASH) && !defined(__STRICT_ANSI__)
#define IN_FLASH __flash
#else
#define IN_FLASH
#endif

#endif
