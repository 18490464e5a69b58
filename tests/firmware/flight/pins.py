"""Pulses and directions, and halts."""

import numpy as np

from firmware.checker import CYCLES_PER_S, CYCLES_PER_US
from firmware.flight.exchange import ORDERS
from firmware.flight.judgement import Judgement, at, us
from firmware.flight.motion import Flight
from firmware.protocol import HALT

LEAST_PULSE_US = 1.0

LAST_STEP_AFTER_HALT_MS = 2.0


def judge_pins(flight: Flight, found: Judgement) -> None:
    """Pulses long enough and complete, the direction set in time, and only at rest."""
    made, settings = flight.made, flight.setting.settings
    width = max(settings.pulse_width_us, LEAST_PULSE_US) * CYCLES_PER_US
    if not settings.both_edges >> flight.axis & 1:
        if made.ends.size != made.steps.size or (made.ends <= made.steps).any():
            found.add(f"axis {flight.axis}: a pulse without an end")
        elif made.steps.size:
            pulses, pauses = made.ends - made.steps, made.steps[1:] - made.ends[:-1]
            if pulses.min() < width:
                found.add(f"axis {flight.axis}: a pulse of {us(pulses.min())} {at(made.steps[pulses.argmin()])}")
            if pauses.size and pauses.min() < LEAST_PULSE_US * CYCLES_PER_US:
                found.add(f"axis {flight.axis}: a pause of {us(pauses.min())} {at(made.ends[pauses.argmin()])}")
    for turn in made.turns:
        after = int(np.searchsorted(made.steps, turn))
        if after < made.steps.size and made.steps[after] - turn < settings.direction_setup_us * CYCLES_PER_US:
            found.add(f"axis {flight.axis}: a step {us(made.steps[after] - turn)} after the direction {at(turn)}")


def judge_halts(flight: Flight, found: Judgement) -> None:
    """No step long after a halt."""
    for number, one in enumerate(flight.orders):
        if one.kind != HALT:
            continue
        later = [other.arrived for other in flight.orders[number + 1 :] if other.kind in ORDERS]
        first, end = np.searchsorted(flight.made.steps, [one.arrived, min(later, default=np.inf)])
        if end > first:
            last_ms = (flight.made.steps[end - 1] - one.arrived) / CYCLES_PER_S * 1e3
            if last_ms > LAST_STEP_AFTER_HALT_MS:
                found.add(f"axis {flight.axis}: a step {last_ms:.2f} ms after a halt {at(one.arrived)}")
