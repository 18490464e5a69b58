/* The pins as the settings want them. */
#ifdef STEPRAMP_IN_ASSEMBLY

#include <avr/io.h>
#include <util/atomic.h>

#include "boards/avr/enable_pin.h"
#include "boards/avr/gauge.h"
#include "boards/avr/input_pins.h"
#include "boards/avr/pins.h"
#include "boards/avr/step_interrupt.h"
#include "stepramp/edge/board.h"
#include "stepramp/edge/engine.h"
#include "stepramp/edge/step_queue.h"
#include "stepramp/store/driver_settings.h"

/* What the engine's own pulses have, counted in the code [cycles]: 41 of a line and of the only axis of a channel. */
enum { OWN_PULSE_CYCLES = 41, WIDTH_CALL_CYCLES = 19, LISTENING_CALL_CYCLES = 33, WIDTH_UNIT_CYCLES = 8 };
enum { CYCLES_PER_US = F_CPU / 1000000 };

/* The serial port can wait for 8 us; longer waits have room for its interrupts. */
enum { LEAST_LISTENING_CYCLES = 8 * CYCLES_PER_US };

/* In engine.S and line.S */
extern uint8_t stepramp_end_masks[MOST_AXES], stepramp_pulse_masks[MOST_AXES], stepramp_extra_width, stepramp_line_pulse_pins;

static uint8_t both_edges; /* as configured; a bit for each axis */
static uint8_t step_inverted;
static bool enable_active_high;
static enum { AS_BEFORE_THE_RESET, OFF, ON } enabled;

uint8_t engine_step_mask(uint8_t axis)
{
    return axis == 3 ? _BV(AXIS_3_STEP_BIT) : (uint8_t)(1 << (FIRST_STEP_BIT + axis));
}

uint8_t engine_turn_mask(uint8_t axis)
{
    return axis == 3 ? _BV(AXIS_3_DIRECTION_BIT) : (uint8_t)(1 << (FIRST_DIRECTION_BIT + axis));
}

static uint8_t line_pin(uint8_t axis)
{
    return axis == 3 ? _BV(LINE_AXIS_3_BIT) : engine_step_mask(axis);
}

/* A pin gets its level, high unless that is 0, before it becomes an output. */
static void set_pin(uint8_t axis, uint8_t mask, uint8_t level)
{
    ATOMIC_BLOCK(ATOMIC_RESTORESTATE)
    {
        volatile uint8_t *port = axis == 3 ? &PORTB : &PORTD, *data_direction = port - (&PORTB - &DDRB);
        *port = (uint8_t)((*port & ~mask) | (level != 0 ? mask : 0));
        *data_direction |= mask;
    }
}

/* Where each edge is a step, an edge less is a step less: such a pin keeps its level as long as it is one. */
static void configure_axis(uint8_t axis, uint8_t bit, const struct settings *settings)
{
    uint8_t edges = settings->both_edges & bit, level = settings->step_inverted & bit;
    if ((edges & both_edges) == 0 || ((step_inverted & bit) != level)) {
        set_pin(axis, engine_step_mask(axis), level);
    }
    set_pin(axis, engine_turn_mask(axis), (uint8_t)~settings->direction_inverted & bit);
    stepramp_end_masks[axis] = 0;
    stepramp_pulse_masks[axis] = 0;
    if (edges == 0) {
        stepramp_pulse_masks[axis] = 0xFF;
        stepramp_line_pulse_pins |= line_pin(axis);
    }
}

static void configure_width(uint8_t width_us)
{
    int16_t wait = (int16_t)(width_us * CYCLES_PER_US - OWN_PULSE_CYCLES);
    GPIOR0 = 0;
    if (wait > 0) {
        bool listens = wait >= LEAST_LISTENING_CYCLES;
        wait = (int16_t)(wait - (listens ? LISTENING_CALL_CYCLES : WIDTH_CALL_CYCLES));
        stepramp_extra_width = wait > 0 ? (uint8_t)((wait + WIDTH_UNIT_CYCLES - 1) / WIDTH_UNIT_CYCLES) : 1;
        GPIOR0 = listens ? _BV(WIDE) | _BV(LISTENS) : _BV(WIDE);
    }
}

static uint8_t enable_level(bool on)
{
    return on == enable_active_high ? ENABLE_HIGH : ENABLE_LOW;
}

/* After a reset by the watchdog the motors stay as they were before, until somebody has decided. */
static void drive_enable_pin(void)
{
    if (enabled == AS_BEFORE_THE_RESET) {
        enabled = enable_pin_level() == enable_level(true) ? ON : OFF;
    }
    enable_pin_drive(enable_level(enabled == ON));
}

/* Those pins of port B that only gauges use. */
static void release_gauge_pins(void)
{
    uint8_t pins = GAUGE_PINS_B & (uint8_t)~(_BV(AXIS_3_STEP_BIT) | _BV(AXIS_3_DIRECTION_BIT) | _BV(ENABLE_BIT));
    DDRB &= (uint8_t)~pins;
    PORTB &= (uint8_t)~pins;
}

static inline void configure_inputs(const struct settings *settings, bool has_port_b)
{
#if HAS_INPUTS
    inputs_configure(settings, has_port_b);
#else
    (void)settings, (void)has_port_b;
#endif
}

void board_configure(const struct settings *settings)
{
    step_queue_clear(0xFF);
    if (settings->outputs == OUTPUTS_GAUGES) {
        enable_pin_drive(ENABLE_NOT_DRIVEN);
        GPIOR0 = _BV(OTHER_MODE);
        both_edges = 0;
        gauges_configure();
        configure_inputs(settings, false);
        return;
    }
    release_gauge_pins();
    stepramp_line_pulse_pins = 0;
    uint8_t bit = 1;
    for (uint8_t axis = 0; axis < MOST_AXES; axis++, bit = (uint8_t)(bit << 1)) {
        configure_axis(axis, bit, settings);
    }
    both_edges = settings->both_edges;
    step_inverted = settings->step_inverted;
    configure_width(settings->pulse_width_us);
    enable_active_high = (settings->enable_flags & ENABLE_ACTIVE_HIGH) != 0;
    drive_enable_pin();
    configure_inputs(settings, true);
}

void board_enable(bool on)
{
    enabled = on ? ON : OFF;
    if (!GAUGE_OUTPUTS) {
        drive_enable_pin();
    }
}

#endif
