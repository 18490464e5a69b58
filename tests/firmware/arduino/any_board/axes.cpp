/* Axes as objects: what begin() says, and ramps that are computed. */
#include "board.h"
#include "scenarios.h"

/* Axes of a sketch: what begin() says, and moves along ramps that were computed. */
void axes()
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
void another_begins()
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
void slow_ramps()
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

/* A begin() that is refused leaves what was ready as it was, or not ready: nothing moves along a ramp that nobody asked for. */
void refused_begin()
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
void begin_in_flight()
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
void begin_together()
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
void axis_in_flight()
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

/* One that is refused doesn't choose the clock of the others. */
void clock_of_the_good()
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

void shared_pins()
{
    static StepRampAxis x(STEP, DIRECTION), y(DIRECTION, 9), z(10, 10);
    CHECK(x.begin() == STEPRAMP_BAD_PINS && y.begin() == STEPRAMP_BAD_PINS && z.begin() == STEPRAMP_BAD_PINS);
}

/* The enable pin has a pin of its own, too, and an axis has both of its pins. */
void enable_and_missing_pins()
{
    static StepRampAxis x(STEP, DIRECTION), y(STEP + 1, STEPRAMP_NO_PIN);
    x.setRamp(1000, 2000);
    y.setRamp(1000, 2000);
    const uint8_t taken[] = {STEP, DIRECTION, STEP + 1};
    for (uint8_t pin : taken) {
        StepRamp.setEnablePin(pin);
        CHECK(x.begin() == STEPRAMP_BAD_PINS && !StepRamp.begin(image, image_bytes));
    }
    CHECK(strcmp((const char *)x.problem(), "a pin is used twice or isn't there, or too many inputs") == 0);
    StepRamp.setEnablePin(ENABLE);
    CHECK(x.begin() == STEPRAMP_READY && y.begin() == STEPRAMP_BAD_PINS && y.moveTo(1) == STEPRAMP_NO_RAMP);
    rest_at(x, 10);
    StepRamp.setDriverFault(ENABLE);
    CHECK(x.begin() == STEPRAMP_BAD_PINS);
}

void too_many_axes()
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
