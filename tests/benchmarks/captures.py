"""How long captured files take to be read and held against a design."""

from __future__ import annotations

import time

import numpy as np

from designs import design
from stepramp.capture.analysis import Wanted, analysed
from stepramp.capture.formats.files import read_file
from stepramp.capture.warm_up import warm_up_captures
from stepramp.http_api.capture_models import CaptureAnswer, CapturePayload
from stepramp.http_api.json_response import json_bytes
from stepramp.ramp.profile import profile_of

STEPS = 5_000_000
"""Two edges each."""


def captures() -> None:
    """Print how long each part takes of a move of 10,000,000 edges, one of 100,000 steps missing."""
    long = design(ramp__slew_speed_steps_per_s=20_000, ramp__acceleration_steps_per_s2=2000, move__steps=STEPS)
    began = time.perf_counter()
    profile = profile_of(long)
    planned_s = time.perf_counter() - began
    made_us = np.delete(np.rint(profile.time_s * 1e6).astype(np.int64), np.arange(50, STEPS, 100_000))
    warm_up_captures()
    print(f"Planning of the move: {planned_s:.2f} s\n")
    print("| file | MB | read s | analysed s | answered s | together s |\n|---|---:|---:|---:|---:|---:|")
    for name, content in (("CSV of Saleae", _csv(made_us)), ("VCD", _vcd(made_us))):
        times = [time.perf_counter()]
        recording = read_file(content)
        times.append(time.perf_counter())
        analysis = analysed(recording, Wanted(alignment="best_fit", shortest_pulse_us=1.0), profile)
        times.append(time.perf_counter())
        json_bytes(CaptureAnswer.of(analysis, CapturePayload()))
        times.append(time.perf_counter())
        read, analysing, answering = np.diff(times)
        print(
            f"| {name} | {len(content) / 1e6:,.0f} | {read:.2f} | {analysing:.2f} | {answering:.2f} "
            f"| {times[-1] - times[0]:.2f} |",
            flush=True,
        )


def _csv(made_us: np.ndarray[tuple[int], np.dtype[np.int64]]) -> bytes:
    rows = (f"{us // 10**6}.{us % 10**6:06}000,1\n{(us + 5) // 10**6}.{(us + 5) % 10**6:06}000,0\n" for us in made_us)
    return ("Time [s],Step\n-1.0,0\n" + "".join(rows)).encode()


def _vcd(made_us: np.ndarray[tuple[int], np.dtype[np.int64]]) -> bytes:
    head = "$timescale 1 us $end $var wire 1 ! Step $end $enddefinitions $end 0!\n"
    return (head + "".join(f"#{us} 1!\n#{us + 5} 0!\n" for us in made_us.tolist())).encode()


if __name__ == "__main__":
    captures()
