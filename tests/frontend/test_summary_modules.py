"""The summary's figures, without a page."""

from __future__ import annotations

import json
from typing import Any

from designs import design, document
from frontend.modules import Modules
from stepramp.http_api.json_response import json_bytes
from stepramp.http_api.schedule_models import ScheduleAnswer
from stepramp.ramp.schedule import Mode, schedule_of

CHANGES: list[dict[str, Any]] = [
    {"name": "X", "move__steps": 1000},
    {"name": "Y", "move__steps": -250, "axis__microsteps": 1},
]


def figures(modules: Modules, together: Mode, length: str) -> list[list[str]]:
    planned = json.loads(
        json_bytes(ScheduleAnswer.of(schedule_of([design(**each) for each in CHANGES], together), 0, 9))
    )
    script = """async ([all, units]) => (await import('/panels/summary/axes_figures.js')).axesFigures(all, units)
        .map(({title, value, unit, more}) => [title, `${value} ${unit}`, more])"""
    every = {"axes": [document(**each) for each in CHANGES], "together": together, "planned": planned}
    return list(modules.evaluate(script, [every, {"length": length, "time": "s"}]))


def test_the_figures_of_a_line_are_those_of_the_line(modules: Modules) -> None:
    """Y makes a quarter of the steps in the same time: 250 steps/s, of 0.04 mm each."""
    assert figures(modules, "line", "steps") == [
        ["Duration of all axes", "1.172 s", "along a line, 0 leads"],
        ["0 X: peak speed", "1,000 steps/s", "1,000 steps"],
        ["1 Y: peak speed", "250 steps/s", "250 steps"],
    ]
    assert figures(modules, "line", "mm")[1:] == [
        ["0 X: peak speed", "20 mm/s", "20.00 mm"],
        ["1 Y: peak speed", "10 mm/s", "10.00 mm"],
    ]


def test_axes_that_move_each_by_itself_say_how_long_each_takes(modules: Modules) -> None:
    """Constant acceleration: 0.2 s up, as much down, less the shortcuts of formula 9, and the slew between."""
    duration, x, y = figures(modules, "independent", "steps")
    assert duration == ["Duration of all axes", "1.172 s", "until the last one rests"]
    assert x == ["0 X: peak speed", "1,000 steps/s", "1,000 steps in 1.172 s"]
    assert y[2].startswith("250 steps in 4")


def test_nothing_is_told_of_axes_that_are_refused(modules: Modules) -> None:
    script = """async () => (await import('/panels/summary/axes_figures.js'))
        .axesFigures({axes: [], together: 'line', planned: null, rejections: []}, {length: 'steps', time: 's'})"""
    assert modules.evaluate(script) == []
