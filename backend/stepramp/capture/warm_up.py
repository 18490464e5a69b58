"""Compiling before it is needed, as for the numerics of ramps: on small files and a small move."""

import numpy as np

from stepramp.capture.analysis import Wanted, analysed
from stepramp.capture.deviation import deviation_of
from stepramp.capture.formats.files import read_file

_CSV = b"Time [s],Step\n0,0\n1e-3,1\n2e-3,0\n"
_VCD = b"$timescale 1 us $end $var wire 1 ! Step $end $enddefinitions $end #0 0! #1 1! #2\n"


def warm_up_captures() -> None:
    """Read a small file of each kind, and match a small move."""
    for content in (_CSV, _VCD):
        _ = analysed(read_file(content), Wanted(), None).recording.edges_of()
    _ = deviation_of(np.array([0.0, 1.0, 2.0, 9.0]), np.array([0.0, 1.0, 2.0]), "best_fit")
