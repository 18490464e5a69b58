import json

import pytest

from stepramp.http_api.stop_body import axes_of_stop


@pytest.mark.parametrize(
    ("axes", "stopped"), [([0], (0,)), ([1, 0], (0, 1)), ([3, 3], (3,)), ([0, 1, 2, 3], (0, 1, 2, 3))]
)
def test_the_axes_that_are_named_stop(axes: list[int], stopped: tuple[int, ...]) -> None:
    assert axes_of_stop(json.dumps({"axes": axes}).encode()) == stopped


@pytest.mark.parametrize(
    "body",
    [
        b"",
        b"{}",
        b'{"axes": null}',
        b'{"axes": []}',
        b'{"axes": [4]}',
        b'{"axes": [-1]}',
        b'{"axes": [0, "1"]}',
        b'{"axes": [true]}',
        b'{"axes": 0}',
        b'{"axis": 0}',
        b'{"axes": [0], "more": 1}',
        b'{"axes": [0], "axes": [1]}',
        b'{"axes": [0]',
        b"[0]",
        b"null",
        b"stop!",
        b"\xff\xfe",
        b'{"axes": ["\\ud800"]}',
        b'{"axes": [0], "\\ud800": 1}',
        b"[" * 100_000,
        b'{"axes": ' + b"[" * 400 + b"]" * 400 + b"}",
        b'{"axes": [' + b"9" * 5000 + b"]}",
        b'{"axes": [0]}' + b" " * 1024,
    ],
    ids=lambda body: repr(body[:20]),
)
def test_all_stop_when_the_body_names_none_rightly(body: bytes) -> None:
    assert axes_of_stop(body) is None
