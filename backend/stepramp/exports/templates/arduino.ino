/* $title
 *
 * A sketch for an Arduino Uno, Nano or another board with an ATmega328P at 16 MHz: it moves a stepper motor there and
 * back. Nothing moves until the start button is pressed, also after a reset; then it makes STEPS steps, rests for REST_MS,
 * makes as many steps back, and waits for the button again. There is nothing that stops it on its way but the reset
 * button: then the pulses end at once, and a motor that was fast slips.
 *
 * Wire the driver's step input to pin 9, its direction to DIRECTION_PIN, its enable input, if it is used, to ENABLE_PIN,
 * the grounds together, and a button between START_PIN and ground. Pin 9 can't be another one: Timer1 itself makes the
 * pulses there, so that each begins in the very tick that it is planned for. Libraries that use Timer1, such as Servo,
 * and analogWrite() on pins 9 and 10 don't go with it.
 *
 * Method $method in $arithmetic, rounded: $rounding. F $timer_hz Hz, v0 $base_speed, v $slew_speed steps/s,
 * a $acceleration, d $deceleration steps/s^2$shape. Steps are the pulses of the driver, microsteps if it makes such.
 * Fastest $fastest steps/s, slowest $slowest steps/s. No interval is more than $bound from what StepRamp plans.
 *
 * The Arduino IDE wants this file in a folder of its name: $name/$name.ino. */
#include <Arduino.h>

#if !defined(__AVR_ATmega328P__) || F_CPU != 16000000L
#error "This sketch is for an ATmega328P at 16 MHz, as on an Arduino Uno or Nano."
#endif

/* ---- what you may change ---- */

const int32_t STEPS = $steps; /* below 0: backward first; shorter moves keep to the ramp */
const uint8_t DIRECTION_PIN = 5; /* high is forward */
const uint8_t ENABLE_PIN = 8; /* low enables the driver, from the first move on */
const uint8_t START_PIN = A2; /* a button to ground */
const uint16_t REST_MS = 500; /* before the way back */
const uint8_t PULSE_US = 3; /* a pulse lasts so long at least; some drivers want 5 */
const uint8_t DIRECTION_SETUP_US = 30; /* from the direction to the pulse, at least */

/* ---- the ramp ---- */

/* `count` intervals in ticks of F, the first `interval` long, each next one `add` longer. */
struct Segment {
  uint32_t interval;
  uint16_t count;
  int16_t add;
};

/* Both lists begin at the slow end: UP with the first interval of a move, DOWN with the last. A count of 0 is the end. */
const Segment UP[] PROGMEM = {
$up_lines
  {0, 0, 0},
};
const Segment DOWN[] PROGMEM = {
$down_lines
  {0, 0, 0},
};
const uint32_t SLEW = $slew;
const uint32_t UP_STEPS = $up_steps, DOWN_STEPS = $down_steps;

/* Where in a list one is. */
struct Cursor {
  const Segment *segment;
  uint32_t interval;
  uint16_t left; /* intervals of the segment, this one among them; 0: the list has ended */
  int16_t add;
};

static void load(Cursor &cursor, const Segment *segment) {
  cursor.segment = segment;
  cursor.interval = pgm_read_dword(&segment->interval);
  cursor.left = pgm_read_word(&segment->count);
  cursor.add = (int16_t)pgm_read_word(&segment->add);
}

/* Away from the slow end. */
static void advance(Cursor &cursor) {
  cursor.interval += (int32_t)cursor.add;
  if (--cursor.left == 0) {
    load(cursor, cursor.segment + 1);
  }
}

/* Towards the slow end; not from the first interval. */
static void goBack(Cursor &cursor) {
  const uint16_t count = pgm_read_word(&cursor.segment->count);
  if (cursor.left < count) {
    cursor.left++;
    cursor.interval -= (int32_t)cursor.add;
    return;
  }
  load(cursor, cursor.segment - 1);
  cursor.interval += (uint32_t)((int32_t)cursor.add * (int32_t)(cursor.left - 1));
  cursor.left = 1;
}

/* ---- the move ---- */

static Cursor up, down;
static uint32_t upLeft, slewLeft, downLeft; /* intervals still to be fetched */

/* A short move takes the slowest intervals of both lists: the longer of the two next ones, that of UP when they are
 * equal. */
