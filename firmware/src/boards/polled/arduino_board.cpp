#include "boards/polled/arduino_board.h"

#include <Arduino.h>

#include "boards/polled/arduino_limits.h"
#include "boards/polled/polled_engine.h"
#include "boards/polled/replaceable.h"
#include "stepramp/edge/board.h"
#include "stepramp/edge/engine.h"
#include "stepramp/edge/step_queue.h"
#include "stepramp/store/driver_settings.h"

struct arduino_pins stepramp_pins = {{NO_PIN, NO_PIN, NO_PIN, NO_PIN},
                                    {NO_PIN, NO_PIN, NO_PIN, NO_PIN},
                                    NO_PIN,
                                    {NO_PIN, NO_PIN, NO_PIN, NO_PIN, NO_PIN, NO_PIN, NO_PIN, NO_PIN, NO_PIN},
                                    {{NO_PIN, NO_PIN, NO_PIN, NO_PIN},
                                     {NO_PIN, NO_PIN, NO_PIN, NO_PIN},
                                     {NO_PIN, NO_PIN, NO_PIN, NO_PIN}}};

namespace {

/* Fast ticks a microsecond and a slow tick, and 64 us, as powers of 2. */
enum { US_BITS = 4, SLOW_TICK_BITS = 3, TIME_BITS = 10 };

/* micros() may go in steps of so much. */
enum { CLOCK_GRAIN_US = 4 };

/* Pins are 0 to less than this. Cores for other chips number theirs as they like. */
#ifdef __AVR__
enum { PINS_OF_BOARD = NUM_DIGITAL_PINS };
#else
enum { PINS_OF_BOARD = NO_PIN };
#endif

/* One turn of a gauge rotor's magnet has six states; these are their coils, the first pin in bit 0. */
enum { STATES = 6 };

bool is_playing;
uint32_t looked_us;      /* micros() at the last look */
uint32_t time_ticks;     /* fast ticks of the engine's time, which stands still when steps are late */
uint16_t engine_ticks;   /* that in ticks of the present clock, modulo 2^16 */
uint16_t wait_ticks;     /* to the next event */
uint32_t delayed_ticks;  /* fast ticks */
uint32_t delayed_us;     /* and whole microseconds */

/* ---- pins ---- */

struct gauge_functions {
    void (*begin)();
    void (*step)(uint8_t gauge, bool is_backward);
    void (*release)();
};

const struct gauge_functions *gauges; /* none before arduino_use_gauges() */
bool are_gauges;
bool is_enabled, enable_is_active_high, has_enable_pin;
uint8_t both_edges, direction_inverted; /* a bit for each axis */
uint8_t step_levels;                    /* the step pins' resting levels, or their present ones where each edge is a step */
uint8_t backward;
uint8_t turned; /* axes whose direction has changed since their last step */
uint8_t pulse_us;
uint16_t setup_us;
uint32_t turned_us;
uint8_t gauge_states[GAUGES];

bool has(uint8_t axes, uint8_t axis)
{
    return (axes >> axis & 1) != 0;
}

void write_pin(uint8_t pin, bool high)
{
    if (pin != NO_PIN) {
        digitalWrite(pin, high ? HIGH : LOW);
    }
}

uint8_t coils_of(uint8_t state)
{
    static const uint8_t COILS[STATES] = {0x9, 0x1, 0x7, 0x6, 0xE, 0x8};
    return COILS[state];
}

/* The direction must have been there for long enough, also when poll() was late. */
void await_setup(uint8_t axes)
{
    if ((axes & turned) != 0) {
        turned = (uint8_t)(turned & ~axes);
        while (micros() - turned_us < (uint32_t)setup_us + CLOCK_GRAIN_US) {
        }
    }
}

void write_step_pins(uint8_t axes, uint8_t levels)
{
    for (uint8_t axis = 0; axis < AXES; axis++) {
        if (has(axes, axis)) {
            write_pin(stepramp_pins.step[axis], has(levels, axis));
        }
    }
}

void make_pulses(uint8_t axes)
{
    await_setup(axes);
    write_step_pins(axes, (uint8_t)~step_levels);
    step_levels ^= axes & both_edges;
    axes = (uint8_t)(axes & ~both_edges);
    if (axes != 0) {
        if (pulse_us != 0) {
            delayMicroseconds(pulse_us);
        }
        write_step_pins(axes, step_levels);
    }
}

void make_steps(uint8_t axes)
{
    if (!are_gauges) {
        make_pulses(axes);
        return;
    }
    for (uint8_t axis = 0; axis < GAUGES; axis++) {
        if (has(axes, axis)) {
            gauges->step(axis, has(backward, axis));
        }
    }
}

void turn(uint8_t axes)
{
    backward ^= axes;
    for (uint8_t axis = 0; axis < AXES && !are_gauges; axis++) {
        if (has(axes, axis)) {
            write_pin(stepramp_pins.direction[axis], has(backward, axis) == has(direction_inverted, axis));
        }
    }
    turned |= axes;
    turned_us = micros();
}

void drive_enable_pin()
{
    if (has_enable_pin) {
        arduino_begin_pin(stepramp_pins.enable, is_enabled == enable_is_active_high);
    }
}

/* Where each edge is a step, an edge less is a step less: such a pin keeps its level as long as it is one. */
void configure_steppers(const struct settings *settings)
{
    static uint8_t step_inverted;
    uint8_t kept = (uint8_t)(settings->both_edges & both_edges & ~(settings->step_inverted ^ step_inverted));
    step_inverted = settings->step_inverted;
    step_levels = (uint8_t)((step_levels & kept) | (step_inverted & ~kept));
    for (uint8_t axis = 0; axis < AXES; axis++) {
        arduino_begin_pin(stepramp_pins.step[axis], has(step_levels, axis));
        arduino_begin_pin(stepramp_pins.direction[axis], !has(settings->direction_inverted, axis));
    }
    both_edges = settings->both_edges;
}

/* Ticks of the engine's clock since the last look. */
uint32_t passing_ticks()
{
    uint32_t now_us = micros();
    uint32_t passed_us = now_us - looked_us;
    looked_us = now_us;
    if (passed_us > UINT16_MAX) {
        passed_us = UINT16_MAX;
    }
    return polled_engine_is_fast() ? passed_us << US_BITS : passed_us << (US_BITS - SLOW_TICK_BITS);
}

void note_delay(uint32_t ticks)
{
    delayed_ticks += polled_engine_is_fast() ? ticks : ticks << SLOW_TICK_BITS;
    delayed_us += delayed_ticks >> US_BITS;
    delayed_ticks &= (1u << US_BITS) - 1;
}

} // namespace

