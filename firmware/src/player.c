#include "player.h"

#include "plan.h"
#include "playback.h"
#include "port.h"

/* How a stop goes on in the main loop. */
enum stop_stage { NOT_STOPPING, ASKED_TO_STOP, LOOKING_FOR_THE_WAY, TURNING, ON_THE_WAY };

static const struct ramp *played_ramp;
static int32_t start_position; /* [steps] */
static bool runs_forward;
static uint32_t steps_made;
static uint32_t steps_planned;
static uint16_t pulses_counted;
static enum stop_stage stop_stage;
static interval_t held_interval; /* when it was asked to stop while accelerating */
static struct walk way_down;

/* The beginning of a way down of `reach` in the ramp's down list. */
static struct way way_of(const struct reach *reach)
{
    struct way way = {{reach->last_interval, 0, reach->last_count}, played_ramp->down.segments, 0, reach->steps};
    if (reach->segments != 0) {
        way.segments_left = (uint8_t)(reach->segments - 1);
        way.segment += way.segments_left;
        way.run.add = way.segment->add;
    }
    return way;
}

/* Sets the interrupt's variables to the beginning of a move that is planned. */
static void make_ready(const struct plan *plan)
{
    playback.slew_interval = played_ramp->slew_interval;
    playback.up_last_count = plan->up.last_count;
    playback.planned_way = way_of(&plan->down);
    playback.request = REQUEST_NONE;
    playback.way = &playback.planned_way;
    playback.segment = played_ramp->up.segments;
    playback.segments_left = plan->up.segments;
    playback.slew_left = plan->slew_steps;
    playback.phase = PHASE_UP;
    playback_load_first_run();
    playback.pulse_is_due = true;
    playback.wait_left = 0;
    playback.present = 0;
}

void player_move(const struct ramp *ramp, uint32_t steps, bool forward)
{
    struct plan plan;
    start_position = player_report().position;
    runs_forward = forward;
    steps_made = 0;
    steps_planned = steps;
    stop_stage = NOT_STOPPING;
    played_ramp = ramp;
    plan_move(ramp, steps, &plan);
    make_ready(&plan);
    playback.moving = true;
    port_start_events(forward);
}

void player_stop(void)
{
    if (playback.moving && stop_stage == NOT_STOPPING) {
        stop_stage = ASKED_TO_STOP;
    }
}

void player_halt(void)
{
    port_stop_events();
    playback.moving = false;
}

static void hand_over_turn(const struct way *way)
{
    playback.turn = *way;
    playback.request = REQUEST_TURN;
    stop_stage = TURNING;
}

/* Counts the pulses since the last time. 2^16 of them take longer than any round of the main loop. */
static void count_steps(void)
{
    const volatile uint16_t *pulses = &playback.pulses;
    uint16_t now;
    do {
        now = *pulses;
    } while (now != *pulses); /* an event came in between the two bytes */
    steps_made += (uint16_t)(now - pulses_counted);
    pulses_counted = now;
}

/* The present interval, which an event may change while it is read. */
static uint32_t present_interval(void)
{
    const volatile interval_t *present = &playback.present;
    interval_t interval;
    do {
        interval = *present;
    } while (interval != *present);
    return interval;
}

/* Begins a stop, which differs from phase to phase. Before the first pulse there is no speed to hold: it waits. */
static void begin_stop(void)
{
    switch (*(volatile uint8_t *)&playback.phase) {
    case PHASE_UP:
        playback.request = REQUEST_HOLD;
        held_interval = present_interval();
        if (held_interval != 0) {
            walk_begin(&way_down, &played_ramp->down);
            stop_stage = LOOKING_FOR_THE_WAY;
        }
        break;
    case PHASE_SLEW:
        hand_over_turn(&playback.planned_way);
        break;
    default:
        stop_stage = ON_THE_WAY;
        break;
    }
}

/* Goes on with a stop by one short piece of work, as bytes may be coming in. While it looks for the way the interrupt
 * holds the speed, and slows down where the move itself would have to, so that there is no hurry. */
static void go_on_stopping(void)
{
    if (stop_stage == ASKED_TO_STOP) {
        begin_stop();
    } else if (stop_stage == LOOKING_FOR_THE_WAY && !walk_on_while_longer(&way_down, held_interval)) {
        struct reach reach = walk_reach(&way_down);
        struct way way = way_of(&reach);
        hand_over_turn(&way);
    } else if (stop_stage == TURNING && playback.request == REQUEST_NONE) {
        steps_planned = steps_made - (uint16_t)(pulses_counted - playback.turn_pulses) + 1 + playback.turn.steps;
        stop_stage = ON_THE_WAY;
    }
}

void player_poll(void)
{
    count_steps();
    if (playback.moving) {
        go_on_stopping();
    }
}

bool player_is_moving(void)
{
    return playback.moving;
}

/* `start_position` and some steps in the direction of the move. */
static int32_t position_after(uint32_t steps)
{
    return (int32_t)((uint32_t)start_position + (runs_forward ? steps : 0u - steps));
}

struct motor_report player_report(void)
{
    struct motor_report report;
    bool is_moving = playback.moving; /* read first: at rest after this, the report is the last of the move */
    count_steps();
    report.state = !is_moving ? MOTOR_IDLE : stop_stage == NOT_STOPPING ? MOTOR_MOVING : MOTOR_STOPPING;
    report.steps_made = steps_made;
    report.position = position_after(steps_made);
    report.target = is_moving ? position_after(steps_planned) : report.position;
    report.interval = is_moving ? present_interval() : 0;
    return report;
}
