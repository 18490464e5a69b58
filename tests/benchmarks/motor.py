"""How long a motor's move and its stall map take to be computed."""

import tempfile
import time
from functools import partial
from pathlib import Path

from executors.dask_cluster import DaskCluster
from motor.trains import with_motor
from stepramp.executors.cluster import connected
from stepramp.executors.contract import Executor
from stepramp.executors.threads import CORES, Threads
from stepramp.motor.map_points import Question, verdict_at
from stepramp.motor.map_ranges import question_of
from stepramp.motor.stall_map import COARSE, stall_map
from stepramp.motor.train import run_of
from stepramp.motor.verdict import DAMPINGS, outcome_of, verdict_of

CELLS = 64
RUNS = 20
DESIGN = with_motor()
"""10,000 steps at 1/16 step, up to 32,000 steps/s."""


def motor() -> None:
    """Print the times of the move with each damping and with all, and of maps by those who can compute them."""
    print("| 10,000 steps at 1/16 | ms |\n|---|---:|")
    outcome = outcome_of(DESIGN)
    for damping in DAMPINGS:
        spent_ms = best_ms(partial(run_of, outcome.train, outcome.intervals_s, damping))
        print(f"| played with ζ = {damping} | {spent_ms:.2f} |")
    print(f"| planned, and played with all three | {best_ms(partial(outcome_of, DESIGN)):.2f} |")
    print(f"| its verdict alone | {best_ms(partial(verdict_of, DESIGN)):.2f} |", flush=True)
    question = question_of(DESIGN, "slew_speed", None, None, CELLS)
    print(f"\n| map of {CELLS} × {CELLS} cells | first 9 × 9 points s | all s | points played |\n|---|---:|---:|---:|")
    print_map("one core", Threads(1), question)
    print_map(f"all cores: {CORES}", Threads(), question)
    with tempfile.TemporaryDirectory() as folder:
        dask = DaskCluster(Path(folder))
        try:
            for name in ("first", "second"):
                dask.start_worker(name)
            with dask.client(workers=2), connected(dask.address) as cluster:
                # Each compiles, or loads what was.
                list(cluster.results(partial(verdict_at, question), [(0, 0)] * 20, lambda: True))
                print_map("two Dask workers", cluster, question)
        finally:
            dask.end()


def best_ms(action: partial[object]) -> float:
    """Return the shortest time of some runs [ms]."""
    times = []
    for _ in range(RUNS):
        begin = time.perf_counter()
        action()
        times.append(time.perf_counter() - begin)
    return 1000 * min(times)


def print_map(name: str, by: Executor, question: Question) -> None:
    """Print how long a map takes."""
    begin, first_s, played = time.perf_counter(), 0.0, 0
    for picture in stall_map(CELLS, lambda points: by.results(partial(verdict_at, question), points, lambda: True)):
        played = picture.played
        if played == (COARSE + 1) ** 2:
            first_s = time.perf_counter() - begin
    print(f"| {name} | {first_s:.2f} | {time.perf_counter() - begin:.2f} | {played:,} |", flush=True)
