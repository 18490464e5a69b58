"""What a server refuses comes out of the client as it went into the server."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from stepramp.client.refusals import error_of, error_of_items
from stepramp.errors import (
    Change,
    Choices,
    DeviceLost,
    Limits,
    NoServer,
    Overloaded,
    Refused,
    Rejected,
    Rejection,
    Remedy,
    StepRampError,
    Told,
)
from stepramp.http_api.error_items import error_items
from stepramp.http_api.errors import error_response

words = st.text(max_size=30)
numbers = st.none() | st.integers(-(2**53), 2**53)
told = st.builds(Told.of, st.integers(1, 10**6).map(float), st.just("steps/s"))
changes = st.builds(Change, words, numbers)
rejections = st.builds(
    Rejection,
    st.text("abc._0", min_size=1),
    numbers | words | st.booleans() | st.lists(st.integers(0, 9), max_size=3),
    words,
    limits=st.none() | st.builds(Limits, numbers, numbers, words, st.booleans(), words),
    remedies=st.lists(st.builds(Remedy, words, st.tuples(changes), st.tuples(told)), max_size=2).map(tuple),
    reason=words,
    told=st.lists(told, max_size=2).map(tuple),
    choices=st.none() | st.builds(Choices, st.tuples(words), changes, st.booleans()),
)


@settings(max_examples=40)
@given(st.lists(rejections, min_size=1, max_size=4), st.integers(0, 2000))
def test_a_rejection_comes_through_whole(given_ones: list[Rejection], more: int) -> None:
    error = Rejected(given_ones, more)
    read = error_of_items(error_items(error))
    assert isinstance(read, Rejected)
    assert (read.rejections, read.more, str(read)) == (error.rejections, more, str(error))


@pytest.mark.parametrize("error", [Refused("Not now."), DeviceLost("It is gone."), Overloaded("Too much.")])
def test_other_errors_are_of_their_kind(error: StepRampError) -> None:
    response = error_response(error)
    read = error_of(response.status_code, bytes(response.body), "http://a")
    assert (type(read), str(read)) == (type(error), str(error))


def test_what_is_refused_of_one_thing_is_refused_still() -> None:
    error = Refused("The motor moves.", "axis", 1, "at rest")
    read = error_of(409, bytes(error_response(error).body), "http://a")
    assert isinstance(read, Refused)
    assert (str(read), read.field, read.value, read.allowed) == ("The motor moves.", "axis", 1, "at rest")


def test_what_is_no_refusal_is_of_no_stepramp() -> None:
    assert isinstance(error_of(502, b"<html>", "http://a"), NoServer)
    assert "is null" in str(error_of_items(error_items(Rejected([Rejection("a", None, "b", is_null=True)]))))
