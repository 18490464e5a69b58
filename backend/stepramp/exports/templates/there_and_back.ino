static bool isWayBackDue = false;
static unsigned long movedAt_ms;

/* Does what the button says: there, a rest, and back; a press on its way ends both. */
static void goThereAndBack() {
  const bool isPressed = isPressedAnew();
  if (isMoving()) {
    movedAt_ms = millis();
    if (isPressed) {
      slowDown();
      isWayBackDue = false;
    }
  } else if (isPressed) { /* while it rests before the way back: stay */
    if (!isWayBackDue) {
      moveBy(STEPS);
    }
    isWayBackDue = !isWayBackDue;
    movedAt_ms = millis();
  } else if (isWayBackDue && millis() - movedAt_ms >= REST_MS) {
    isWayBackDue = false;
    moveBy(-STEPS);
  }
}