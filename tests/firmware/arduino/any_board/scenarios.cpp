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

static unsigned long now_us;
static int level[PINS], edges[PINS];
static bool is_output[PINS];
static unsigned long rose_us[PINS], shortest_us[PINS], shortest_pulse_us;
static uint8_t image[256];
static uint16_t image_bytes;

/* ---- the Arduino API ---- */

/* 32 bits, as on every board: they come round after 71.6 minutes, those of millis() after 49.7 days. */
unsigned long micros()
{
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
        shortest_us[pin] = shortest_us[pin] == 0 || since_us < shortest_us[pin] ? since_us : shortest_us[pin];
        rose_us[pin] = now_us;
    } else if (pin == STEP && (shortest_pulse_us == 0 || now_us - rose_us[pin] < shortest_pulse_us)) {
        shortest_pulse_us = now_us - rose_us[pin];
    }
}

int Print::availableForWrite()
{
    return 0;
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
    CHECK(x.begin() == STEPRAMP_RAMP_MISSING && strcmp((const char *)x.problem(), "begin() needs setRamp() before") == 0);
    CHECK(x.moveTo(1) == STEPRAMP_NO_RAMP && x.setPosition(1) == STEPRAMP_NO_RAMP && x.runAt(1) == STEPRAMP_NO_RAMP);
    x.setRamp(0, 2000);
    CHECK(x.begin() == STEPRAMP_BAD_SPEED);
    x.setRamp(NAN, 2000);
    CHECK(x.begin() == STEPRAMP_BAD_SPEED);
    x.setRamp(1.01f * StepRampAxis::mostSpeed(), 2000);
    CHECK(x.begin() == STEPRAMP_SPEED_TOO_HIGH);
    x.setRamp(1000, -1);
    CHECK(x.begin() == STEPRAMP_BAD_ACCELERATION);
    x.setRamp(1000, 0.01f);
    CHECK(x.begin() == STEPRAMP_BAD_ACCELERATION);
    x.setRamp(1000, 2000, 0, 1000);
    CHECK(x.begin() == STEPRAMP_BAD_BASE_SPEED);
    x.setRamp(1000, 2);
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

/* A run at a speed, and a stop in flight. */
static void axis_in_flight()
{
    static StepRampAxis x(STEP, DIRECTION);
    x.setRamp(1000, 2000);
    CHECK(x.begin() == STEPRAMP_READY && x.runAt(-1001) == STEPRAMP_OUT_OF_RANGE && x.runAt(-500) == STEPRAMP_OK);
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

static void shared_pins()
{
    static StepRampAxis x(STEP, DIRECTION), y(DIRECTION, 9), z(10, 10);
    CHECK(x.begin() == STEPRAMP_BAD_PINS && y.begin() == STEPRAMP_BAD_PINS && z.begin() == STEPRAMP_BAD_PINS);
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
                     {"axes", axes},     {"axis_in_flight", axis_in_flight}, {"too_many_axes", too_many_axes},
                     {"shared_pins", shared_pins}, {"for_75_minutes", for_75_minutes}};
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
