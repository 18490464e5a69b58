#include "protocol_port.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "boards/polled/polled_engine.h"
#include "stepramp/edge/board.h"
#include "stepramp/edge/engine.h"
#include "stepramp/edge/inputs.h"
#include "stepramp/edge/step_queue.h"
#include "stepramp/protocol/controller.h"
#include "stepramp/store/driver_settings.h"

enum { BYTE_TICKS = 1389 /* a byte at 115200 baud, at 16 MHz */, ROUNDS_A_BYTE = 4 };
enum { TICKS_A_MILLISECOND = 16000 };

uint8_t port_eeprom[EEPROM_BYTES];
long port_eeprom_writes;
long port_cut_write;
int port_cut_value = EEPROM_ERASED;
uint32_t port_eeprom_write_ticks = 54400; /* 3.4 ms */
int32_t port_steps[PORT_AXES];

static uint64_t now_ticks, eeprom_busy_until;
static uint8_t backward; /* direction pins, a bit for each axis */
#if HAS_INPUTS
static struct settings used;
#endif

/* ---- pins ---- */

static void on_step(uint8_t axes)
{
    for (uint8_t i = 0; i < PORT_AXES; i++) {
        if ((axes >> i & 1) != 0) {
            port_steps[i] = (int32_t)((uint32_t)port_steps[i] + ((backward >> i & 1) != 0 ? UINT32_MAX : 1));
        }
    }
}

static void on_turn(uint8_t axes)
{
    backward ^= axes;
}

void board_configure(const struct settings *settings)
{
#if HAS_INPUTS
    used = *settings;
#endif
    (void)settings;
    backward = 0;
}

uint8_t engine_step_mask(uint8_t axis)
{
    return (uint8_t)(1 << axis);
}

uint8_t engine_turn_mask(uint8_t axis)
{
    return (uint8_t)(0x10 << axis);
}

void board_enable(bool on)
{
    (void)on;
}

#if HAS_INPUTS
/* ---- inputs ---- */

uint16_t port_levels = 0xFFFF;
struct port_switch port_switches[PORT_SWITCHES];
uint8_t port_switch_count;
bool port_is_tapped;
static bool emergency;

uint16_t inputs_read(void)
{
    uint16_t levels = port_levels, active = 0;
    for (uint8_t i = 0; i < port_switch_count; i++) {
        const struct port_switch *one = &port_switches[i];
        int32_t position = port_steps[one->axis];
        if (one->backward ? position <= one->at : position >= one->at) {
            levels &= (uint16_t)~(1u << one->input);
        }
    }
    for (uint8_t i = 0; i < INPUTS; i++) {
        uint8_t role = used.roles[i];
        bool is_high = (levels >> i & 1) != 0;
        if ((role & ROLE_BITS) != ROLE_NONE && is_high == ((role & INPUT_ACTIVE_HIGH) != 0)) {
            active |= (uint16_t)(1u << i);
        }
    }
    if (port_is_tapped) {
        port_is_tapped = false;
        emergency_latch();
    }
    return active;
}

static bool is_pressed(void)
{
    uint16_t active = inputs_read();
    for (uint8_t i = 0; i < INPUTS; i++) {
        if ((active >> i & 1) != 0 && (used.roles[i] & ROLE_BITS) == ROLE_EMERGENCY_STOP) {
            return true;
        }
    }
    return false;
}

void emergency_latch(void)
{
    emergency = true;
    step_queue_halt(0xFF);
}

void port_look_at_edges(void)
{
    if (is_pressed()) {
        emergency_latch();
    }
}

bool emergency_is_latched(void)
{
    return emergency;
}

void emergency_release(void)
{
    emergency = is_pressed();
}
#endif

/* ---- clock and EEPROM ---- */

uint16_t board_time(void)
{
    return (uint16_t)(now_ticks * 1000 / 64 / TICKS_A_MILLISECOND);
}

uint16_t board_milliseconds(void)
{
    return (uint16_t)(now_ticks / TICKS_A_MILLISECOND);
}

uint8_t board_reset_cause(void)
{
    return RESET_POWER_ON;
}

bool board_eeprom_is_busy(void)
{
    return now_ticks < eeprom_busy_until;
}

uint8_t board_eeprom_read(uint16_t address)
{
    if (address >= EEPROM_BYTES) {
        fprintf(stderr, "EEPROM read at %u\n", address);
        abort();
    }
    return port_eeprom[address];
}

void board_eeprom_write(uint16_t address, uint8_t value)
{
    if (address >= EEPROM_BYTES || board_eeprom_is_busy()) {
        fprintf(stderr, "EEPROM written at %u, or while busy\n", address);
        abort();
    }
    port_eeprom_writes++;
    if (port_cut_write == 0 || port_eeprom_writes < port_cut_write) {
        port_eeprom[address] = value;
        eeprom_busy_until = now_ticks + port_eeprom_write_ticks;
    } else if (port_eeprom_writes == port_cut_write && port_cut_value >= 0) {
        port_eeprom[address] = (uint8_t)port_cut_value;
    }
}

/* ---- the serial line ---- */

static const uint8_t *next_to_send; /* NULL: nothing */

void board_send(const uint8_t *frame)
{
    if (next_to_send != NULL) {
        fprintf(stderr, "a frame before the last one has gone\n");
        abort();
    }
    next_to_send = frame;
}

bool board_has_received(void)
{
    return false; /* they are handed over at once */
}

bool board_skip_to_stop(void)
{
    return false;
}

bool board_is_sending(void)
{
    return next_to_send != NULL;
}

void board_cut_frame(void)
{
    static const uint8_t end = 0;
    next_to_send = &end;
}

bool port_next_byte(uint8_t *byte)
{
    if (next_to_send == NULL) {
        return false;
    }
    *byte = *next_to_send;
    next_to_send = *byte == 0 ? NULL : next_to_send + 1;
    return true;
}

/* ---- time ---- */

void port_begin(void)
{
    eeprom_busy_until = 0;
    next_to_send = NULL;
    memset(port_steps, 0, sizeof port_steps);
#if HAS_INPUTS
    emergency = false;
    port_levels = 0xFFFF;
    port_switch_count = 0;
#endif
    controller_begin();
    polled_engine_set_outputs(on_step, on_turn);
}

static void round_of(uint32_t ticks)
{
    now_ticks += ticks;
    polled_engine_play((uint16_t)now_ticks);
    controller_poll();
}

void port_round(void)
{
    round_of(BYTE_TICKS / ROUNDS_A_BYTE);
}

size_t port_pass(unsigned long milliseconds, uint8_t *out, size_t most)
{
    size_t sent = 0;
    for (unsigned long rounds = 2 * milliseconds; rounds != 0; rounds--) {
        round_of(TICKS_A_MILLISECOND / 2);
        for (unsigned left = TICKS_A_MILLISECOND / 2 / BYTE_TICKS; left != 0 && sent < most && port_next_byte(out + sent); left--) {
            sent++;
        }
    }
    return sent;
}

size_t port_run(unsigned long byte_times, const uint8_t *in, size_t in_length, uint8_t *out)
{
    size_t taken = 0, sent = 0;
    for (; byte_times != 0; byte_times--) {
        uint8_t byte;
        if (taken < in_length) {
            controller_receive(in[taken++]);
        }
        for (unsigned i = 0; i < ROUNDS_A_BYTE; i++) {
            port_round();
        }
        if (port_next_byte(&byte)) {
            if (out) {
                out[sent] = byte;
            }
            sent++;
        }
    }
    return sent;
}
