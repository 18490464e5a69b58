#include "inputs.h"

#include <string.h>

#include "chance.h"
#include "must.h"
#include "protocol_port.h"
#include "stepramp/edge/inputs.h"
#include "stepramp/protocol/message.h"
#include "talk.h"

#if HAS_INPUTS
enum { ALL_HIGH = (1 << INPUTS) - 1 };

static bool was_latched;
static long acknowledged;
static int32_t steps[PORT_AXES];

static void note(void)
{
    was_latched = emergency_is_latched();
    acknowledged = accepted[KIND_ACKNOWLEDGE];
    memcpy(steps, port_steps, sizeof steps);
}

void inputs_change(void)
{
    if (one_in(40)) {
        port_levels = one_in(3) ? (uint16_t)(ALL_HIGH & ~(1u << below(INPUTS))) : ALL_HIGH;
        port_look_at_edges();
    }
    note();
}

void inputs_check(void)
{
    bool is_same = was_latched && emergency_is_latched() && acknowledged == accepted[KIND_ACKNOWLEDGE];
    must(!is_same || memcmp(steps, port_steps, sizeof steps) == 0, "a step after an emergency stop");
}
#else
void inputs_change(void)
{
}

void inputs_check(void)
{
}
#endif
