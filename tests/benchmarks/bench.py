"""Measure StepRamp and print tables. Judges nothing: compare lines of one run only.

usage: ./dev bench
"""

import resource
import statistics
import subprocess
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from starlette.testclient import TestClient

from benchmarks.captures import captures
from benchmarks.client_load import client_load
from benchmarks.firmware_engine import firmware_engine
from benchmarks.firmware_machine import firmware_machine
from benchmarks.frame_times import frame_times
from benchmarks.library_timer import library_timer
from benchmarks.motor import motor
from benchmarks.odd_devices import odd_devices
from benchmarks.stop_latency import stop_latency
from browser.server import CHROMIUM
from designs import design, document
from simulator.avr import missing_tools
from stepramp.http_api.app import create_app
from stepramp.methods import compromise, first_order, second_order
from stepramp.methods.common.taylor import taylor_up
from stepramp.methods.exact import exact_intervals
from stepramp.numerics.slope import ShapeParameters
from stepramp.ramp.error_curves import error_curves, relative_errors
from stepramp.ramp.plan import ramp_of
from stepramp.ramp.profile import profile_of
from stepramp.ramp.segments import compress
from stepramp.shapes.constant import ConstantAcceleration as Slope
from stepramp.shapes.s_curve import SCurve

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


def against_c() -> None:
    """Print the time of exact, (20), (22), (23) and their error curves, next to that of the same in C."""
    print("| steps of the ramp | StepRamp ms | C ms | ratio |\n|---:|---:|---:|---:|")
    with tempfile.TemporaryDirectory() as folder:
        program = Path(folder) / "methods"
        source = Path(__file__).with_name("methods.c")
        subprocess.run(["gcc", "-O2", "-o", str(program), str(source), "-lm"], check=True)
        for steps in STEPS:
            slope = Slope(1e6, 0, (2 * 4000 * (steps + 0.5)) ** 0.5, 4000)
            ours = milliseconds(lambda slope=slope: compared(slope))
            words = [program, "1e6", "0", repr(slope.slew_speed), "4000", str(steps)]
            in_c = float(subprocess.run(words, check=True, capture_output=True, text=True).stdout)
            print(f"| {steps:,} | {ours:.3f} | {in_c:.3f} | {ours / in_c:.2f} |", flush=True)
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print(f"\nLargest memory of this process so far: {peak:,.0f} MiB\n")


def compared(slope: Slope) -> list[object]:
    """Compute a slope exactly and by formulas (20), (22) and (23), and their errors."""
    exact = exact_intervals(slope, np.float64)
    results: list[object] = [exact]
    for coefficient in (each.COEFFICIENT for each in (first_order, second_order, compromise)):
        intervals = taylor_up(slope, coefficient, np.float64)
        results += [intervals, relative_errors(intervals, exact)]
    return results


def s_curves_against_c() -> None:
    """Print the time of the intervals of an S-curve without a level phase, next to that of the same loop in C."""
    print("| steps of the S-curve | StepRamp ms | C ms | ratio |\n|---:|---:|---:|---:|")
    with tempfile.TemporaryDirectory() as folder:
        program = Path(folder) / "s_curve"
        source = Path(__file__).with_name("s_curve.c")
        subprocess.run(["gcc", "-O2", "-o", str(program), str(source), "-lm"], check=True)
        for steps in STEPS:
            jerk = 1e6
            speed = (jerk**0.5 * (steps + 0.5)) ** (2 / 3)
            slope = SCurve(1e6, 0, speed, 1e9, ShapeParameters(jerk=jerk))
            ours = milliseconds(lambda slope=slope: exact_intervals(slope, np.float64))
            words = [program, "1e6", repr(speed), repr(jerk), str(steps)]
            in_c = float(subprocess.run(words, check=True, capture_output=True, text=True).stdout)
            print(f"| {slope.steps:,} | {ours:.3f} | {in_c:.3f} | {ours / in_c:.2f} |", flush=True)
    print()


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
            compared = {"methods": list(METHODS)}
            for route, more in (("profile", {}), ("errors", compared), ("curves", compared)):
                body = {"design": changed, "max_points": 2000, **more}
                spent = milliseconds(lambda route=route, body=body: client.post(f"/api/v1/{route}", json=body))
                print(f"| {steps:,} | {route}, 2,000 points | {spent:.2f} |", flush=True)


def captured_files() -> None:
    """Print how long captured files take."""
    print("\n## Captures\n")
    captures()


def motors() -> None:
    """Print how long a motor's move and its stall map take."""
    print("\n## Motors\n")
    motor()


def frames() -> None:
    """Print the times from a slider's event to the painted frame, or that there is no browser."""
    print("\n## In the browser\n")
    if CHROMIUM.exists():
        frame_times()
    else:
        print(f"Left out: {CHROMIUM} missing.")


def what_is_no_controller() -> None:
    """Print how long it takes to tell that a port has no controller."""
    print("\n## What is no controller\n")
    odd_devices()


def stops() -> None:
    """Print how long a STOP takes, idle and under load."""
    print("\n## Stops\n")
    stop_latency()


def clients() -> None:
    """Print how long a small profile takes when many ask at once, with and without a device that moves."""
    print("\n## Clients\n")
    client_load()


def firmware() -> None:
    """Print the tables of the firmware, or which tools are missing for them."""
    print("\n## Firmware\n")
    if missing := missing_tools():
        print(f"Left out: {', '.join(missing)} missing.")
        return
    firmware_engine()
    library_timer()
    print()
    firmware_machine()


if __name__ == "__main__":
    against_c()
    s_curves_against_c()
    numerics()
    segments()
    requests()
    captured_files()
    motors()
    frames()
    what_is_no_controller()
    stops()
    clients()
    firmware()
