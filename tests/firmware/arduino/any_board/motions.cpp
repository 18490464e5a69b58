/* Motions of the class StepRamp, along a ramp that is given. */
#include "board.h"
#include "scenarios.h"

void refuse()
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

void move()
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

void run()
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

void set()
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
void delay_loop()
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
void gauge()
{
    StepRamp.setGauge(0, 10, 11, 12, 13);
    begin();
    CHECK(level[10] == HIGH && level[11] == LOW && level[12] == LOW && level[13] == HIGH && is_output[13]);
    CHECK(StepRamp.zero(0, 8) == STEPRAMP_OK);
    poll_until_rest();
    CHECK(StepRamp.position(0) == 0 && edges[STEP] == 0);
    CHECK(level[10] == LOW && level[11] == HIGH && level[12] == HIGH && level[13] == HIGH); /* 8 back is 4 on */
}

/* 75 minutes of motion, past the last position, too: micros() comes round at their beginning, and once more. poll() is called
 * each 2 ms, so that a step of 10 ms is late by up to that. */
void for_75_minutes()
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

void early_poll_without_inputs()
{
    StepRamp.poll();
    CHECK(!StepRamp.begin(image, 1));
    StepRamp.poll();
    begin();
}

/* What isn't on the line is at rest, and is left so: what takes it along would take the line's axes, too. */
void beside_a_line()
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

/* A line that is stopped before its first step has gone nowhere. */
void a_line_that_is_not_begun()
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
