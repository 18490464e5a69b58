"""A Dask cluster, real and in processes of its own, as those who compute many things at once."""

import os
import time
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from starlette.testclient import TestClient

from executors.dask_cluster import DaskCluster
from motor.trains import whole, with_motor
from stepramp.errors import Refused, Rejected
from stepramp.executors import cluster
from stepramp.executors.choice import LOCAL, executor
from stepramp.executors.cluster import VARIABLE, connected
from stepramp.executors.contract import Executor
from stepramp.http_api.app import create_app
from stepramp.motor.map_points import verdict_at
from stepramp.motor.map_ranges import question_of
from stepramp.motor.stall_map import Picture, stall_map
from waiting import until

CELLS = 16
PATIENCE_S = 120
QUESTION = question_of(with_motor(move__steps=3000), "slew_speed", None, None, CELLS)


@pytest.fixture(scope="module")
def dask(tmp_path_factory: pytest.TempPathFactory) -> Iterator[DaskCluster]:
    made = DaskCluster(tmp_path_factory.mktemp("dask"))
    try:
        for name in ("first", "second"):
            made.start_worker(name)
        with made.client(workers=2):
            yield made
    finally:
        made.end()


def mapped(by: Executor, at: Callable[[Picture], object] = lambda _: None) -> Picture:
    picture = None
    for picture in stall_map(CELLS, lambda points: by.results(partial(verdict_at, QUESTION), points, lambda: True)):
        at(picture)
    assert picture is not None
    assert picture.progress == 1
    return picture


def test_a_cluster_has_the_same_answer_to_the_bit(dask: DaskCluster) -> None:
    with connected(dask.address) as far:
        there, here = mapped(far), mapped(LOCAL)
    assert there.verdicts.tobytes() == here.verdicts.tobytes()
    assert there.played == here.played
    assert len(np.unique(here.verdicts)) == 3


def test_a_worker_that_is_killed_in_the_middle_costs_time_only(dask: DaskCluster) -> None:
    victim = dask.start_worker("victim")
    with dask.client(workers=3) as client, connected(dask.address) as far:
        [address] = [at for at, told in client.scheduler_info()["workers"].items() if told["name"] == "victim"]
        killed = []

        def kill_at_work(picture: Picture) -> None:
            if not killed and client.processing()[address]:
                victim.kill()
                killed.append(picture.progress)

        found = mapped(far, kill_at_work)
    assert killed[0] < 0.9
    assert found.verdicts.tobytes() == mapped(LOCAL).verdicts.tobytes()


def test_what_nobody_waits_for_ends_on_the_workers_too(dask: DaskCluster, tmp_path: Path) -> None:
    def until_unwanted(item: int, is_wanted: Callable[[], bool]) -> None:
        (tmp_path / f"begun {item}").touch()
        for _ in range(PATIENCE_S * 1000):
            if not is_wanted():
                break
            time.sleep(0.001)
        (tmp_path / f"ended {item}").touch()

    def is_wanted() -> bool:
        return len(list(tmp_path.glob("begun *"))) < 2

    with connected(dask.address) as far:
        assert list(far.results(until_unwanted, range(100), is_wanted)) == []
        # Their workers are free again for others, and none of what waited was begun.
        assert sorted(far.results(lambda item, _: -item, range(20), lambda: True))[-1] == (19, -19)
    until(lambda: len(list(tmp_path.glob("ended *"))) == len(list(tmp_path.glob("begun *"))), PATIENCE_S)
    assert len(list(tmp_path.glob("begun *"))) < 10


