import json
from dataclasses import dataclass

import numpy as np
import pytest
from pydantic import Field, ValidationError

from stepramp.http_api.answer import Answer, Numbers, WholeNumbers
from stepramp.http_api.json_response import JsonResponse, json_bytes


class PointAnswer(Answer):
    x: int
    label: str | None = Field(None, description="Left out unless asked for")


class CurveAnswer(Answer):
    step: WholeNumbers
    error: Numbers | None = None
    ends: list[PointAnswer]


@dataclass
class Point:
    x: int


def test_an_array_is_taken_as_it_is() -> None:
    step = np.arange(3)
    assert CurveAnswer(step=step, ends=[]).step is step


def test_a_list_in_the_place_of_an_array_is_checked() -> None:
    assert CurveAnswer(step=[1, 2], ends=[]).step == [1, 2]
    with pytest.raises(ValidationError):
        CurveAnswer(step=[1, "two"], ends=[])


def test_what_has_a_default_is_left_out_unless_it_is_given() -> None:
    answer = CurveAnswer(step=np.arange(1, 3), ends=[Point(1), PointAnswer(x=2, label=None)])
    assert json.loads(json_bytes(answer)) == {"step": [1, 2], "ends": [{"x": 1}, {"x": 2, "label": None}]}


def test_numbers_that_are_none_become_null() -> None:
    error = np.array([0.5, np.nan, np.inf])
    assert json.loads(json_bytes(CurveAnswer(step=[], error=error, ends=[])))["error"] == [0.5, None, None]


def test_a_long_answer_is_written_whole() -> None:
    steps, points = np.arange(100_000), [Point(x) for x in range(10_000)]
    content = json.loads(JsonResponse(CurveAnswer(step=steps, ends=points)).body)
    assert content == {"step": list(range(100_000)), "ends": [{"x": x} for x in range(10_000)]}


def test_columns_are_described_as_lists_of_numbers() -> None:
    described = CurveAnswer.model_json_schema(mode="serialization")["properties"]
    assert described["step"] == {"title": "Step", "type": "array", "items": {"type": "integer"}}
    assert described["error"]["anyOf"][0] == {"type": "array", "items": {"type": "number"}}


def test_what_no_answer_is_made_of_is_not_written() -> None:
    with pytest.raises(TypeError):
        json_bytes({"of": object()})
