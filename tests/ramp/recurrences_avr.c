/* The step-by-step methods as avr-gcc computes them in float, sent over the serial port: four bytes an interval, up and
 * then down, each in order of time. Built with the bits of the constants:
 * -DMETHOD=20|22|23|0 (0: newton) -DSTEPS=n -DP1=0x… -DPS=0x… -DR=0x… -DK=0x… -DGAIN=0x… -DW_UP=0x… -DW_DOWN=0x… */
#include <avr/io.h>
#include <stdint.h>

union number {
    uint32_t bits;
    float value;
};

static float number(uint32_t bits)
{
    union number it = {.bits = bits};
    return it.value;
}

static void send(float value)
{
    union number it = {.value = value};
    for (uint8_t i = 0; i < 4; i++) {
        while (!(UCSR0A & _BV(UDRE0))) {
        }
        UDR0 = (uint8_t)(it.bits >> (8 * i));
    }
}

static float next(float p, float m)
{
    float q = m * p * p;
#if METHOD == 20
    return p * (1 + q);
#elif METHOD == 22
    return p * (1.0f + q + 1.5f * q * q);
#else
    return p * (1 + q + q * q);
#endif
}

static float clamped(float p)
{
    return p < number(PS) ? number(PS) : p > number(P1) ? number(P1) : p;
}

static void play(float p, float m, float w, float gain, uint8_t first_is_given)
{
    for (uint16_t i = 0; i < STEPS; i++) {
        if (i != 0 || !first_is_given) {
            if (METHOD == 0) {
                w = w + gain;
                p = p + p * (1 - w * number(K) * p * p) * 0.5f;
            } else {
                p = clamped(next(p, m));
            }
        }
        send(p);
    }
}

int main(void)
{
    UCSR0A = _BV(U2X0);
    UBRR0 = 16;
    UCSR0B = _BV(RXEN0) | _BV(TXEN0);
    /* A byte from outside says that somebody listens. */
    while (!(UCSR0A & _BV(RXC0))) {
    }
    play(number(P1), -number(R), number(W_UP), number(GAIN), 1);
    play(number(PS), number(R), number(W_DOWN), -number(GAIN), 0);
    for (;;) {
    }
}
