#include "StepRamp.h"

#include "boards/polled/arduino_board.h"
#include "stepramp/edge/board.h"
#include "stepramp/protocol/controller.h"

StepRampControllerClass StepRampController;

/* Bytes in and out in one round, at most: a round must not take long. */
static const uint8_t BYTES_A_ROUND = 2;

static Stream *port;
static bool tells_room; /* not every Stream knows how many bytes can be written without waiting */
static const uint8_t *next_to_send; /* null: nothing */

void StepRampControllerClass::begin(Stream &its_port)
{
    arduino_use_gauges();
    port = &its_port;
    tells_room = its_port.availableForWrite() > 0;
    arduino_begin();
    controller_begin();
}

static void send_byte()
{
    uint8_t byte = *next_to_send;
    next_to_send = byte == 0 ? nullptr : next_to_send + 1;
    port->write(byte);
}

void StepRampControllerClass::poll()
{
    if (port == nullptr) {
        return;
    }
    for (uint8_t i = 0; i < BYTES_A_ROUND && port->available() > 0; i++) {
        controller_receive((uint8_t)port->read());
    }
    for (uint8_t i = 0; i < BYTES_A_ROUND && board_is_sending() && (!tells_room || port->availableForWrite() > 0); i++) {
        send_byte();
    }
    controller_poll();
    arduino_play();
}

/* ---- board.h ---- */

bool board_has_received(void)
{
    return port != nullptr && port->available() > 0;
}

/* A Stream hands its bytes over in turn. */
bool board_skip_to_stop(void)
{
    return false;
}

void board_send(const uint8_t *frame)
{
    next_to_send = frame;
}

bool board_is_sending(void)
{
    return next_to_send != nullptr;
}

void board_cut_frame(void)
{
    static const uint8_t end = 0;
    next_to_send = &end;
}
