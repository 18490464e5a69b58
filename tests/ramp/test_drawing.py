"""What plots need of a move, computed once."""

import numpy as np
import pytest

from designs import design
from stepramp.errors import Rejected
from stepramp.ramp import profile
from stepramp.ramp.drawing import Drawing, Drawn
from stepramp.ramp.plan import Plan, plan_of


def test_each_method_is_planned_once_also_when_the_parts_of_its_error_are_wanted(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    planned = []

    def counted(*arguments: object) -> Plan:
        # A server that another test has begun may be warming up beside this.
        if getattr(arguments[0], "name", "") == asked.name:
            planned.append(arguments)
        return plan_of(*arguments)  # type: ignore[arg-type]

    asked = design(move__steps=500)
    monkeypatch.setattr(profile, "plan_of", counted)
    drawn = Drawing(asked, ("newton", "compromise"), "exact", 2000, with_parts=True, segment_bound_ticks=2)
    found = dict(drawn.methods())
    assert len(planned) == 2
    for each in found.values():
        assert not isinstance(each, Rejected)
        check_parts(each)


def check_parts(drawn: Drawn) -> None:
    """The segments' part keeps to their bound; what is drawn besides is as planned."""
    assert drawn.parts is not None
    assert 0 < np.abs(drawn.parts.compression).max() <= 2
    np.testing.assert_array_equal(drawn.judged.played_ticks, drawn.judged.profile.intervals_ticks)