bool arduino_pins_are_good(void)
{
    const uint8_t *pins = (const uint8_t *)&stepramp_pins;
    for (uint8_t i = 0; i < sizeof stepramp_pins; i++) {
        if (pins[i] == NO_PIN) {
            continue;
        }
        bool is_alone = i >= offsetof(arduino_pins, coils) || memchr(pins, pins[i], i) == nullptr;
        if (pins[i] >= PINS_OF_BOARD || !is_alone) {
            return false;
        }
    }
#if HAS_INPUTS
    return !has_inputs() || WITH_INPUTS(arduino_inputs_are_good)();
#else
    return true;
#endif
}

REPLACEABLE void arduino_begin(void)
{
    looked_us = micros();
    polled_engine_set_outputs(make_steps, turn);
}

void arduino_begin_pin(uint8_t pin, bool high)
{
    if (pin != NO_PIN) {
        digitalWrite(pin, high ? HIGH : LOW);
        pinMode(pin, OUTPUT);
    }
}

void arduino_use_enable_pin(bool is_used, bool is_active_high)
{
    has_enable_pin = is_used;
    enable_is_active_high = is_active_high;
    drive_enable_pin();
}

void arduino_begin_gauges(void)
{
    for (uint8_t axis = 0; axis < GAUGES; axis++) {
        for (uint8_t i = 0; i < COIL_PINS; i++) {
            arduino_begin_pin(stepramp_pins.coils[axis][i], has(coils_of(gauge_states[axis]), i));
        }
    }
}

void arduino_release_gauges(void)
{
    for (uint8_t axis = 0; axis < GAUGES; axis++) {
        for (uint8_t i = 0; i < COIL_PINS; i++) {
            if (stepramp_pins.coils[axis][i] != NO_PIN) {
                pinMode(stepramp_pins.coils[axis][i], INPUT);
            }
        }
    }
}

