"""The whole API against its own description: documents as it allows them, and as it doesn't, also one after the other.

A served application, so that what the server itself makes of a request is tested too. Only virtual controllers are
connected to, and ramps are kept short.
"""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Iterator
from copy import deepcopy
from typing import Any

import pytest
import schemathesis
import uvicorn
from hypothesis import HealthCheck, given, settings
from hypothesis.stateful import run_state_machine_as_test
from schemathesis.config import SchemathesisConfig
from schemathesis.generation import GenerationMode
from schemathesis.specs.openapi.checks import negative_data_rejection

from stepramp.command_line.serving import free_port
from stepramp.controllers.families import FAMILIES
from stepramp.http_api.app import create_app

EXAMPLES = 25
"""Of each route, as often with what is allowed and with what isn't."""
RUNS, CALLS = 12, 8
"""Sequences of calls, and how long they are."""
LEAST_CASES = 500
LONGEST_STEPS = 300
MOST_ROWS = 8

# Fields have rules among each other that no schema can tell, so that what it allows may be refused.
config = SchemathesisConfig.from_dict(
    {
        "checks": {
            "positive_data_acceptance": {"expected-statuses": ["2xx", "404", "409", "412", "422", "502"]},
            "negative_data_rejection": {"expected-statuses": ["404", "405", "409", "412", "413", "415", "422"]},
            "not_a_server_error": {"expected-statuses": ["2xx", "3xx", "4xx", "502"]},
        },
        "warnings": False,
    }
)
schema = schemathesis.openapi.from_dict(create_app().openapi(), config=config)
OPERATIONS = [found.ok() for found in schema.get_all_operations()]
cases: dict[str, int] = {"single": 0, "in sequences": 0}


@pytest.fixture(scope="module", autouse=True)
def served() -> Iterator[str]:
    """Serve the application, and return its address."""
    listener = free_port(8900)
    server = uvicorn.Server(uvicorn.Config(create_app(), log_level="error", ws="websockets-sansio"))
    thread = threading.Thread(target=lambda: asyncio.run(server.serve([listener])))
    thread.start()
    url = f"http://127.0.0.1:{listener.getsockname()[1]}"
    yield url
    server.should_exit = True
    thread.join()


def kept_harmless(case: schemathesis.Case) -> schemathesis.Case:
    """Touch no real port; and plan no ramp that takes seconds, unless it is to be refused."""
    # A copy: what Hypothesis drew is drawn again, and must not have changed meanwhile.
    body = case.body = deepcopy(case.body)
    if isinstance(body, dict) and isinstance(body.get("port"), str) and 1 <= len(body["port"]) <= 200:
        body["port"] = "sim://"
        if body.get("family") in list(FAMILIES):
            body["family"] = "stepramp"  # That of the virtual controller.
    if case.meta is None or case.meta.generation.mode.is_positive:
        shorten(body)
    return case


def shorten(value: Any) -> None:
    if isinstance(value, list):
        for each in value:
            shorten(each)
    if not isinstance(value, dict):
        return
    for each in value.values():
        shorten(each)
    slew = value.get("slew_speed_steps_per_s")
    for name in ("acceleration_steps_per_s2", "deceleration_steps_per_s2"):
        if isinstance(slew, int | float) and isinstance(value.get(name), int | float) and not isinstance(slew, bool):
            value[name] = max(value[name], min(1e9, slew * slew / LONGEST_STEPS))
    for name, most in (("most_rows", MOST_ROWS), ("steps", LONGEST_STEPS)):
        if isinstance(value.get(name), int | float) and abs(value[name]) > most:
            value[name] = most if value[name] > 0 else -most


@pytest.mark.parametrize("mode", GenerationMode, ids=lambda mode: mode.value)
@pytest.mark.parametrize("operation", OPERATIONS, ids=lambda operation: operation.label)
def test_the_api_keeps_to_its_description(
    operation: schemathesis.APIOperation, mode: GenerationMode, served: str
) -> None:
    if mode.is_negative and not operation.body:
        pytest.skip("Nothing can be wrong with what takes no body.")
    if mode.is_negative and operation.path == "/api/v1/library/import":
        pytest.skip("Any bytes are a file: what is wrong with them isn't said by the description.")

    @settings(max_examples=EXAMPLES, deadline=None, suppress_health_check=list(HealthCheck))
    @given(case=operation.as_strategy(generation_mode=mode))
    def keeps_to_it(case: schemathesis.Case) -> None:
        cases["single"] += 1
        answer = kept_harmless(case).call(base_url=served, timeout=60)
        case.validate_response(answer, excluded_checks=unchecked(case))

    keeps_to_it()


def unchecked(case: schemathesis.Case) -> list[schemathesis.CheckFunction]:
    """Return what an answer isn't checked for: a stop is obeyed whatever its body."""
    return [negative_data_rejection] if case.path.endswith(("/stop", "/halt")) else []


def test_sequences_of_calls_keep_to_the_description(served: str) -> None:
    class Sequences(schema.as_state_machine()):  # type: ignore[misc]  # made of the description
        def get_call_kwargs(self, _: schemathesis.Case) -> dict[str, Any]:
            return {"base_url": served, "timeout": 60}

        def before_call(self, case: schemathesis.Case) -> None:
            kept_harmless(case)

        def validate_response(self, response: Any, case: schemathesis.Case, **_: Any) -> None:
            cases["in sequences"] += 1
            case.validate_response(response, excluded_checks=unchecked(case))

    run_state_machine_as_test(
        Sequences,
        settings=settings(
            max_examples=RUNS, stateful_step_count=CALLS, deadline=None, suppress_health_check=list(HealthCheck)
        ),
    )


def test_how_many_cases_there_were(record_property: Any, capsys: pytest.CaptureFixture[str]) -> None:
    for kind, count in cases.items():
        record_property(kind, count)
    with capsys.disabled():
        print(f"\nThe API was asked {cases['single']:,} times, and {cases['in sequences']:,} times in sequences.")
    assert cases["single"] >= LEAST_CASES
    assert cases["in sequences"] >= RUNS
