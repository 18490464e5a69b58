/* What the controller must hold, by the requests that it has accepted. */
#ifndef STEPRAMP_MODEL_H
#define STEPRAMP_MODEL_H

#include <stdbool.h>
#include <stdint.h>

#include "images.h"
#include "protocol_port.h"

extern struct model {
    struct image delivery; /* what has been accepted of it */
    uint16_t announced_crc;
    uint16_t announced;
    bool is_delivered_to, is_checked, settings_on_trial;
    struct image on_trial, stored, previous;
    struct image being_stored;
    bool is_writing;
    uint32_t zero[PORT_AXES]; /* position less steps */
} model;

/* An accepted request. */
void model_note_accepted(const uint8_t *message, uint8_t length);

/* A request that needs the ramp in use drops a delivery, also when it is refused then for another reason. */
void model_note_dropped_delivery(void);

/* What was being stored is stored. */
void model_note_written(void);

/* Compares the controller with all that it must hold. */
void model_check(void);

#endif
