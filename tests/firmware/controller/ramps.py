"""Ramps that the tests of the controller play."""

from firmware import protocol as p
from firmware.protocol import Ramp

RAMP = Ramp([(20_000, 1, 0), (14_142, 2, -2595), (10_000, 300, -20)], 2000, [(20_000, 2, -5858), (11_547, 40, -200)])
OTHER = Ramp([(5000, 60, -30)], 3000, [(5000, 60, -30)])
OLDER = Ramp([(9000, 7, -11), (7000, 9, -300)], 1234, [(8000, 5, -7)])
TWO_AXES = p.image_of([RAMP.packed(), OTHER.packed()], [0, 1])
FOUR_AXES = Ramp([(2000, 50, -20)], 1000, []).image(4)
