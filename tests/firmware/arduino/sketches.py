"""What stands in the examples: their ramps, and what these are meant to be."""

import re
from dataclasses import dataclass

from firmware.arduino.board import LIBRARY
from firmware.protocol import Ramp

TICKS_HZ = 2_000_000


def source_of(example: str) -> str:
    return (LIBRARY / "examples" / example / f"{example}.ino").read_text()


def image_in(example: str) -> bytes:
    """Return the bytes of RAMP in an example."""
    found = re.search(r"RAMP\[\] = \{(.*?)\};", source_of(example), re.DOTALL)
    assert found
    return bytes(int(byte, 16) for byte in re.findall(r"0x([0-9A-F]{2})", found[1]))


@dataclass(frozen=True)
class ExampleRamp:
    """The ramp of an example: what its comment says, and the segments that come close to it."""

    speed: float
    acceleration: float
    deceleration: float
    axes: int
    ramp: Ramp
    bound_ticks: int
    """So far are the segments' intervals from those of the formula, at most."""


_STAGE = (
    *((14135, 2, -4128), (8158, 2, -1080), (6318, 2, -537), (5338, 2, -331), (4707, 2, -228), (4257, 3, -168)),
    *((3775, 4, -117), (3326, 5, -79), (2943, 7, -54), (2575, 9, -36), (2258, 12, -24), (1974, 16, -16)),
    *((1727, 20, -11), (1509, 26, -7)),
)
_GAUGE = (
    *((31618, 2, -9252), (18252, 2, -2436), (14137, 2, -1222), (11947, 2, -762), (10536, 2, -531), (9530, 2, -396)),
    *((8766, 2, -309), (8160, 2, -249), (7665, 3, -206), (7066, 3, -161), (6589, 4, -130), (6082, 4, -103)),
    *((5676, 5, -84), (5265, 5, -66)),
)
_EXPORTED_UP = (
    *((31598, 2, -9212), (18232, 2, -2396), (14117, 2, -1182), (11927, 2, -722), (10516, 3, -491), (9105, 4, -317)),
    *((7881, 6, -201), (6717, 8, -124), (5750, 12, -76), (4857, 18, -45), (4061, 27, -26), (3381, 41, -15)),
    *((2788, 48, -9), (2359, 75, -5)),
)
_EXPORTED_DOWN = (
    *((22336, 2, -6500), (12885, 2, -1680), (9975, 2, -821), (8427, 3, -496), (7048, 4, -284), (5951, 6, -169)),
    *((4977, 9, -97), (4127, 14, -54), (3385, 22, -29), (2749, 39, -15), (2168, 22, -9)),
)
RAMPS = {
    "LeadScrewStage": ExampleRamp(1500, 10_000, 10_000, 1, Ramp(_STAGE, 1333, _STAGE), 7),
    "ThreeGauges": ExampleRamp(400, 2000, 2000, 3, Ramp(_GAUGE, 5000, _GAUGE), 5),
    "ExportedRamp": ExampleRamp(1000, 2000, 4000, 1, Ramp(_EXPORTED_UP, 2000, _EXPORTED_DOWN), 25),
}