static void planMove(uint32_t steps) {
  load(up, UP);
  load(down, DOWN);
  upLeft = downLeft = 0;
  if (steps >= UP_STEPS + DOWN_STEPS) {
    upLeft = UP_STEPS;
    downLeft = DOWN_STEPS;
    while (down.left != 0) {
      load(down, down.segment + 1);
    }
  } else {
    while (upLeft + downLeft < steps) {
      if (down.left == 0 || (up.left != 0 && up.interval >= down.interval)) {
        advance(up);
        upLeft++;
      } else {
        advance(down);
        downLeft++;
      }
    }
  }
  slewLeft = steps - upLeft - downLeft;
  load(up, UP);
}

static uint32_t nextInterval() {
  uint32_t interval = SLEW;
  if (upLeft != 0) {
    upLeft--;
    interval = up.interval;
    advance(up);
  } else if (slewLeft != 0) {
    slewLeft--;
  } else if (downLeft != 0) {
    downLeft--;
    goBack(down);
    interval = down.interval;
  }
  return interval;
}

/* ---- Timer1: it counts freely, and moves pin 9 itself where OCR1A says ---- */

const uint8_t STEP_PIN = 9; /* OC1A */
const uint8_t CLOCK = $clock_select; /* F = 16 MHz / $prescaler */
const uint8_t PIN_FALLS = _BV(COM1A1), PIN_RISES = _BV(COM1A1) | _BV(COM1A0);
const uint16_t LEAD_TICKS = $lead_ticks; /* from the order to the first pulse */

static uint32_t followingTicks; /* the interval after the next pulse */
static uint32_t waitTicks;      /* of the current interval: what comes after OCR1A */
static uint32_t pulsesLeft;
static volatile bool isMoving;

/* Sets when to be interrupted next: at the end of the interval, or on its way if the timer can't count so far. */
static void waitOn() {
  const uint16_t part = waitTicks > 0xFFFF ? 0x8000 : (uint16_t)waitTicks;
  waitTicks -= part;
  OCR1A += part;
}

ISR(TIMER1_COMPA_vect) {
  if (waitTicks != 0) {
    waitOn();
  } else if (pulsesLeft == 0) { /* the last interval is over */
    TIMSK1 = 0;
    isMoving = false;
    return;
  } else { /* a pulse has just begun */
    pulsesLeft--;
    waitTicks = followingTicks;
    waitOn();
    followingTicks = nextInterval();
    delayMicroseconds(PULSE_US);
    TCCR1A = PIN_FALLS;
    TCCR1C = _BV(FOC1A); /* now */
  }
  if (waitTicks == 0 && pulsesLeft != 0) {
    TCCR1A = PIN_RISES;
  }
}

static void moveBy(int32_t steps) {
  if (steps == 0) {
    return;
  }
  digitalWrite(DIRECTION_PIN, steps > 0 ? HIGH : LOW);
  delayMicroseconds(DIRECTION_SETUP_US);
  pulsesLeft = steps > 0 ? (uint32_t)steps : -(uint32_t)steps;
  planMove(pulsesLeft);
  followingTicks = nextInterval();
  waitTicks = 0;
  isMoving = true;
  noInterrupts();
  OCR1A = TCNT1 + LEAD_TICKS;
  TIFR1 = _BV(OCF1A);
  TCCR1A = PIN_RISES;
  TIMSK1 = _BV(OCIE1A);
  interrupts();
  while (isMoving) {
  }
}

/* ---- the button ---- */

static void waitForButton(uint8_t level) {
  for (uint8_t same_ms = 0; same_ms < 20; same_ms++) {
    delay(1);
    if (digitalRead(START_PIN) != level) {
      same_ms = 0;
    }
  }
}

void setup() {
  digitalWrite(ENABLE_PIN, HIGH);
  pinMode(ENABLE_PIN, OUTPUT);
  pinMode(DIRECTION_PIN, OUTPUT);
  pinMode(START_PIN, INPUT_PULLUP);
  TIMSK1 = 0;
  TCCR1A = PIN_FALLS;
  TCCR1B = CLOCK;
  TCCR1C = _BV(FOC1A);
  pinMode(STEP_PIN, OUTPUT);
}

void loop() {
  waitForButton(HIGH); /* a button that is held, or a wire to ground, starts nothing */
  waitForButton(LOW);
  digitalWrite(ENABLE_PIN, LOW);
  delay(1);
  moveBy(STEPS);
  delay(REST_MS);
  moveBy(-STEPS);
}
