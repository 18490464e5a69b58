/* The chips that are simulated: where what the other files replace has its registers, and the pins of the Arduino boards. */
#include <string.h>

#include "host.h"

static const struct chip chips[] = {
    {.name = "atmega328p",
     .timers = "1",
     .timer_channels = 2,
     .uart = '0',
     .uart_registers = 0xC0,
     .has_timer2 = true,
     .response_cycles = 4,
     .receive_vector = 18,
     .step_vectors = {11, 0, 0, 0},
     .pins = "D0D1D2D3D4D5D6D7B0B1B2B3B4B5C0C1C2C3C4C5"},
    {.name = "atmega2560",
     .timers = "1345",
     .timer_channels = 3,
     .uart = '0',
     .uart_registers = 0xC0,
     .has_timer2 = true,
     .response_cycles = 5,
     .receive_vector = 25,
     .step_vectors = {18, 33, 43, 48},
     .pins = "E0E1E4E5G5E3H3H4H5H6B4B5B6B7J1J0H1H0D3D2D1D0A0A1A2A3A4A5A6A7C7C6C5C4C3C2C1C0D7G2G1G0L7L6L5L4L3L2L1L0B3B2B1B0"
             "F0F1F2F3F4F5F6F7K0K1K2K3K4K5K6K7"},
    {.name = "atmega32u4",
     .timers = "13",
     .timer_channels = 3,
     .uart = '1',
     .uart_registers = 0xC8,
     .has_timer2 = false,
     .response_cycles = 4,
     .receive_vector = 25,
     .step_vectors = {18, 33, 0, 0},
     .pins = "D2D3D1D0D4C6D7E6B4B5B6B7D6C7B3B1B2B0F7F6F5F4F1F0"},
};

const struct chip *chip = chips;
static unsigned step_timer;

bool chip_choose(const char *name, char timer)
{
    for (unsigned i = 0; i < sizeof chips / sizeof chips[0]; i++) {
        const char *place = strchr(chips[i].timers, timer);
        if (strcmp(chips[i].name, name) == 0 && place != NULL && timer != '\0') {
            chip = &chips[i];
            step_timer = (unsigned)(place - chips[i].timers);
            return true;
        }
    }
    return false;
}

int chip_pins(void)
{
    return (int)strlen(chip->pins) / 2;
}

struct port_bit chip_pin(int pin)
{
    return (struct port_bit){chip->pins[2 * pin], chip->pins[2 * pin + 1] - '0'};
}

int chip_step_vector(void)
{
    return chip->step_vectors[step_timer];
}
