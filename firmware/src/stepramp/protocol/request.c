#include "stepramp/protocol/request.h"

#include <string.h>

#include "stepramp/edge/out_of_line.h"
#include "stepramp/protocol/frame.h"
#include "stepramp/store/ramp_keeper.h"

struct requests stepramp_requests;
static struct frame_receiver receiver;

/* Keeps a byte of the request that is coming in. Where to, its first byte decides: the one that waits may be answered
 * before the last. */
static void keep(uint8_t index, uint8_t byte)
{
    if (index == 0) {
        stepramp_requests.is_beside = stepramp_requests.waiting_length != 0;
    }
    if (stepramp_requests.is_beside) {
        if (index < URGENT_BYTES) {
            stepramp_requests.urgent[index] = byte;
        }
        return;
    }
    if (index < KEPT_BYTES) {
        stepramp_requests.kept[index] = byte;
    }
    if (index >= DATA_AT && stepramp_requests.kept[0] == KIND_DATA) {
        ramp_keeper_put((uint8_t)(index - DATA_AT), byte);
    }
}

/* What stops in place of a frame is a request without a session and a tag. Returns its length. */
static OUT_OF_LINE uint8_t receive_stop(uint8_t byte)
{
    stepramp_requests.is_beside = stepramp_requests.waiting_length != 0;
    uint8_t *message = stepramp_requests.is_beside ? stepramp_requests.urgent : stepramp_requests.kept;
    memset(message, 0, MESSAGE_HEADER_BYTES);
    message[0] = byte == STOP_BYTE ? KIND_STOP : KIND_HALT;
    return MESSAGE_HEADER_BYTES;
}

uint8_t request_receive(uint8_t byte)
{
    uint16_t received = frame_receive(&receiver, byte);
    if ((uint8_t)received == FRAME_HAS_BYTE) {
        keep(frame_byte_index(&receiver), (uint8_t)(received >> 8));
        return 0;
    }
    if ((uint8_t)received == FRAME_STOPS) {
        return receive_stop((uint8_t)(received >> 8));
    }
    return (uint8_t)received < MESSAGE_HEADER_BYTES ? 0 : (uint8_t)received;
}
