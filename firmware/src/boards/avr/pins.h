/* Where everything is connected. The step and direction pins are those of the common CNC shield. */
#ifndef STEPRAMP_PINS_H
#define STEPRAMP_PINS_H

/* Port D: axis 0, 1, 2 step on PD2, PD3, PD4 (D2..D4), direction on PD5, PD6, PD7 (D5..D7). */
#define FIRST_STEP_BIT 2
#define FIRST_DIRECTION_BIT 5
#define STEP_PINS_D 0x1C
#define DIRECTION_PINS_D 0xE0

/* Port B: axis 3 steps on PB4 (D12), its direction is PB5 (D13); all drivers are enabled by PB0 (D8). */
#define AXIS_3_STEP_BIT 4
#define AXIS_3_DIRECTION_BIT 5
#define ENABLE_BIT 0

/* Gauges: their coils are D2..D13 in order, so that they take up these bits of the ports. */
#define GAUGE_PINS_D 0xFC
#define GAUGE_PINS_B 0x3F

/* Inputs: PC0 to PC5 (A0 to A5), and PB1 to PB3 (D9 to D11) where no gauges are. */
#define FIRST_INPUT_BIT_B 1
#define INPUT_PINS_B 0x0E

/* Only gauges have D9: as long as it is an output, the pins are coils, and compare B serves all axes. */
#define GAUGE_OUTPUTS ((DDRB & 1 << 1) != 0)

#endif
