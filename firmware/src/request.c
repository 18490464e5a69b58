#include "request.h"

#include "frame.h"
#include "ramp_store.h"

struct requests requests;
static struct frame_receiver receiver;

/* Keeps a byte of the request that is coming in. Where to, its first byte decides: the one that waits may be answered
 * before the last. */
static void keep(uint8_t index, uint8_t byte)
{
    if (index == 0) {
        requests.is_beside = requests.waiting_length != 0;
    }
    if (requests.is_beside) {
        if (index < URGENT_BYTES) {
            requests.urgent[index] = byte;
        }
        return;
    }
    if (index < KEPT_BYTES) {
        requests.kept[index] = byte;
    }
    if (index >= DATA_AT && requests.kept[0] == KIND_DATA) {
        ramp_store_put((uint8_t)(index - DATA_AT), byte);
    }
}

uint8_t request_receive(uint8_t byte)
{
    uint16_t received = frame_receive(&receiver, byte);
    if ((uint8_t)received == FRAME_HAS_BYTE) {
        keep(frame_byte_index(&receiver), (uint8_t)(received >> 8));
        return 0;
    }
    return (uint8_t)received < MESSAGE_HEADER_BYTES ? 0 : (uint8_t)received;
}
