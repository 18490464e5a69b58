#include "inputs.h"

#include <string.h>

#include "chance.h"
#include "must.h"
#include "protocol_port.h"
#include "stepramp/edge/inputs.h"
#include "stepramp/protocol/message.h"
#include "talk.h"

#if HAS_INPUTS
#include "stepramp/motion/machine.h"
#include "stepramp/motion/machine_inputs.h"

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

/* By how much a position is beyond an axis' soft limits [steps]. */
static uint32_t beyond(uint8_t axis, int32_t position)
{
    int32_t low = machine_soft_limit(axis, true), high = machine_soft_limit(axis, false);
    return position < low ? (uint32_t)low - (uint32_t)position : position > high ? (uint32_t)position - (uint32_t)high : 0;
}

/* So far beyond a soft limit is a run that had none on its side, and has come round. */
enum { A_ROUND = 1 << 30 };

/* Who is within soft limits stays there, and who is beyond comes no further. What is said at rest begins anew, and zeroing
 * goes from wherever it is said to be. */
static void check_soft_limits(void)
{
    static uint32_t was_beyond[PORT_AXES];
    static bool was_known[PORT_AXES];
    static long zeroed, said;
    static bool is_zeroing;
    long now_said = accepted[KIND_SET_POSITION] + accepted[KIND_WRITE_LIMITS];
    bool is_new = said != now_said;
    said = now_said;
    is_zeroing = zeroed != accepted[KIND_ZERO] || (is_zeroing && machine_is_moving());
    zeroed = accepted[KIND_ZERO];
    for (uint8_t axis = 0; axis < PORT_AXES; axis++) {
        bool is_known = axis < machine_axes() && (stepramp_known_positions >> axis & 1) != 0;
        uint32_t is_beyond = beyond(axis, machine_report(axis).position);
        bool moves = machine_axis_is_moving(axis);
        bool is_excused = is_new || is_zeroing || !is_known || !was_known[axis] || !moves || is_beyond >= A_ROUND;
        must(is_excused || is_beyond <= was_beyond[axis], "a step beyond a soft limit");
        was_known[axis] = is_known;
        was_beyond[axis] = is_beyond;
    }
}

void inputs_check(void)
{
    check_soft_limits();
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
