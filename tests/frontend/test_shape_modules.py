"""The page's shapes of ramps: what a shape begins with, drawn points as text, and where refusals of them are told."""

from typing import Any

import numpy as np
import pytest

from designs import design, document
from frontend.modules import Modules
from stepramp.design import Design
from stepramp.numerics.slope import ShapeParameters
from stepramp.shapes.drawn import Drawn


def shaped(modules: Modules, name: str, **changes: object) -> dict[str, Any]:
    made: dict[str, Any] = modules.call("model/shapes.js", "withShape", document(**changes), name)
    return made


def test_an_s_curve_begins_with_an_onset_of_a_fifth_of_its_ramp(modules: Modules) -> None:
    made = shaped(modules, "s_curve", ramp__base_speed_steps_per_s=200)
    checked = Design.checked(made)
    # T = Δ/a + a/j with Δ = 800 and a = 5000: an onset a/j of T/5 is Δ/4a.
    assert checked.ramp.shape.jerk_steps_per_s3 == pytest.approx(5000 / (800 / 5000 / 4))
    assert (made["schema"], made["ramp"]["shape"]["name"]) == ("stepramp/2", "s_curve")


@pytest.mark.parametrize("name", ["s_curve", "cosine", "drawn"])
def test_each_shape_begins_with_numbers_that_the_server_takes(modules: Modules, name: str) -> None:
    for slew in (0.01, 333.333, 1_000_000):
        Design.checked(shaped(modules, name, ramp__slew_speed_steps_per_s=slew))
    # With text where numbers belong it still begins with some.
    assert shaped(modules, name, ramp__slew_speed_steps_per_s="fast")["ramp"]["shape"]["name"] == name


def test_the_usual_shape_is_none_and_the_rest_of_a_design_stays(modules: Modules) -> None:
    made = shaped(modules, "s_curve")
    back = modules.call("model/shapes.js", "withShape", made, "constant")
    assert back == document() | {"schema": "stepramp/2"}
    assert modules.call("model/shapes.js", "withShape", made, "s_curve") == made
    planned = modules.call("model/shapes.js", "withPlan", document(), "any_move")
    assert Design.checked(planned) == design(schema="stepramp/2", move__plan="any_move")


def test_a_design_has_the_fields_of_its_own_shape(modules: Modules) -> None:
    paths = ["ramp.shape.jerk_steps_per_s3", "ramp.shape.points", "ramp.acceleration_steps_per_s2", "move.steps"]
    has = {
        name: [modules.call("model/shapes.js", "hasField", shaped(modules, name), path) for path in paths]
        for name in ("constant", "s_curve", "cosine", "drawn")
    }
    assert has == {
        "constant": [False, False, True, True],
        "s_curve": [True, False, True, True],
        "cosine": [False, False, True, True],
        "drawn": [False, True, True, True],
    }


@pytest.mark.parametrize(
    ("text", "points"),
    [
        ("0 1\n500 0.5", [[0, 1], [500, 0.5]]),
        ("0,1\r\n500,0.5\r\n", [[0, 1], [500, 0.5]]),
        ("0\t1\n500\t.5", [[0, 1], [500, 0.5]]),
        ("0; 1\n500; 0.5", [[0, 1], [500, 0.5]]),
        ("0, 1\n\n1,500 0.5", [[0, 1], [1500, 0.5]]),
        ("500 x\n7", [[500, "x"], [7, ""]]),
        ("1 2 3", [[1, "2 3"]]),
        ("", []),
    ],
)
def test_points_are_read_as_they_are_written_and_pasted(modules: Modules, text: str, points: list[Any]) -> None:
    assert modules.call("model/drawn_points.js", "pointsOf", text, 1) == points


@pytest.mark.parametrize(
    ("text", "points"),
    [
        ("speed,part\n0,1\n10,0.5", [[0, 1], [500, 0.5]]),
        ("Speed [mm/s]; part of a\n0; 1\n10; .5", [[0, 1], [500, 0.5]]),
        # Only the first line is one, and only over numbers.
        ("0,1\nspeed,part\n10,0.5", [[0, 1], ["speed", "part"], [500, 0.5]]),
        ("speed,part", [["speed", "part"]]),
        ("fast 0.5\n10 0.5", [["fast", 0.5], [500, 0.5]]),
        ("1e307 1\n10 0.5", [["1e307", 1], [500, 0.5]]),
    ],
)
def test_points_are_read_in_the_unit_shown_and_without_their_heading(
    modules: Modules, text: str, points: list[Any]
) -> None:
    """0.02 mm a step: 10 mm/s are 500 steps/s."""
    assert modules.call("model/drawn_points.js", "pointsOf", text, 0.02) == points


