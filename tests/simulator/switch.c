/* Limit switches: each connects its pin to ground while an axis, whose steps are counted at its pins, is at some place or beyond. */
#include <stdio.h>

#include "host.h"

enum { AXES = 4, MOST_SWITCHES = 8 };

static const int step_pins[AXES] = {2, 3, 4, 12}, direction_pins[AXES] = {5, 6, 7, 13};

static struct limit_switch {
    unsigned pin, axis;
    long at;
    bool is_backward;
} switches[MOST_SWITCHES];
static unsigned count;
static avr_t *avr;
static long positions[AXES];
static bool is_forward[AXES];

static void connect(const struct limit_switch *one)
{
    long position = positions[one->axis];
    ground_pin(avr, one->pin, one->is_backward ? position <= one->at : position >= one->at);
}

void switch_note_edge(int pin, bool is_high)
{
    for (unsigned axis = 0; axis < AXES; axis++) {
        if (pin == direction_pins[axis]) {
            is_forward[axis] = is_high;
        } else if (pin == step_pins[axis] && is_high) {
            positions[axis] += is_forward[axis] ? 1 : -1;
            for (unsigned i = 0; i < count; i++) {
                if (switches[i].axis == axis) {
                    connect(&switches[i]);
                }
            }
        }
    }
}

bool switch_attach(avr_t *mcu, const char *text)
{
    avr = mcu;
    while (text != NULL && *text != 0) {
        struct limit_switch *one = &switches[count];
        char way;
        int length;
        if (count == MOST_SWITCHES || sscanf(text, "%u:%u%c%ld%n", &one->pin, &one->axis, &way, &one->at, &length) != 4 ||
            !ground_has_pin(one->pin) || one->axis >= AXES || (way != '<' && way != '>')) {
            return false;
        }
        one->is_backward = way == '<';
        connect(one);
        count++;
        text += length;
        text += *text == ',';
    }
    return true;
}
