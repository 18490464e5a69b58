#include "StepRamp.h"

#include "arduino_port.h"
#include "controller.h"

StepRampControllerClass StepRampController;

/* Bytes in and out in one round, at most: a round must not take long. */
static const uint8_t BYTES_A_ROUND = 2;

static Stream *port;
static bool tells_room; /* not every Stream knows how many bytes can be written without waiting */

void StepRampControllerClass::begin(Stream &its_port)
{
    port = &its_port;
    tells_room = its_port.availableForWrite() > 0;
    arduino_begin();
    controller_begin();
}

void StepRampControllerClass::poll()
{
    if (port == nullptr) {
        return;
    }
    uint8_t byte;
    for (uint8_t i = 0; i < BYTES_A_ROUND && port->available() > 0; i++) {
        controller_receive((uint8_t)port->read());
    }
    for (uint8_t i = 0; i < BYTES_A_ROUND && (!tells_room || port->availableForWrite() > 0); i++) {
        if (!controller_next_byte(&byte)) {
            break;
        }
        port->write(byte);
    }
    controller_poll();
    arduino_play();
}