void arduino_step_gauge(uint8_t gauge, bool is_backward)
{
    uint8_t before = coils_of(gauge_states[gauge]);
    uint8_t state = (uint8_t)(gauge_states[gauge] + (is_backward ? STATES - 1 : 1));
    gauge_states[gauge] = state >= STATES ? (uint8_t)(state - STATES) : state;
    uint8_t coils = coils_of(gauge_states[gauge]);
    for (uint8_t i = 0; i < COIL_PINS; i++) {
        if (has(coils ^ before, i)) {
            write_pin(stepramp_pins.coils[gauge][i], has(coils, i));
        }
    }
}

REPLACEABLE void arduino_use_gauges(void)
{
    static const struct gauge_functions functions = {arduino_begin_gauges, arduino_step_gauge, arduino_release_gauges};
    gauges = &functions;
}

REPLACEABLE bool arduino_has_timer(void)
{
    return false;
}

REPLACEABLE uint32_t arduino_delayed_us(void)
{
    return delayed_us;
}

REPLACEABLE void arduino_end_events(void)
{
    step_queue_halt(UINT8_MAX);
}

REPLACEABLE bool arduino_watch_pin(uint8_t pin)
{
    (void)pin;
    return false;
}

/* An event that is so late that it isn't caught up with is played as if it were just due: time stood still until now.
 * At rest, time only has to go on. */
REPLACEABLE void arduino_play(void)
{
    if (is_playing) {
        return;
    }
    is_playing = true;
#if HAS_INPUTS
    if (has_inputs() && engine_running() != 0 && WITH_INPUTS(arduino_sees_stop)()) {
        emergency_latch();
    }
#endif
    const uint16_t most_late = STEPRAMP_MOST_CATCH_UP_US << (polled_engine_is_fast() ? US_BITS : US_BITS - SLOW_TICK_BITS);
    uint32_t ticks = passing_ticks();
    if (ticks > (uint32_t)wait_ticks + most_late) {
        if (engine_running() != 0) {
            note_delay(ticks - wait_ticks);
        }
        ticks = wait_ticks;
    }
    engine_ticks = (uint16_t)(engine_ticks + ticks);
    time_ticks += polled_engine_is_fast() ? ticks : ticks << SLOW_TICK_BITS;
    wait_ticks = polled_engine_play(engine_ticks);
    is_playing = false;
}

/* ---- board.h ---- */

REPLACEABLE void board_configure(const struct settings *settings)
{
    step_queue_clear(0xFF);
    backward = 0;
    turned = 0;
    arduino_begin_inputs(settings);
    if (are_gauges && settings->outputs != OUTPUTS_GAUGES) {
        gauges->release();
    }
    are_gauges = gauges != nullptr && settings->outputs == OUTPUTS_GAUGES;
    if (are_gauges) {
        both_edges = 0;
        arduino_use_enable_pin(false, false);
        gauges->begin();
        return;
    }
    configure_steppers(settings);
    direction_inverted = settings->direction_inverted;
    setup_us = settings->direction_setup_us;
    pulse_us = settings->pulse_width_us > STEPRAMP_SHORTEST_PULSE_US ? settings->pulse_width_us
                                                                     : STEPRAMP_SHORTEST_PULSE_US;
    arduino_use_enable_pin(true, (settings->enable_flags & ENABLE_ACTIVE_HIGH) != 0);
}

/* Asked for at each segment that is queued: planning the next ones takes long, and events may be due meanwhile. */
REPLACEABLE uint8_t engine_step_mask(uint8_t axis)
{
    arduino_play();
    return (uint8_t)(1u << axis);
}

REPLACEABLE uint8_t engine_turn_mask(uint8_t axis)
{
    return (uint8_t)(1u << axis);
}

void board_enable(bool on)
{
    is_enabled = on;
    drive_enable_pin();
}

REPLACEABLE uint16_t board_time(void)
{
    arduino_play();
    return (uint16_t)(time_ticks >> TIME_BITS);
}

uint16_t board_milliseconds(void)
{
    arduino_play();
    return (uint16_t)millis();
}
