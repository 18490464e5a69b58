/* The Arduino library on this machine: pins are noted, time passes as the clock is looked at.
 *
 *   scenarios NAME IMAGE     plays a scenario with a ramp image in hexadecimal; says what isn't as it should be
 */
#include <StepRampAxis.h>

#include <stdio.h>
#include <stdlib.h>

#define CHECK(condition)                                                                                               \
    do {                                                                                                               \
        if (!(condition)) {                                                                                            \
            printf("line %d: %s\n", __LINE__, #condition);                                                             \
            exit(1);                                                                                                   \
        }                                                                                                              \
    } while (false)

enum { PINS = 32, STEP = 2, DIRECTION = 5, ENABLE = 8, SLEW_US = 1000 };
enum { STOP_PIN = 20, FAULT_PIN = 21, LOW_SWITCH = 22, HIGH_SWITCH = 23, SECOND_SWITCH = 24 };

static unsigned long now_us;
static int level[PINS], edges[PINS];
static bool is_output[PINS], is_pulled_up[PINS], is_grounded[PINS];
static unsigned long rose_us[PINS], shortest_us[PINS], last_us[PINS], shortest_pulse_us;
static uint8_t image[256];
static uint16_t image_bytes;
static int place, second_place; /* of the motors at STEP and behind it, by their pins */
static unsigned long grounds_us = ULONG_MAX; /* the emergency stop is pressed then */
static int low_switch_at = -1000000, high_switch_at = 1000000, second_switch_at = 1000000;

/* ---- the Arduino API ---- */

/* 32 bits, as on every board: they come round after 71.6 minutes, those of millis() after 49.7 days. */
unsigned long micros()
{
    is_grounded[STOP_PIN] |= now_us == grounds_us;
    return (uint32_t)++now_us;
}

unsigned long millis()
{
    return (uint32_t)(now_us / 1000);
}

void delayMicroseconds(unsigned int microseconds)
{
    now_us += microseconds;
}

void pinMode(uint8_t pin, uint8_t mode)
{
    is_output[pin] = mode == OUTPUT;
    is_pulled_up[pin] = mode == INPUT_PULLUP;
}

/* A pin that nothing drives is high by its pull-up, or low. */
int digitalRead(uint8_t pin)
{
    bool is_switched = (pin == LOW_SWITCH && place <= low_switch_at) || (pin == HIGH_SWITCH && place >= high_switch_at) ||
                       (pin == SECOND_SWITCH && second_place >= second_switch_at);
    return is_pulled_up[pin] && !is_grounded[pin] && !is_switched ? HIGH : LOW;
}

void digitalWrite(uint8_t pin, uint8_t value)
{
    if (level[pin] == value) {
        return;
    }
    level[pin] = value;
    edges[pin] += is_output[pin];
    if (!is_output[pin]) {
        return;
    }
    if (value == HIGH) {
        unsigned long since_us = now_us - rose_us[pin];
        last_us[pin] = since_us;
        shortest_us[pin] = shortest_us[pin] == 0 || since_us < shortest_us[pin] ? since_us : shortest_us[pin];
        rose_us[pin] = now_us;
        place += pin != STEP ? 0 : level[DIRECTION] == HIGH ? 1 : -1;
        second_place += pin != STEP + 1 ? 0 : level[DIRECTION + 1] == HIGH ? 1 : -1;
    } else if (pin == STEP && (shortest_pulse_us == 0 || now_us - rose_us[pin] < shortest_pulse_us)) {
        shortest_pulse_us = now_us - rose_us[pin];
    }
}

int Print::availableForWrite()
{
    return 0;
}

static bool has_timer; /* for the choice of the clock: it plays nothing here */

extern "C" bool __wrap_arduino_has_timer()
{
    return has_timer;
}

/* ---- scenarios; the ramp has SLEW_US for slew interval, one axis or two ---- */

static void begin()
{
    StepRamp.setStepper(0, STEP, DIRECTION);
    StepRamp.setStepper(1, STEP + 1, DIRECTION + 1);
    StepRamp.setEnablePin(ENABLE);
    CHECK(StepRamp.begin(image, image_bytes));
}

static void poll_for(unsigned long us)
{
    for (unsigned long end = now_us + us; now_us < end;) {
        StepRamp.poll();
    }
}

static void poll_until_rest()
{
    for (unsigned long end = now_us + 60000000; StepRamp.isMoving();) {
        CHECK(now_us < end);
        StepRamp.poll();
    }
}

static void refuse()
{
    const int32_t both[] = {100, -50};
    CHECK(StepRamp.moveTo(0, 1) == STEPRAMP_NO_RAMP);
    CHECK(StepRamp.moveAllTo(both) == STEPRAMP_NO_RAMP);
    CHECK(StepRamp.lineBy(both) == STEPRAMP_NO_RAMP);
    CHECK(!StepRamp.begin(image, (uint16_t)(image_bytes - 1)));
    StepRamp.setPulseWidth(101);
    CHECK(!StepRamp.begin(image, image_bytes));
    StepRamp.setPulseWidth(0);
    CHECK(StepRamp.axes() == 0);
    begin();
    CHECK(StepRamp.axes() == 2 && StepRamp.ticksPerSecond() == 2000000);
    CHECK(StepRamp.moveTo(2, 1) == STEPRAMP_OUT_OF_RANGE);
    CHECK(StepRamp.moveTo(255, 1) == STEPRAMP_OUT_OF_RANGE);
    CHECK(StepRamp.setPosition(2, 1) == STEPRAMP_OUT_OF_RANGE);
    CHECK(StepRamp.run(0, 2 * SLEW_US - 1) == STEPRAMP_OUT_OF_RANGE);
    CHECK(StepRamp.setPosition(0, INT32_MAX) == STEPRAMP_OK);
    CHECK(StepRamp.moveBy(0, 1) == STEPRAMP_OUT_OF_RANGE);
    CHECK(StepRamp.setPosition(0, 0) == STEPRAMP_OK);
    CHECK(StepRamp.moveTo(0, 100) == STEPRAMP_OK);
    CHECK(StepRamp.setPosition(0, 5) == STEPRAMP_MOVING && StepRamp.zero(0, 5) == STEPRAMP_MOVING);
    CHECK(StepRamp.lineBy(both) == STEPRAMP_MOVING && !StepRamp.begin(image, image_bytes));
    poll_until_rest();
    CHECK(StepRamp.lineBy(both) == STEPRAMP_OK);
    CHECK(StepRamp.moveTo(0, 1) == STEPRAMP_MOVING && StepRamp.run(1, 4000) == STEPRAMP_MOVING);
    poll_until_rest();
    CHECK(StepRamp.position(0) == 200 && StepRamp.position(1) == -50);
}

static void move()
{
    const int32_t home[] = {0, 0};
    begin();
    CHECK(StepRamp.moveTo(0, 300) == STEPRAMP_OK && StepRamp.isMoving(0) && !StepRamp.isMoving(1));
    poll_for(150000);
    CHECK(StepRamp.moveBy(0, -100) == STEPRAMP_OK && StepRamp.target(0) == 200);
    poll_until_rest();
    CHECK(StepRamp.position(0) == 200 && edges[STEP] == 2 * 200 && level[DIRECTION] == HIGH);
    CHECK(StepRamp.moveTo(1, -50) == STEPRAMP_OK);
    poll_until_rest();
    CHECK(edges[STEP + 1] == 2 * 50 && level[DIRECTION + 1] == LOW);
    CHECK(StepRamp.moveAllTo(home) == STEPRAMP_OK);
    poll_until_rest();
    CHECK(edges[STEP] == 2 * 400 && edges[STEP + 1] == 2 * 100);
    CHECK(shortest_pulse_us >= 3 && shortest_us[STEP] >= SLEW_US - 20 && StepRamp.delayedMicroseconds() == 0);
}

static void run()
{
    begin();
    CHECK(StepRamp.run(0, -(int32_t)(StepRamp.ticksPerSecond() / 500)) == STEPRAMP_OK);
    poll_for(2000000);
    CHECK(shortest_us[STEP] >= 1980 && shortest_us[STEP] <= 2000);
    StepRamp.stop(1);
    CHECK(StepRamp.isMoving(0));
    StepRamp.stop();
    poll_until_rest();
    CHECK(StepRamp.position(0) == -edges[STEP] / 2 && StepRamp.position(0) < -900);
    CHECK(StepRamp.run(0, 4000) == STEPRAMP_OK);
    poll_for(500000);
    StepRamp.halt(0);
    int made = edges[STEP];
    CHECK(!StepRamp.isMoving());
    poll_for(100000);
    CHECK(edges[STEP] == made);
}

static void set()
{
    StepRamp.setStepInverted(0);
    StepRamp.setDirectionInverted(0);
    StepRamp.setEnableActiveHigh();
    StepRamp.setEnableLead(50);
    StepRamp.setEnableHold(20);
    StepRamp.setPulseWidth(40);
    StepRamp.setDirectionSetup(200);
    StepRamp.setBothEdges(1);
    begin();
    CHECK(level[STEP] == HIGH && level[DIRECTION] == LOW && level[ENABLE] == LOW && is_output[ENABLE]);
    CHECK(StepRamp.moveTo(0, 10) == STEPRAMP_OK && StepRamp.moveTo(1, 11) == STEPRAMP_OK);
    poll_for(45000);
    CHECK(level[ENABLE] == HIGH && edges[STEP] == 0);
    poll_until_rest();
    CHECK(edges[STEP] == 20 && level[STEP] == HIGH && edges[STEP + 1] == 11);
    poll_for(30000);
    CHECK(level[ENABLE] == LOW);
    CHECK(StepRamp.begin(image, image_bytes) && level[STEP + 1] == HIGH); /* no step, where each edge is one */
}

/* A loop that now and then takes very long: steps are late, none is lost, and none comes too soon after another. */
static void delay_loop()
{
    begin();
    CHECK(StepRamp.moveTo(0, 1000) == STEPRAMP_OK);
    while (StepRamp.isMoving()) {
        poll_for(7300);
        now_us += 20000;
    }
    CHECK(StepRamp.position(0) == 1000 && edges[STEP] == 2000);
    CHECK(shortest_us[STEP] >= SLEW_US - 30);
    CHECK(StepRamp.delayedMicroseconds() > 1000000);
}

/* Gauges don't use step pins; a needle goes through its states one by one. */
static void gauge()
{
    StepRamp.setGauge(0, 10, 11, 12, 13);
    begin();
    CHECK(level[10] == HIGH && level[11] == LOW && level[12] == LOW && level[13] == HIGH && is_output[13]);
    CHECK(StepRamp.zero(0, 8) == STEPRAMP_OK);
    poll_until_rest();
    CHECK(StepRamp.position(0) == 0 && edges[STEP] == 0);
    CHECK(level[10] == LOW && level[11] == HIGH && level[12] == HIGH && level[13] == HIGH); /* 8 back is 4 on */
}

/* Axes of a sketch: what begin() says, and moves along ramps that were computed. */
static void axes()
{
    static StepRampAxis x(STEP, DIRECTION), y(STEP + 1, DIRECTION + 1), z(14, 15);
    CHECK(x.begin() == STEPRAMP_RAMP_MISSING && strcmp((const char *)x.problem(), "no ramp: setRamp() first") == 0);
    CHECK(x.moveTo(1) == STEPRAMP_NO_RAMP && x.setPosition(1) == STEPRAMP_NO_RAMP && x.runAt(1) == STEPRAMP_NO_RAMP);
    x.setRamp(0, 2000);
    CHECK(x.begin() == STEPRAMP_BAD_SPEED);
    x.setRamp(NAN, 2000);
    CHECK(x.begin() == STEPRAMP_BAD_SPEED);
    x.setRamp(1.01f * StepRampAxis::mostSpeed(), 2000);
    CHECK(x.begin() == STEPRAMP_SPEED_TOO_HIGH);
    x.setRamp(1e9f, 2000);
    CHECK(x.begin() == STEPRAMP_SPEED_TOO_HIGH);
    x.setRamp(INFINITY, 2000);
    CHECK(x.begin() == STEPRAMP_SPEED_TOO_HIGH);
    x.setRamp(1000, 1e9f);
    CHECK(x.begin() == STEPRAMP_BAD_ACCELERATION && strstr((const char *)x.problem(), "to 1e9") != nullptr);
    x.setRamp(1000, -1);
    CHECK(x.begin() == STEPRAMP_BAD_ACCELERATION);
    x.setRamp(1000, 0.01f);
    CHECK(x.begin() == STEPRAMP_BAD_ACCELERATION);
    x.setRamp(1000, 2000, 0, 1000);
    CHECK(x.begin() == STEPRAMP_BAD_BASE_SPEED);
    x.setRamp(2500, 0.5f); /* 6.25 million steps */
    CHECK(x.begin() == STEPRAMP_BAD_ACCELERATION);
    x.setRamp(2500, 0.9f);
    CHECK(x.begin() == STEPRAMP_NO_ROOM);
    x.useRamp(image, image_bytes);
    CHECK(x.begin() == STEPRAMP_BAD_IMAGE); /* of two axes */
    x.setRamp(1000, 2000, 4000);
    CHECK(x.begin() == STEPRAMP_READY && y.moveTo(1) == STEPRAMP_NO_RAMP);
    y.setRamp(500, 2000, 0, 100);
    CHECK(y.begin() == STEPRAMP_READY && z.moveTo(1) == STEPRAMP_NO_RAMP);
    CHECK(x.moveTo(800) == STEPRAMP_OK && y.move(-100) == STEPRAMP_OK && x.begin() == STEPRAMP_STILL_MOVING);
    CHECK(x.target() == 800 && x.stepsToGo() == 800 && x.isMoving());
    while (x.run() || y.run()) {
    }
    CHECK(x.position() == 800 && y.position() == -100 && edges[STEP] == 1600 && edges[STEP + 1] == 200);
    CHECK(shortest_us[STEP] >= SLEW_US - 20 && shortest_us[STEP + 1] >= 2 * SLEW_US - 20);
}

/* An axis that has begun doesn't move by a ramp that isn't its own, nor by none, once another has begun. */
static void another_begins()
{
    static StepRampAxis x(STEP, DIRECTION), y(STEP + 1, DIRECTION + 1);
    x.setRamp(1000, 4000);
    y.setRamp(300, 1000);
    CHECK(x.begin() == STEPRAMP_READY && y.begin() == STEPRAMP_READY);
    y.setRamp(-1, 1000);
    CHECK(x.begin() == STEPRAMP_READY && y.moveTo(1000) == STEPRAMP_NO_RAMP);
    CHECK(strcmp((const char *)y.problem(), "the speed is below 0.0075 steps/s") == 0);
    y.setRamp(300, 1000);
    CHECK(y.begin() == STEPRAMP_READY && y.moveTo(10) == STEPRAMP_OK);
    poll_until_rest();
    x.setRamp(2500, 0.9f);
    CHECK(x.begin() == STEPRAMP_NO_ROOM && y.moveTo(0) == STEPRAMP_NO_RAMP && x.moveTo(1) == STEPRAMP_NO_RAMP);
    x.setRamp(1000, 4000);
    CHECK(x.begin() == STEPRAMP_READY && y.moveTo(0) == STEPRAMP_OK);
    poll_until_rest();
    CHECK(shortest_us[STEP + 1] >= 3000);
}

/* What is so slow that its first step wants the slow clock has that, and what is too slow for that is told so. */
static void slow_ramps()
{
    static StepRampAxis x(STEP, DIRECTION);
    const float slow[][2] = {{2, 0.005f}, {0.02f, 0.00012f}, {0.0075f, 1}};
    const float accelerations[] = {0.00011f, 1e-5f, 1e-9f};
    has_timer = true;
    for (float tooSlow : accelerations) {
        x.setRamp(1, tooSlow);
        CHECK(x.begin() == STEPRAMP_BAD_ACCELERATION && strstr((const char *)x.problem(), "0.00012 to 1e9") != nullptr);
        x.setRamp(1, 1, tooSlow);
        CHECK(x.begin() == STEPRAMP_BAD_ACCELERATION);
    }
    for (const float(&ramp)[2] : slow) {
        x.setRamp(ramp[0], ramp[1]);
        CHECK(x.begin() == STEPRAMP_READY && StepRamp.ticksPerSecond() == 2000000);
    }
    x.setRamp(2, 0.008f);
    CHECK(x.begin() == STEPRAMP_READY && StepRamp.ticksPerSecond() == 16000000);
}

static void rest_at(StepRampAxis &axis, int32_t position)
{
    CHECK(axis.moveTo(position) == STEPRAMP_OK);
    poll_until_rest();
    CHECK(axis.position() == position);
}

/* A begin() that is refused leaves what was ready as it was, or not ready: nothing moves along a ramp that nobody asked for. */
static void refused_begin()
{
    static StepRampAxis x(STEP, DIRECTION), y(STEP + 1, DIRECTION + 1);
    x.setRamp(1000, 2000);
    CHECK(x.begin() == STEPRAMP_READY);
    y.setRamp(0, 2000);
    CHECK(y.begin() == STEPRAMP_BAD_SPEED && y.moveTo(1) == STEPRAMP_NO_RAMP);
    rest_at(x, 500);
    y.setRamp(2500, 0.9f);
    CHECK(y.begin() == STEPRAMP_NO_ROOM && x.moveTo(0) == STEPRAMP_NO_RAMP && StepRamp.moveTo(0, 0) == STEPRAMP_NO_RAMP);
    CHECK(strcmp((const char *)x.problem(), (const char *)y.problem()) == 0);
    y.setRamp(500, 2000);
    CHECK(y.begin() == STEPRAMP_READY);
    rest_at(x, 0);
    rest_at(y, 100);
    StepRamp.setPulseWidth(101);
    CHECK(y.begin() == STEPRAMP_BAD_IMAGE && x.moveTo(1) == STEPRAMP_NO_RAMP && StepRamp.moveTo(0, 1) == STEPRAMP_NO_RAMP);
    StepRamp.setPulseWidth(0);
    CHECK(y.begin() == STEPRAMP_READY);
    rest_at(x, 50);
    x.setRamp(1000, -1);
    CHECK(y.begin() == STEPRAMP_READY && x.moveTo(0) == STEPRAMP_NO_RAMP);
    CHECK(strncmp((const char *)x.problem(), "acceleration", 12) == 0);
    rest_at(y, 0);
    CHECK(shortest_us[STEP] >= SLEW_US - 20 && shortest_us[STEP + 1] >= 2 * SLEW_US - 20);
}

/* In flight begin() is refused and changes nothing, whatever is set meanwhile. */
static void begin_in_flight()
{
    static StepRampAxis x(STEP, DIRECTION);
    x.setRamp(1000, 2000);
    CHECK(x.begin() == STEPRAMP_READY && x.runAt(900) == STEPRAMP_OK);
    poll_for(100000);
    x.setRamp(500, -1);
    CHECK(x.begin() == STEPRAMP_STILL_MOVING && x.runAt(800) == STEPRAMP_OK && x.move(1) == STEPRAMP_OK);
    CHECK(strcmp((const char *)x.problem(), "begin() is for motors at rest") == 0);
    poll_until_rest();
    CHECK(x.setPosition(0) == STEPRAMP_OK);
    rest_at(x, 500);
    CHECK(shortest_us[STEP] >= SLEW_US - 20 && shortest_us[STEP] < SLEW_US + 20);
}

/* The first begin() makes all axes ready that have a ramp, so that each ramp is computed once. */
static void begin_together()
{
    static StepRampAxis x(STEP, DIRECTION), y(STEP + 1, DIRECTION + 1), z(14, 15);
    x.setRamp(1000, 2000);
    y.setRamp(500, 2000);
    CHECK(x.begin() == STEPRAMP_READY && z.begin() == STEPRAMP_RAMP_MISSING);
    rest_at(y, 100);
    CHECK(y.begin() == STEPRAMP_READY && x.begin() == STEPRAMP_READY && y.position() == 100);
    z.setRamp(250, 2000);
    CHECK(z.begin() == STEPRAMP_READY);
    rest_at(x, 500);
    rest_at(y, 0);
    rest_at(z, 100);
    CHECK(shortest_us[STEP] >= SLEW_US - 20 && shortest_us[STEP + 1] >= 2 * SLEW_US - 20 && shortest_us[14] >= 4 * SLEW_US - 20);
}

/* A run at a speed, and a stop in flight. */
static void axis_in_flight()
{
    static StepRampAxis x(STEP, DIRECTION);
    x.setRamp(1000, 2000);
    CHECK(x.begin() == STEPRAMP_READY && x.runAt(-1001) == STEPRAMP_OUT_OF_RANGE);
    const float wrong[] = {INFINITY, -INFINITY, NAN, 1e9f, -1e9f, 1e-9f};
    for (float speed : wrong) {
        CHECK(x.runAt(speed) == STEPRAMP_OUT_OF_RANGE);
    }
    CHECK(x.runAt(-500) == STEPRAMP_OK);
    poll_for(2000000);
    CHECK(shortest_us[STEP] >= 2 * SLEW_US - 20 && x.isMoving());
    x.stop();
    poll_until_rest();
    int32_t rests = x.position();
    CHECK(rests < -800 && rests == -edges[STEP] / 2 && x.setPosition(10) == STEPRAMP_OK && x.position() == 10);
    CHECK(x.runAt(500) == STEPRAMP_OK);
    poll_for(500000);
    x.halt();
    CHECK(!x.isMoving());
}

/* An emergency stop: no step comes after it, nor before it is released and acknowledged. */
static void emergency_stop()
{
    static StepRampAxis x(STEP, DIRECTION);
    CHECK(!StepRamp.setEmergencyStop(STOP_PIN)); /* only poll() sees it here */
    StepRamp.setDriverFault(FAULT_PIN);
    x.setRamp(1000, 2000);
    CHECK(x.begin() == STEPRAMP_READY && is_pulled_up[STOP_PIN] && is_pulled_up[FAULT_PIN]);
    CHECK(StepRamp.stoppedBy() == STEPRAMP_BY_NOTHING && x.setPosition(0) == STEPRAMP_OK && x.isHomed());
    for (uint8_t pin = STOP_PIN; pin <= FAULT_PIN; pin++) {
        uint8_t cause = pin == STOP_PIN ? STEPRAMP_BY_EMERGENCY_STOP : STEPRAMP_BY_DRIVER_FAULT;
        CHECK(x.runAt(900) == STEPRAMP_OK);
        poll_for(700000);
        is_grounded[pin] = true;
        poll_for(pin == STOP_PIN ? 30 : 6000);
        int there = place;
        CHECK(!x.isMoving() && StepRamp.stoppedBy() == cause && x.position() == there);
        poll_for(20000);
        CHECK(place == there && !x.isHomed() && !StepRamp.acknowledge() && x.move(5) == STEPRAMP_STOPPED);
        is_grounded[pin] = false;
        poll_for(20000);
        CHECK(StepRamp.stoppedBy() == cause && x.moveTo(0) == STEPRAMP_STOPPED && x.runAt(10) == STEPRAMP_STOPPED);
        CHECK(x.moveTo(there) == STEPRAMP_STOPPED && x.move(0) == STEPRAMP_STOPPED && x.runAt(0) == STEPRAMP_STOPPED);
        CHECK(!x.isMoving() && x.setPosition(there) == STEPRAMP_OK && x.isHomed() && x.begin() == STEPRAMP_READY);
        CHECK(StepRamp.acknowledge() && StepRamp.stoppedBy() == STEPRAMP_BY_NOTHING && x.move(5) == STEPRAMP_OK);
        poll_until_rest();
        CHECK(place == there + 5 && x.position() == place);
    }
}

/* Pressed at each moment of a round, released and acknowledged before the next one: what isn't told yet can't be acknowledged. */
static void short_stop()
{
    static StepRampAxis x(STEP, DIRECTION);
    StepRamp.setEmergencyStop(STOP_PIN);
    x.setRamp(1000, 8000);
    CHECK(x.begin() == STEPRAMP_READY);
    for (unsigned long after_us = 1; after_us < 40; after_us++) {
        CHECK(x.runAt(900) == STEPRAMP_OK);
        poll_for(150000);
        grounds_us = now_us + after_us;
        StepRamp.poll();
        grounds_us = ULONG_MAX;
        is_grounded[STOP_PIN] = false;
        int there = place;
        StepRamp.acknowledge();
        poll_for(20000);
        CHECK(x.isMoving() == (place > there + 10));
        x.stop();
        poll_until_rest();
        poll_for(6000);
        CHECK(StepRamp.acknowledge() && x.position() == place);
    }
}

/* Homing comes to the same step each time; the way into a switch is closed, the way back is free. */
static void home()
{
    static StepRampAxis x(STEP, DIRECTION), y(STEP + 1, DIRECTION + 1);
    low_switch_at = -37;
    high_switch_at = 900;
    x.setLimitSwitches(LOW_SWITCH, HIGH_SWITCH, STEPRAMP_AT_ONCE);
    x.setRamp(1000, 4000);
    CHECK(x.home(-500, 100) == STEPRAMP_NO_RAMP && x.begin() == STEPRAMP_READY && !x.isHomed() && !y.isHomed());
    CHECK(x.home(-500, 0) == STEPRAMP_OUT_OF_RANGE && x.home(0, 100) == STEPRAMP_OUT_OF_RANGE);
    CHECK(x.home(-1100, 100) == STEPRAMP_OUT_OF_RANGE && x.home(-500, 1100) == STEPRAMP_OUT_OF_RANGE);
    CHECK(StepRamp.home(1, -8000, 40000) == STEPRAMP_OUT_OF_RANGE && StepRamp.home(2, -8000, 40000) == STEPRAMP_OUT_OF_RANGE);
    for (int way = 0; way < 5; way++) {
        CHECK(x.move(50 + 31 * way) == STEPRAMP_OK);
        poll_until_rest();
        CHECK(x.home(-500, 100) == STEPRAMP_OK && x.isHoming() && x.isMoving() && !x.isHomed());
        CHECK(x.move(1) == STEPRAMP_MOVING && x.setPosition(1) == STEPRAMP_MOVING && x.home(-500, 100) == STEPRAMP_MOVING);
        poll_until_rest();
        CHECK(x.isHomed() && !x.isHoming() && place - x.position() == -36);
    }
    CHECK(x.runAt(-500) == STEPRAMP_AT_LIMIT || !x.isAtLimit());
    CHECK(x.moveTo(5000) == STEPRAMP_OK);
    poll_until_rest();
    CHECK(x.isAtLimit() && place >= 900 && place < 910 && x.move(1) == STEPRAMP_AT_LIMIT && !x.isHomed());
    CHECK(x.home(500, 100, 10) == STEPRAMP_OK);
    poll_for(30000);
    x.stop();
    poll_until_rest();
    CHECK(!x.isHoming() && !x.isHomed() && x.moveTo(0) == STEPRAMP_OK);
    poll_until_rest();
}

/* The second one sets out the other way, with other speeds and steps, in whatever stage the first one is. */
static void two_homes()
{
    static StepRampAxis x(STEP, DIRECTION), y(STEP + 1, DIRECTION + 1);
    low_switch_at = -37;
    second_switch_at = 400;
    x.setLimitSwitches(LOW_SWITCH);
    y.setLimitSwitches(STEPRAMP_NO_PIN, SECOND_SWITCH);
    x.setRamp(1000, 4000);
    y.setRamp(1000, 4000);
    CHECK(x.begin() == STEPRAMP_READY && y.begin() == STEPRAMP_READY);
    CHECK(x.home(-500, 100, 0) == STEPRAMP_OUT_OF_RANGE);
    for (unsigned long later_us = 0; later_us < 1500000; later_us += 125000) {
        CHECK(x.moveTo(100) == STEPRAMP_OK && y.moveTo(-50) == STEPRAMP_OK);
        poll_until_rest();
        CHECK(x.home(-500, 100, 50) == STEPRAMP_OK);
        poll_for(later_us);
        CHECK(y.home(800, 150, 10) == STEPRAMP_OK);
        poll_until_rest();
        CHECK(x.isHomed() && place - x.position() == -36);
        CHECK(y.isHomed() && second_place - y.position() == 399);
    }
}

/* While the position is known: nowhere beyond, and a run comes to rest at the last step that is allowed. */
static void soft_limits()
{
    static StepRampAxis x(STEP, DIRECTION);
    x.setSoftLimits(-50, 300);
    x.setRamp(1000, 4000);
    CHECK(x.begin() == STEPRAMP_READY && !x.isHomed() && x.moveTo(310) == STEPRAMP_OK);
    poll_until_rest();
    CHECK(place == 310 && x.setPosition(310) == STEPRAMP_OK && x.isHomed());
    CHECK(x.moveTo(301) == STEPRAMP_AT_LIMIT && x.runAt(500) == STEPRAMP_AT_LIMIT && x.moveTo(-51) == STEPRAMP_AT_LIMIT);
    CHECK(x.runAt(-500) == STEPRAMP_OK);
    poll_until_rest();
    CHECK(x.position() == -50 && place == -50 && x.move(-1) == STEPRAMP_AT_LIMIT && x.moveTo(300) == STEPRAMP_OK);
    poll_until_rest();
    CHECK(place == 300);
}

/* What inputs can't be is found by begin(). */
static void bad_inputs()
{
    static StepRampAxis x(STEP, DIRECTION);
    x.setRamp(1000, 2000);
    x.setLimitSwitches(LOW_SWITCH);
    StepRamp.setInputLooks(11);
    CHECK(x.begin() == STEPRAMP_BAD_IMAGE);
    StepRamp.setInputLooks(10);
    CHECK(x.begin() == STEPRAMP_READY);
    for (uint8_t pin = 10; pin < 16; pin++) {
        StepRamp.setEmergencyStop(pin);
    }
    CHECK(x.begin() == STEPRAMP_READY);
    StepRamp.setHighLimit(0, STEP);
    CHECK(x.begin() == STEPRAMP_BAD_PINS);
    StepRamp.setEmergencyStop(16);
    CHECK(x.begin() == STEPRAMP_BAD_PINS && !StepRamp.begin(image, image_bytes));
}

/* A switch can't be two things at once, as one of two axes is: the first would silently be forgotten. */
static void shared_inputs()
{
    static StepRampAxis x(STEP, DIRECTION), y(STEP + 1, DIRECTION + 1);
    x.setRamp(1000, 4000);
    x.setLimitSwitches(LOW_SWITCH);
    x.setLimitSwitches(LOW_SWITCH, STEPRAMP_NO_PIN, STEPRAMP_AT_ONCE);
    CHECK(x.begin() == STEPRAMP_READY);
    y.setLimitSwitches(LOW_SWITCH);
    CHECK(x.begin() == STEPRAMP_BAD_PINS && strcmp((const char *)x.problem(), "a pin is used twice or isn't there") == 0);
}

static void shared_stop()
{
    static StepRampAxis x(STEP, DIRECTION);
    x.setRamp(1000, 4000);
    StepRamp.setDriverFault(STOP_PIN);
    StepRamp.setEmergencyStop(STOP_PIN);
    CHECK(x.begin() == STEPRAMP_BAD_PINS && !StepRamp.begin(image, image_bytes));
}

/* 75 minutes of motion, past the last position, too: micros() comes round at their beginning, and once more. poll() is called
 * each 2 ms, so that a step of 10 ms is late by up to that. */
static void for_75_minutes()
{
    static StepRampAxis x(STEP, DIRECTION);
    now_us = UINT32_MAX - 1000000ul;
    x.setRamp(100, 1000);
    CHECK(x.begin() == STEPRAMP_READY && x.setPosition(INT32_MAX - 300000) == STEPRAMP_OK && x.runAt(100) == STEPRAMP_OK);
    for (int minutes = 0; minutes < 75; minutes++) {
        uint32_t from = (uint32_t)x.position();
        for (unsigned long end = now_us + 60000000; now_us < end; now_us += 2000) {
            CHECK(x.run());
        }
        uint32_t made = (uint32_t)x.position() - from;
        CHECK(made > 60000 / 12 && made <= 60000 / 10 + 1);
    }
    CHECK(now_us > UINT32_MAX + 1ul && shortest_us[STEP] >= 10000 - 20);
    x.stop();
    poll_until_rest();
    CHECK(x.position() == (int32_t)((uint32_t)INT32_MAX - 300000u + (uint32_t)edges[STEP] / 2) && x.position() < 0);
    CHECK(x.stepsToGo() == 0 && x.move(-7) == STEPRAMP_OK && x.stepsToGo() == -7);
    int made = edges[STEP];
    poll_until_rest();
    CHECK(edges[STEP] == made + 14 && level[DIRECTION] == LOW);
}

/* Before the first good begin() nothing happens, and nothing bad. */
static void early_poll()
{
    static StepRampAxis x(STEP, DIRECTION);
    StepRamp.setEmergencyStop(STOP_PIN);
    StepRamp.setLowLimit(0, LOW_SWITCH);
    poll_for(10000);
    StepRamp.setPulseWidth(101);
    CHECK(!StepRamp.begin(image, image_bytes));
    poll_for(10000);
    x.setRamp(1000, 2000);
    CHECK(x.begin() == STEPRAMP_BAD_IMAGE && !x.run());
    StepRamp.setPulseWidth(0);
    CHECK(x.begin() == STEPRAMP_READY);
    rest_at(x, 100);
}

static void early_poll_without_inputs()
{
    StepRamp.poll();
    CHECK(!StepRamp.begin(image, 1));
    StepRamp.poll();
    begin();
}

/* What isn't on the line is at rest, and is left so: what takes it along would take the line's axes, too. */
static void beside_a_line()
{
    const int32_t way[] = {400, 0};
    begin();
    CHECK(StepRamp.lineBy(way) == STEPRAMP_OK);
    poll_for(100000);
    CHECK(!StepRamp.isMoving(1) && StepRamp.zero(1, 100) == STEPRAMP_MOVING && StepRamp.setPosition(1, 7) == STEPRAMP_MOVING);
    CHECK(StepRamp.moveTo(1, 5) == STEPRAMP_MOVING && StepRamp.home(1, -4000, 8000) == STEPRAMP_MOVING);
    poll_until_rest();
    CHECK(place == 400 && StepRamp.position(0) == 400 && StepRamp.position(1) == 0 && edges[STEP + 1] == 0);
    CHECK(StepRamp.zero(1, 100) == STEPRAMP_OK);
    poll_until_rest();
    CHECK(second_place == -100 && StepRamp.position(1) == 0);
}

/* Drivers that are let go at rest aren't between the stages of homing. */
static void home_without_hold()
{
    static StepRampAxis x(STEP, DIRECTION);
    low_switch_at = -37;
    StepRamp.setEnablePin(ENABLE);
    StepRamp.setEnableHold(0);
    x.setLimitSwitches(LOW_SWITCH);
    x.setRamp(1000, 4000);
    CHECK(x.begin() == STEPRAMP_READY);
    poll_for(3000);
    int before = edges[ENABLE];
    CHECK(x.home(-500, 100) == STEPRAMP_OK);
    poll_until_rest();
    poll_for(3000);
    CHECK(x.isHomed() && edges[ENABLE] - before == 2 && level[ENABLE] == HIGH);
}

/* Two axes that are too much for the board at once: the other one is refused as long as the first is homed, between its stages, too. */
static void home_beside_another()
{
    static StepRampAxis x(STEP, DIRECTION), y(STEP + 1, DIRECTION + 1);
    has_timer = true;
    low_switch_at = -300;
    x.setLimitSwitches(LOW_SWITCH);
    x.setRamp(8000, 400000);
    y.setRamp(20000, 40000);
    CHECK(x.begin() == STEPRAMP_READY && x.home(-7500, 7500, 200) == STEPRAMP_OK);
    for (unsigned long end = now_us + 9000000; x.isHoming();) {
        CHECK(now_us < end && (y.runAt(20000) == STEPRAMP_TOO_FAST));
        StepRamp.poll();
    }
    CHECK(x.isHomed() && y.runAt(20000) == STEPRAMP_OK);
}

/* With the lowest above the highest it goes nowhere, with the utmost positions, too. */
static void soft_limits_the_wrong_way_round()
{
    static StepRampAxis x(STEP, DIRECTION);
    x.setSoftLimits(INT32_MAX, INT32_MIN);
    x.setRamp(1000, 4000);
    CHECK(x.begin() == STEPRAMP_READY && x.setPosition(0) == STEPRAMP_OK && x.isHomed());
    CHECK(x.moveTo(10) == STEPRAMP_AT_LIMIT && x.runAt(500) == STEPRAMP_AT_LIMIT && x.runAt(-500) == STEPRAMP_AT_LIMIT);
}

/* A line that is stopped before its first step has gone nowhere. */
static void a_line_that_is_not_begun()
{
    const int32_t way[] = {100, 50};
    StepRamp.setSoftLimits(0, -100000, 100000);
    begin();
    for (unsigned long after_us = 0; after_us < 20000; after_us += 500) {
        int before = place;
        CHECK(StepRamp.setPosition(0, place) == STEPRAMP_OK && StepRamp.setPosition(1, second_place) == STEPRAMP_OK);
        CHECK(StepRamp.lineBy(way) == STEPRAMP_OK);
        poll_for(after_us);
        if (after_us % 1000 == 0) {
            StepRamp.halt();
        } else {
            StepRamp.stop();
        }
        CHECK(place != before || (StepRamp.isHomed(0) && StepRamp.isHomed(1)));
        poll_until_rest();
    }
}

/* Halted at one step after another of a move: known is only where a motor is that was about as slow as at its ramp's first steps. */
static void halt_everywhere(StepRampAxis &axis, int32_t steps, int32_t from, int32_t stride, unsigned long slowest_us)
{
    int known = 0;
    for (; from <= steps; from += stride) {
        int32_t before = place;
        CHECK(axis.setPosition(0) == STEPRAMP_OK && axis.isHomed() && axis.moveTo(steps) == STEPRAMP_OK);
        while (place - before < from) {
            StepRamp.poll();
        }
        axis.halt();
        bool is_slow = from == 1 || last_us[STEP] >= slowest_us;
        CHECK(is_slow || !axis.isHomed());
        known += axis.isHomed();
        poll_for(20000);
    }
    CHECK(known > 0);
}

static void known_positions()
{
    static StepRampAxis x(STEP, DIRECTION);
    has_timer = true;
    x.setSoftLimits(-1000000, 1000000);
    x.setRamp(10000, 400000);
    CHECK(x.begin() == STEPRAMP_READY && StepRamp.ticksPerSecond() == 16000000);
    halt_everywhere(x, 1000, 1, 1, 700); /* the last intervals are 710, 926 and 2236 us: an event early it has the one that follows */
    x.setRamp(2000, 100000, 0, 1800);
    CHECK(x.begin() == STEPRAMP_READY);
    halt_everywhere(x, 30, 1, 1, 500);
}

/* At a speed whose interval is long to the queue it is as fast in each of its parts. */
static void known_positions_of_long_intervals()
{
    static StepRampAxis x(STEP, DIRECTION);
    has_timer = true;
    x.setSoftLimits(-1000000, 1000000);
    x.setRamp(400, 1000);
    CHECK(x.begin() == STEPRAMP_READY);
    for (unsigned long after_us = 0; after_us < 5000; after_us += 100) {
        CHECK(x.setPosition(0) == STEPRAMP_OK && x.runAt(300) == STEPRAMP_OK);
        poll_for(500000 + after_us);
        x.halt();
        CHECK(!x.isHomed());
    }
}

/* One that is refused doesn't choose the clock of the others. */
static void clock_of_the_good()
{
    static StepRampAxis x(STEP, DIRECTION), y(STEP + 1, DIRECTION + 1);
    has_timer = true;
    x.setRamp(1000, 4000);
    y.setRamp(0.5f, -1);
    CHECK(x.begin() == STEPRAMP_READY && StepRamp.ticksPerSecond() == 16000000);
    CHECK(y.begin() == STEPRAMP_BAD_ACCELERATION);
    y.setRamp(0.5f, 1);
    CHECK(y.begin() == STEPRAMP_READY && StepRamp.ticksPerSecond() == 2000000);
    y.setRamp(0.5f, 1e9f);
    CHECK(x.begin() == STEPRAMP_READY && StepRamp.ticksPerSecond() == 16000000);
}

static void shared_pins()
{
    static StepRampAxis x(STEP, DIRECTION), y(DIRECTION, 9), z(10, 10);
    CHECK(x.begin() == STEPRAMP_BAD_PINS && y.begin() == STEPRAMP_BAD_PINS && z.begin() == STEPRAMP_BAD_PINS);
}

/* The enable pin has a pin of its own, too, and an axis has both of its pins. */
static void enable_and_missing_pins()
{
    static StepRampAxis x(STEP, DIRECTION), y(STEP + 1, STEPRAMP_NO_PIN);
    x.setRamp(1000, 2000);
    y.setRamp(1000, 2000);
    const uint8_t taken[] = {STEP, DIRECTION, STEP + 1};
    for (uint8_t pin : taken) {
        StepRamp.setEnablePin(pin);
        CHECK(x.begin() == STEPRAMP_BAD_PINS && !StepRamp.begin(image, image_bytes));
    }
    CHECK(strcmp((const char *)x.problem(), "a pin is used twice or isn't there") == 0);
    StepRamp.setEnablePin(ENABLE);
    CHECK(x.begin() == STEPRAMP_READY && y.begin() == STEPRAMP_BAD_PINS && y.moveTo(1) == STEPRAMP_NO_RAMP);
    rest_at(x, 10);
    StepRamp.setDriverFault(ENABLE);
    CHECK(x.begin() == STEPRAMP_BAD_PINS);
}

static void too_many_axes()
{
    static StepRampAxis all[] = {{2, 5}, {3, 6}, {4, 7}, {12, 13}, {14, 15}};
    for (StepRampAxis &axis : all) {
        axis.setRamp(100, 1000);
    }
    CHECK(all[4].begin() == STEPRAMP_TOO_MANY && all[4].moveTo(1) == STEPRAMP_NO_RAMP);
    CHECK(all[3].begin() == STEPRAMP_READY && all[0].begin() == STEPRAMP_READY && all[3].moveTo(7) == STEPRAMP_OK);
    poll_until_rest();
    CHECK(all[3].position() == 7 && edges[12] == 14);
}

int main(int count, char **words)
{
    static const struct {
        const char *name;
        void (*play)();
    } SCENARIOS[] = {{"refuse", refuse}, {"move", move},           {"run", run},
                     {"set", set},       {"delay_loop", delay_loop}, {"gauge", gauge},
                     {"axes", axes},     {"refused_begin", refused_begin}, {"begin_in_flight", begin_in_flight}, {"begin_together", begin_together},
                     {"enable_and_missing_pins", enable_and_missing_pins}, {"axis_in_flight", axis_in_flight}, {"another_begins", another_begins}, {"slow_ramps", slow_ramps},
                     {"too_many_axes", too_many_axes},
                     {"shared_pins", shared_pins}, {"shared_inputs", shared_inputs}, {"shared_stop", shared_stop},
                     {"for_75_minutes", for_75_minutes},
                     {"emergency_stop", emergency_stop}, {"home", home}, {"two_homes", two_homes}, {"soft_limits", soft_limits}, {"short_stop", short_stop}, {"bad_inputs", bad_inputs},
                     {"early_poll", early_poll},
                     {"early_poll_without_inputs", early_poll_without_inputs},
                     {"beside_a_line", beside_a_line},
                     {"home_without_hold", home_without_hold},
                     {"home_beside_another", home_beside_another},
                     {"soft_limits_the_wrong_way_round", soft_limits_the_wrong_way_round},
                     {"a_line_that_is_not_begun", a_line_that_is_not_begun},
                     {"known_positions", known_positions},
                     {"known_positions_of_long_intervals", known_positions_of_long_intervals},
                     {"clock_of_the_good", clock_of_the_good}};
    CHECK(count == 3);
    unsigned byte;
    for (const char *text = words[2]; sscanf(text, "%2x", &byte) == 1; text += 2) {
        image[image_bytes++] = (uint8_t)byte;
    }
    for (const auto &scenario : SCENARIOS) {
        if (strcmp(words[1], scenario.name) == 0) {
            scenario.play();
            return 0;
        }
    }
    CHECK(!"no such scenario");
}
