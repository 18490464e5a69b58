/* Whether the button has been pressed just now; one that is held from the beginning, or a wire to ground, is not. */
static bool isPressedAnew() {
  static bool isDown = true, wasDown = true;
  static unsigned long changedAt_ms;
  const bool reads = digitalRead(START_PIN) == LOW;
  if (reads != wasDown) {
    wasDown = reads;
    changedAt_ms = millis();
  }
  if (reads == isDown || millis() - changedAt_ms < STEADY_MS) {
    return false;
  }
  isDown = reads;
  return isDown;
}