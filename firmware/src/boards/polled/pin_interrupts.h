/* The interrupts of Arduino's core are handed over from the sketch: so a sketch without an emergency stop keeps them for its own ISRs,
 * as the core takes all of INT0, INT1 and so on, as soon as anything linked names attachInterrupt. For StepRamp.h. */
#ifndef STEPRAMP_PIN_INTERRUPTS_H
#define STEPRAMP_PIN_INTERRUPTS_H

#ifdef ARDUINO_ARCH_AVR
#define STEPRAMP_ATTACH attachInterrupt
#else
#define STEPRAMP_ATTACH nullptr
#endif

inline bool StepRampClass::setEmergencyStop(uint8_t pin, uint8_t how)
{
    return addEmergencyStop(pin, how, STEPRAMP_ATTACH);
}

inline void StepRampClass::setInputPin(uint8_t input, uint8_t pin)
{
    addInput(input, pin, STEPRAMP_ATTACH);
}

#undef STEPRAMP_ATTACH

#endif
