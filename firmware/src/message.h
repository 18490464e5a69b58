/* Numbers of the protocol, and little-endian numbers in messages. See docs/serial_protocol.md. */
#ifndef STEPRAMP_MESSAGE_H
#define STEPRAMP_MESSAGE_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

enum kind {
    KIND_HELLO = 0x01,
    KIND_STATUS = 0x02,
    KIND_BEGIN = 0x10,
    KIND_DATA = 0x11,
    KIND_END = 0x12,
    KIND_COMMIT = 0x13,
    KIND_READ = 0x14,
    KIND_MOVE_BY = 0x20,
    KIND_MOVE_TO = 0x21,
    KIND_STOP = 0x30,
    KIND_HALT = 0x31
};

enum { KIND_REPLY = 0x80 /* added to the request's kind */ };

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
    STATUS_BAD_VERSION = 11
};

/* What a controller does, as `status` reports it: a motor's state (player.h), or this. */
enum { STATE_WRITING = 3 };

enum source { SOURCE_STORED = 0, SOURCE_STAGED = 1 };

enum { MESSAGE_HEADER_BYTES = 4, MOST_DATA_BYTES = 48 };

static inline uint16_t read_u16(const uint8_t *bytes)
{
    return (uint16_t)(bytes[0] | (uint16_t)bytes[1] << 8);
}

static inline uint32_t read_u32(const uint8_t *bytes)
{
    return read_u16(bytes) | (uint32_t)read_u16(bytes + 2) << 16;
}

#ifdef __cplusplus
}
#endif

#endif