def test_what_a_task_raises_is_raised(dask: DaskCluster) -> None:
    with connected(dask.address) as far, pytest.raises(ZeroDivisionError):
        list(far.results(lambda item, _: 1 // item, range(3), lambda: True))


def test_workers_that_die_of_what_they_do_are_told_in_words(tmp_path: Path) -> None:
    frail = DaskCluster(tmp_path, DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES="0")
    try:
        frail.start_worker("first")
        with frail.client(workers=1), connected(frail.address) as far:
            with pytest.raises(Refused, match="workers died, one after the other") as caught:
                list(far.results(lambda _, __: os._exit(1), range(1), lambda: True))
            assert frail.address in str(caught.value)
    finally:
        frail.end()


def test_a_worker_with_another_stepramp_refuses(dask: DaskCluster, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cluster, "__version__", "0.0.1")
    with connected(dask.address) as far, pytest.raises(Refused, match=r"0\.0\.1 asks it: install the same on both"):
        list(far.results(lambda item, _: item, range(3), lambda: True))


def asked(monkeypatch: pytest.MonkeyPatch, address: str | None) -> dict[str, Any]:
    """Return what becomes of a map that is asked for over the API."""
    monkeypatch.setenv(VARIABLE, address or "")
    with TestClient(create_app(), base_url="http://127.0.0.1:8000") as client:
        begun = client.post("/api/v1/motor/map", json={"design": whole(move__steps=600), "cells": 8})
        place = begun.headers["location"]
        until(lambda: client.get(place).json()["state"] not in ("waiting", "running"), PATIENCE_S)
        return client.get(place).json()  # type: ignore[no-any-return]


def test_the_variable_has_a_map_computed_by_the_cluster(dask: DaskCluster, monkeypatch: pytest.MonkeyPatch) -> None:
    there, here = (asked(monkeypatch, address) for address in (dask.address, None))
    assert (there["state"], here["state"]) == ("done", "done")
    assert there["result"] == here["result"]


def test_a_cluster_that_does_not_answer_makes_the_job_fail_by_name(monkeypatch: pytest.MonkeyPatch) -> None:
    for address in ("tcp://127.0.0.1:9", "http://127.0.0.1:8786", "tcp://"):
        told = asked(monkeypatch, address)
        assert told["state"] == "failed"
        [error] = told["errors"]
        assert (error["field"], error["value"]) == (VARIABLE, address)
        assert "a Dask scheduler that answers and has a worker, such as tcp://127.0.0.1:8786" in error["allowed"]
        assert "the cores of this machine compute" in error["allowed"]


def test_one_without_workers_and_one_that_ends_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    alone = DaskCluster(tmp_path)
    try:
        monkeypatch.setenv(VARIABLE, alone.address)
        with alone.client(workers=0), pytest.raises(Rejected, match=VARIABLE), executor():
            raise AssertionError("it has no worker")
        alone.start_worker("first")
        # All of it is done there, and only the first of it has been taken.
        with alone.client(workers=1) as client, connected(alone.address) as far:
            results = far.results(lambda item, _: item, range(40), lambda: True)
            next(results)
            until(lambda: not any(client.processing().values()), PATIENCE_S)
            alone.processes[0].kill()
            with pytest.raises(Rejected, match=VARIABLE):
                list(results)
    finally:
        alone.end()
    gone = DaskCluster(tmp_path)
    try:
        gone.start_worker("first")
        with gone.client(workers=1):
            pass
        with connected(gone.address) as far, pytest.raises(Rejected, match=VARIABLE):
            mapped(far, lambda _: gone.processes[0].kill())
    finally:
        gone.end()


def test_a_worker_without_stepramp_makes_the_job_fail_by_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "stepramp.py").write_text("raise ModuleNotFoundError(\"No module named 'stepramp'\")")
    bare = DaskCluster(tmp_path)
    try:
        bare.start_worker("bare", PYTHONPATH=str(tmp_path))
        with bare.client(workers=1):
            told = asked(monkeypatch, bare.address)
    finally:
        bare.end()
    assert told["state"] == "failed"
    assert "A Dask worker lacks what StepRamp needs: No module named 'stepramp'" in told["errors"][0]["message"]


def test_without_dask_it_is_told_how_to_install_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cluster, "find_spec", lambda _: None)
    with pytest.raises(Rejected, match=r"pip install 'stepramp\[cluster\]'"), connected("tcp://127.0.0.1:8786"):
        pass
