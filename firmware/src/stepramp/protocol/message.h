/* Numbers of the protocol, and little-endian numbers in messages. See docs/serial_protocol.md. */
#ifndef STEPRAMP_MESSAGE_H
#define STEPRAMP_MESSAGE_H

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Where numbers lie in memory as they travel, they need not be taken apart. */
#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__
#define IS_LITTLE_ENDIAN 1
#else
#define IS_LITTLE_ENDIAN 0
#endif

enum kind {
    KIND_HELLO = 0x01,
    KIND_STATUS = 0x02,
    KIND_REPORT = 0x03,
    KIND_TRACE = 0x04,
    KIND_BEGIN = 0x10,
    KIND_DATA = 0x11,
    KIND_END = 0x12,
    KIND_COMMIT = 0x13,
    KIND_READ = 0x14,
    KIND_TRY = 0x15,
    KIND_ROLL_BACK = 0x16,
    KIND_READ_SETTINGS = 0x17,
    KIND_WRITE_SETTINGS = 0x18,
    KIND_READ_LIMITS = 0x19,
    KIND_WRITE_LIMITS = 0x1A,
    KIND_MOVE_BY = 0x20,
    KIND_MOVE_TO = 0x21,
    KIND_RUN = 0x22,
    KIND_LINE = 0x23,
    KIND_SET_POSITION = 0x24,
    KIND_ZERO = 0x25,
    KIND_ACKNOWLEDGE = 0x26,
    KIND_HOME = 0x27,
    KIND_STOP = 0x30,
    KIND_HALT = 0x31
};

/* Twice in place of a frame, between two zero bytes: a stop, a halt, of all axes. No frame is so long that it begins so; one
 * alone may be what is left of a frame whose beginning was lost. */
enum { HALT_BYTE = 0xFE, STOP_BYTE = 0xFF };

/* Obeyed whoever asks for it, and whatever is being sent. */
static inline bool is_urgent(uint8_t kind)
{
    return kind == KIND_STOP || kind == KIND_HALT;
}

enum { KIND_REPLY = 0x80 /* added to the request's kind */ };

/* Frames that nobody asked for one by one. */
enum notice_kind { KIND_REPORT_NOTICE = 0xC0, KIND_TRACE_NOTICE = 0xC1 };

enum status {
    STATUS_OK = 0,
    STATUS_UNKNOWN_KIND = 1,
    STATUS_BAD_LENGTH = 2,
    STATUS_STALE_SESSION = 3,
    STATUS_MOVING = 4,
    STATUS_NO_RAMP = 5,
    STATUS_OUT_OF_RANGE = 6,
    STATUS_OUT_OF_ORDER = 7,
    STATUS_BAD_CRC = 8,
    STATUS_BAD_RAMP = 9,
    STATUS_WRITING = 10,
    STATUS_BAD_VERSION = 11,
    STATUS_TOO_FAST = 12,
    STATUS_STOPPED = 13,
    STATUS_AT_LIMIT = 14
};

/* What a controller does, as `status` reports it. */
enum state { STATE_IDLE = 0, STATE_MOVING = 1, STATE_WRITING = 3 };

enum status_flags { FLAG_WRITE_FAILED = 1, FLAG_ON_TRIAL = 2, FLAG_ENABLED = 4 };

enum source { SOURCE_STORED = 0, SOURCE_RAM = 1, SOURCE_PREVIOUS = 2 };

enum { TRACE_OFF = 255 /* instead of an axis */, TRACE_LAST = 0x80 /* added to the axis */, MOST_TRACE_VALUES = 12 };

enum { MESSAGE_HEADER_BYTES = 4, MOST_DATA_BYTES = 48, MOST_REPORTS_HZ = 50 };

static inline uint16_t read_u16(const uint8_t *bytes)
{
    uint16_t value = (uint16_t)(bytes[0] | (uint16_t)bytes[1] << 8);
    if (IS_LITTLE_ENDIAN) {
        memcpy(&value, bytes, sizeof value);
    }
    return value;
}

static inline uint32_t read_u32(const uint8_t *bytes)
{
    uint32_t value = read_u16(bytes) | (uint32_t)read_u16(bytes + 2) << 16;
    if (IS_LITTLE_ENDIAN) {
        memcpy(&value, bytes, sizeof value);
    }
    return value;
}

static inline void write_u16(uint8_t *bytes, uint16_t value)
{
    bytes[0] = (uint8_t)value;
    bytes[1] = (uint8_t)(value >> 8);
}

static inline void write_u32(uint8_t *bytes, uint32_t value)
{
    write_u16(bytes, (uint16_t)value);
    write_u16(bytes + 2, (uint16_t)(value >> 16));
}

#ifdef __cplusplus
}
#endif

#endif
