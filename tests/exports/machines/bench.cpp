/* A bench for exported sketches on this machine: a clock that only the bench moves on, a button, and libraries that print
 * what they are told. Its gauge plays a table by the words of "A Simplified Acceleration Model" (SwitecX25, 2012).
 *
 * Arguments: when the button is pressed [ms], for 100 ms each; the bench ends 10 s after the last press. */
#include <stdio.h>
#include <stdlib.h>

#include <Arduino.h>
#include LIBRARY

static unsigned long now_us;
static unsigned long pressed_at_ms[8];
static int presses;

void pinMode(uint8_t, uint8_t) {}
void digitalWrite(uint8_t pin, uint8_t value) { printf("%lu pin %d %d\n", now_us, pin, value); }
unsigned long millis() { return now_us / 1000; }

int digitalRead(uint8_t)
{
    for (int press = 0; press < presses; press++)
        if (millis() - pressed_at_ms[press] < 100) return LOW;
    return HIGH;
}

/* A move takes 10 ms for each step here, whatever its ramp. */
static unsigned long rests_at_us;
static bool is_moving() { return now_us < rests_at_us; }
static void begin_move(long steps)
{
    printf("%lu move %ld\n", now_us, steps);
    rests_at_us = now_us + 10000UL * (unsigned long)labs(steps);
}
static void begin_stop()
{
    printf("%lu stop\n", now_us);
    rests_at_us = now_us;
}

#ifdef ACCEL_STEPPER_H
AccelStepper::AccelStepper(uint8_t, uint8_t, uint8_t, uint8_t, uint8_t, bool) {}
void AccelStepper::move(long steps) { begin_move(steps); }
bool AccelStepper::run() { return is_moving(); }
void AccelStepper::setMaxSpeed(float speed) { printf("speed %.9g\n", (double)speed); }
void AccelStepper::setAcceleration(float rate) { printf("acceleration %.9g\n", (double)rate); }
void AccelStepper::disableOutputs() {}
void AccelStepper::enableOutputs() {}
void AccelStepper::setMinPulseWidth(unsigned int) {}
void AccelStepper::setEnablePin(uint8_t) {}
void AccelStepper::setPinsInverted(bool, bool, bool) {}
void AccelStepper::stop() { begin_stop(); }
bool AccelStepper::isRunning() { return is_moving(); }
#endif

#ifdef FAST_ACCEL_STEPPER_H
static FastAccelStepper only;
void FastAccelStepper::setDirectionPin(uint8_t, bool, uint16_t) {}
void FastAccelStepper::setEnablePin(uint8_t, bool) {}
bool FastAccelStepper::enableOutputs() { return true; }
void FastAccelStepper::setAutoEnable(bool) {}
int8_t FastAccelStepper::setSpeedInMilliHz(uint32_t speed)
{
    printf("speed %u\n", (unsigned)speed);
    return speed > 50000000 ? -1 : 0;
}
int8_t FastAccelStepper::setAcceleration(int32_t rate)
{
    printf("acceleration %d\n", (int)rate);
    return 0;
}
void FastAccelStepper::setJumpStart(uint32_t steps) { printf("jump %u\n", (unsigned)steps); }
MoveResultCode FastAccelStepper::move(int32_t steps, bool)
{
    begin_move(steps);
    return MoveResultCode::OK;
}
void FastAccelStepper::stopMove() { begin_stop(); }
bool FastAccelStepper::isRunning() const { return is_moving(); }
void FastAccelStepperEngine::init() {}
FastAccelStepper *FastAccelStepperEngine::stepperConnectToPin(uint8_t) { return &only; }
#endif

#ifdef TEENSY_STEP_H
static long relative;
TeensyStep::Stepper::Stepper(const int, const int) {}
TeensyStep::Stepper &TeensyStep::Stepper::setMaxSpeed(int32_t speed) { printf("speed %d\n", (int)speed); return *this; }
TeensyStep::Stepper &TeensyStep::Stepper::setPullInSpeed(int32_t speed) { printf("pull-in %d\n", (int)speed); return *this; }
TeensyStep::Stepper &TeensyStep::Stepper::setAcceleration(uint32_t a) { printf("acceleration %u\n", (unsigned)a); return *this; }
void TeensyStep::Stepper::setTargetRel(int32_t steps) { relative = steps; }
TeensyStep::StepControl::StepControl(unsigned, unsigned) {}
void TeensyStep::StepControl::moveAsync(Stepper &) { begin_move(relative); }
void TeensyStep::StepControl::stopAsync() { begin_stop(); }
bool TeensyStep::StepControl::isRunning() { return is_moving(); }
#endif

#ifdef SWITEC_X25_H
SwitecX25::SwitecX25(unsigned int range, unsigned char, unsigned char, unsigned char, unsigned char)
    : currentStep(0), targetStep(0), steps(range), time0(0), microDelay(0), accelTable(nullptr), maxVel(0), vel(0), dir(0),
      stopped(true) {}
void SwitecX25::zero() { printf("%lu zero\n", now_us); }
void SwitecX25::setPosition(unsigned int wanted)
{
    targetStep = wanted < steps ? wanted : steps - 1;
    if (stopped) {
        stopped = false;
        time0 = now_us;
        microDelay = 0;
    }
}
void SwitecX25::update()
{
    if (stopped || now_us - time0 < microDelay) return;
    time0 = now_us;
    if (vel == 0) {
        if (currentStep == targetStep) {
            stopped = true;
            printf("%lu rest\n", now_us);
            return;
        }
        dir = currentStep < targetStep ? 1 : -1;
        vel = 1;
    }
    if (dir > 0 ? currentStep < steps : currentStep > 0) currentStep += (unsigned)dir;
    printf("%lu step %u\n", now_us, currentStep);
    const long left = ((long)targetStep - (long)currentStep) * dir;
    if (left < (long)vel) vel--; /* none left, or fewer than it takes to slow down */
    else if (vel < maxVel) vel++;
    unsigned row = 0;
    while (accelTable[row][0] < vel) row++;
    microDelay = accelTable[row][1];
}
#endif

#include SKETCH

int main(int count, char **words)
{
    (void)is_moving, (void)begin_move, (void)begin_stop; /* not with a gauge */
    for (int word = 1; word < count; word++) pressed_at_ms[presses++] = strtoul(words[word], nullptr, 10);
    const unsigned long end_us = 1000 * (presses ? pressed_at_ms[presses - 1] : 0) + 10000000UL;
    setup();
    for (; now_us < end_us; now_us += TICK_US) loop();
    return 0;
}
