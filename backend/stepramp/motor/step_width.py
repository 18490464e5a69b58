"""How short the steps of the integration have to be for a motor's model.

What oscillates has to be resolved: the rotor in the field of its phases, in its detent, and against the inductance of
its windings, whose current and speed swing with K_m / √(L J). docs/motor.md.
"""

import math

from stepramp.numerics.drive_train import DriveTrain

LONGEST_STEP_S = 20e-6
"""While pulses come a step of the integration is at most so long: between two of them currents change."""
PARTS_OF_A_PERIOD = 200
"""And at most such a part of the natural period."""
MOST_RAD = 0.2
"""And at most such a part of a radian of the faster oscillations, of which no more is asked than that they stay what
they are: 2 is where they grow."""
SETTLING_PERIODS = 12
"""So long the rotor is watched after the last interval [natural periods]."""


def integration_step_s(train: DriveTrain) -> float:
    """Return how long a step of the integration is at most, while pulses come [s]."""
    return min(LONGEST_STEP_S, settling_step_s(train))


def settling_step_s(train: DriveTrain) -> float:
    """Return the same once the last pulse has come: a heavy load swings slowly, and nothing else is left to see [s]."""
    inertia, constant = train.inertia_kg_m2, train.torque_constant_nm_per_a
    coupled = constant / math.sqrt(train.inductance_h * inertia)
    in_detent = math.sqrt(4 * train.periods_per_rev * train.detent_nm / inertia)
    return min(1 / (PARTS_OF_A_PERIOD * train.natural_frequency_hz), MOST_RAD / max(coupled, in_detent))


def settling_steps(train: DriveTrain) -> int:
    """Return how many steps of the integration follow the last interval [steps of the integration]."""
    return math.ceil(SETTLING_PERIODS / train.natural_frequency_hz / settling_step_s(train))
