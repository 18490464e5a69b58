"""Measure StepRamp and print tables. Judges nothing: compare lines of one run only.

usage: ./dev bench
"""

import statistics
import time
from collections.abc import Callable

from starlette.testclient import TestClient

from designs import design, document
from stepramp.http_api.app import create_app
from stepramp.ramp.error_curves import error_curves
from stepramp.ramp.plan import ramp_of
from stepramp.ramp.profile import profile_of
from stepramp.ramp.segments import compress

STEPS = (1_000, 100_000, 10_000_000)
METHODS = ("exact", "first_order", "table")


def milliseconds(action: Callable[[], object]) -> float:
    """Return the median time of an action [ms], after a first run that may compile."""
    action()
    times: list[float] = []
    began = time.perf_counter()
    while len(times) < 3 or (time.perf_counter() - began < 1 and len(times) < 100):
        start = time.perf_counter()
        action()
        times.append(time.perf_counter() - start)
    return statistics.median(times) * 1000


def long_ramp(steps: int) -> dict[str, object]:
    """Return changes that make a ramp take nearly half of a move of so many steps."""
    return {
        "timer__frequency_hz": 16_000_000,
        "ramp__slew_speed_steps_per_s": 2000,
        "ramp__acceleration_steps_per_s2": 2000**2 / (0.9 * steps),
        "move__steps": steps,
    }


def numerics() -> None:
    """Print the time of profiles and error curves."""
    print("| steps | method | profile ms | error curve ms |\n|---:|---|---:|---:|")
    for steps in STEPS:
        planned = design(**long_ramp(steps))
        for method in METHODS:
            one = planned.with_method(method)  # type: ignore[arg-type]  # a name from METHODS
            profile = milliseconds(lambda one=one: profile_of(one))
            errors = milliseconds(lambda one=one: error_curves(one, one.method.name, "exact"))
            print(f"| {steps:,} | {method} | {profile:.2f} | {errors:.2f} |", flush=True)


def segments() -> None:
    """Print how long compression takes and how many segments it needs."""
    print("\n| ramp steps | bound ticks | segments | ms |\n|---:|---:|---:|---:|")
    for steps in STEPS[:2]:
        up = ramp_of(design(**long_ramp(2 * steps))).up
        for bound in (0, 1, 4):
            count, spent = len(compress(up, bound)), milliseconds(lambda up=up, bound=bound: compress(up, bound))
            print(f"| {up.size:,} | {bound} | {count:,} | {spent:.2f} |", flush=True)


def requests() -> None:
    """Print the time of requests, without a network between."""
    print("\n| steps | request | ms |\n|---:|---|---:|")
    with TestClient(create_app(), base_url="http://127.0.0.1") as client:
        for steps in (10_000, 1_000_000):
            changed = document(**long_ramp(steps))
            for route, more in (("profile", {}), ("errors", {"methods": list(METHODS)})):
                body = {"design": changed, "max_points": 2000, **more}
                spent = milliseconds(lambda route=route, body=body: client.post(f"/api/v1/{route}", json=body))
                print(f"| {steps:,} | {route}, 2,000 points | {spent:.2f} |", flush=True)


if __name__ == "__main__":
    numerics()
    segments()
    requests()