def test_points_are_written_so_that_they_are_read_again(modules: Modules) -> None:
    points = [[0, 1], [1234.5, 0.001], [1_000_000, 0.25]]
    for factor in (1, 0.02, 1.2):
        text = modules.call("model/drawn_points.js", "pointsText", points, factor)
        assert modules.call("model/drawn_points.js", "pointsOf", text, factor) == points
    assert modules.call("model/drawn_points.js", "pointsText", points, 0.02).splitlines()[1] == "24.69  0.001"


def test_a_refusal_of_a_point_is_told_at_the_points(modules: Modules) -> None:
    refused = {
        "field": "design.ramp.shape.points.2.1",
        "value": "x",
        "allowed": "a number from 0.001 to 1",
        "message": "",
    }
    at_a_speed = refused | {"field": "ramp.shape.points.0.0"}
    told = [modules.call("model/messages.js", "textOf", [each]) for each in (refused, at_a_speed)]
    assert told == [
        "Point 3, part, is 'x'; allowed: a number from 0.001 to 1.",
        "Point 1, speed, is 'x'; allowed: a number from 0.001 to 1.",
    ]


def test_only_methods_of_the_shape_are_computed_and_exported(modules: Modules) -> None:
    ask = """async ([design, shown]) => (await import('/model/design.js')).methodsToCompute(design, new Set(shown))"""
    shown = ["exact", "first_order", "newton", "table"]
    assert modules.evaluate(ask, [shaped(modules, "cosine"), shown]) == ["exact", "newton", "table"]
    assert modules.evaluate(ask, [document(), shown]) == shown


TWO, THREE = [[0, 1], [1000, 0.5]], [[0, 1], [500, 1], [1000, 0.5]]


def test_the_curve_through_drawn_points_is_the_servers(modules: Modules) -> None:
    """The server's curve is held against an independent one in tests/ramp; the page's is to be the same."""
    for points in (
        [[0, 1], [500, 1], [1000, 0.5]],
        [[10, 0.2], [90, 0.9]],
        [[0, 0.3], [1, 1], [300, 0.4], [320, 0.9], [900, 0.1]],
    ):
        slope = Drawn(1e6, 0, 1200, 1.0, ShapeParameters(points=tuple((x, y) for x, y in points)))
        speeds = np.linspace(0, 1200, 301)
        script = """async ([points, speeds]) => {
            const {monotoneCubic} = await import('/model/monotone_cubic.js');
            return speeds.map(monotoneCubic(points));
        }"""
        drawn = modules.evaluate(script, [points, speeds.tolist()])
        assert drawn == pytest.approx(slope.accelerations(speeds).tolist(), rel=1e-12)


FINE = [[0, 1], [12345.6, 1], [12346, 1], [30000, 0.5]]
NO_KEYS = {"shiftKey": False, "altKey": False}


@pytest.mark.parametrize(
    ("function", "arguments", "expected"),
    [
        ("movedPoint", (THREE, 1, [700.1, 0.12345]), [[0, 1], [700.1, 0.123], [1000, 0.5]]),
        # A speed that is only kept is neither rounded nor taken away from a near neighbour.
        ("nudgedPoint", (FINE, 1, "ArrowDown", NO_KEYS), [[0, 1], [12345.6, 0.99], [12346, 1], [30000, 0.5]]),
        ("nudgedPoint", (FINE, 0, "ArrowRight", NO_KEYS), [[300, 1], *FINE[1:]]),
        ("movedPoint", (FINE, 3, [2e6, 0.5]), [*FINE[:3], [1e6, 0.5]]),
        ("drawablePoints", ([[speed, 1] for speed in range(201)],), None),
        ("movedPoint", (THREE, 1, [2000, 7]), [[0, 1], [999, 1], [1000, 0.5]]),
        ("movedPoint", ([[0, 1], [1000, 0.5]], 0, [-5, -5]), [[0, 0.001], [1000, 0.5]]),
        ("withoutPoint", ([[0, 1], [1000, 0.5]], 0), None),
        ("drawablePoints", ([[0, 1], [0, 0.5]],), None),
        ("drawablePoints", ([[0, 1], ["fast", 0.5]],), None),
        ("withPointAt", (TWO, [400, 0.7], 200), {"points": [[0, 1], [400, 0.7], [1000, 0.5]], "index": 1}),
        ("withPointAt", (TWO, [400, 0.7], 2), {"points": TWO, "index": -1}),
    ],
)  # fmt: skip
def test_drawn_points_stay_between_their_neighbours_and_within_what_is_taken(
    modules: Modules, function: str, arguments: tuple[object, ...], expected: object
) -> None:
    assert modules.call("model/drawn_points.js", function, *arguments) == expected
