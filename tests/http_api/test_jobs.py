"""Jobs, whatever they compute: their turns, their ends, and how long they are kept."""

import threading
import time
from collections.abc import Iterator

import pytest
from starlette.testclient import TestClient

from stepramp.errors import NotFound, Overloaded, Refused
from stepramp.http_api import job_registry
from stepramp.http_api.answer import Answer
from stepramp.http_api.job_registry import MOST_ALIKE, MOST_KEPT, MOST_RUNNING, MOST_WAITING, Computation, Job, Jobs

PATIENCE_S = 10.0


class Work:
    """Work that waits until it is let go on, and ends when it isn't wanted any more."""

    def __init__(self) -> None:
        self.begun, self.go_on = threading.Semaphore(0), threading.Event()

    def __call__(self, computation: Computation) -> None:
        self.begun.release()
        while computation.is_wanted() and not self.go_on.wait(0.01):
            pass
        if not computation.is_wanted():
            raise RuntimeError  # As it likes.


@pytest.fixture
def jobs() -> Iterator[Jobs]:
    made = Jobs()
    yield made
    made.close()


def ended(job: Job) -> Job:
    for _ in range(int(PATIENCE_S / 0.01)):
        if job.has_ended:
            return job
        threading.Event().wait(0.01)
    raise AssertionError(job.state)


def test_a_job_tells_how_far_it_is_and_ends(jobs: Jobs) -> None:
    told, go_on, told_it = Answer(), threading.Event(), threading.Event()

    def work(computation: Computation) -> None:
        computation.tell(0.5, told)
        told_it.set()
        go_on.wait(PATIENCE_S)
        computation.tell(1.0, told)

    job = jobs.start("some", b"", work)
    assert told_it.wait(PATIENCE_S)
    assert (job.state, job.progress, job.result) == ("running", 0.5, told)
    go_on.set()
    assert (ended(job).state, job.progress) == ("done", 1.0)


def test_so_many_run_so_many_wait_and_one_more_is_refused(jobs: Jobs) -> None:
    work = Work()
    running = [jobs.start("some", bytes([number]), work) for number in range(MOST_RUNNING)]
    for _ in running:
        assert work.begun.acquire(timeout=PATIENCE_S)
    waiting = [jobs.start("some", bytes([9, number]), work) for number in range(MOST_WAITING)]
    assert [job.state for job in waiting] == ["waiting"] * MOST_WAITING
    with pytest.raises(Overloaded, match="8 jobs wait for their turn already"):
        jobs.start("some", b"more", work)
    # What waits already may be asked for again; one that is cancelled while it waits makes room, and is never begun.
    assert jobs.start("some", bytes([9, 0]), work).state == "waiting"
    waiting[-1].cancel()
    jobs.start("some", b"more", work)
    work.go_on.set()
    assert [ended(job).state for job in (*running, *waiting)] == ["done"] * (MOST_RUNNING + MOST_WAITING - 1) + [
        "cancelled"
    ]


def test_the_same_question_is_computed_once_unless_that_came_to_nothing(jobs: Jobs) -> None:
    work = Work()
    first, second = (jobs.start("some", b"question", work) for _ in range(2))
    assert work.begun.acquire(timeout=PATIENCE_S)
    assert first.id != second.id
    jobs.start("other", b"question", work)
    assert work.begun.acquire(timeout=PATIENCE_S)
    # Both are cancelled: that came to nothing.
    first.cancel()
    second.cancel()
    third = jobs.start("some", b"question", work)
    assert work.begun.acquire(timeout=PATIENCE_S)
    work.go_on.set()
    assert ended(third).state == "done"
    again = jobs.start("some", b"question", work)
    assert again.state == "done"
    assert not work.begun.acquire(blocking=False)


def test_who_cancels_a_job_takes_it_from_nobody_else(jobs: Jobs) -> None:
    work = Work()
    mine, yours = (jobs.start("some", b"question", work) for _ in range(2))
    assert work.begun.acquire(timeout=PATIENCE_S)
    for _ in range(2):  # Said twice it is still one's own alone.
        mine.cancel()
    assert (mine.state, yours.state) == ("cancelled", "running")
    work.go_on.set()
    assert (ended(yours).state, mine.state) == ("done", "cancelled")


def test_what_was_known_when_a_job_was_cancelled_stays_so(jobs: Jobs) -> None:
    first, last, told, go_on = Answer(), Answer(), threading.Event(), threading.Event()

    def work(computation: Computation) -> None:
        computation.tell(0.5, first)
        told.set()
        go_on.wait(PATIENCE_S)
        computation.tell(1.0, last)

    mine, yours = (jobs.start("some", b"", work) for _ in range(2))
    assert told.wait(PATIENCE_S)
    mine.cancel()
    go_on.set()
    ended(yours)
    assert (mine.progress, mine.result) == (0.5, first)
    assert (yours.progress, yours.result) == (1.0, last)
    # What has ended can't be cancelled.
    yours.cancel()
    assert yours.state == "done"


def test_so_many_ask_the_same_and_no_more(jobs: Jobs) -> None:
    work = Work()
    asked = [jobs.start("some", b"", work) for _ in range(MOST_ALIKE)]
    with pytest.raises(Overloaded, match="32 jobs ask the same already"):
        jobs.start("some", b"", work)
    asked[0].cancel()
    assert jobs.start("some", b"", work).state in ("waiting", "running")


def test_of_those_that_have_ended_the_oldest_are_forgotten(jobs: Jobs) -> None:
    done = [ended(jobs.start("some", bytes([number]), lambda _: None)) for number in range(MOST_KEPT + 3)]
    assert jobs.get(done[-1].id) is done[-1]
    with pytest.raises(NotFound, match=f"There is no job '{done[0].id}'"):
        jobs.get(done[0].id)


def test_the_end_of_a_job_is_final(jobs: Jobs) -> None:
    work = Work()
    job = jobs.start("some", b"", work)
    assert work.begun.acquire(timeout=PATIENCE_S)
    job.cancel()
    work.go_on.set()
    jobs.start("some", b"other", work)
    assert work.begun.acquire(timeout=PATIENCE_S)
    assert (job.state, job.error) == ("cancelled", None)


def test_why_a_job_failed_is_told_in_the_usual_shape(client: TestClient, caplog: pytest.LogCaptureFixture) -> None:
    jobs: Jobs = client.app.state.jobs  # type: ignore[attr-defined]

    def refused(_: Computation) -> None:
        raise Refused("Not now.")

    def mistaken(_: Computation) -> None:
        raise ZeroDivisionError

    for work, message in (
        (refused, "Not now."),
        (mistaken, "StepRamp made a mistake: ZeroDivisionError. It is logged."),
    ):
        job = ended(jobs.start("motor_map", message.encode(), work))
        told = client.get(f"/api/v1/jobs/{job.id}").json()
        assert told == {
            "id": job.id, "kind": "motor_map", "state": "failed", "progress": 0.0, "result": None,
            "errors": [{"field": None, "value": None, "allowed": None, "message": message}],
        }  # fmt: skip
    assert [record.exc_info[0] for record in caplog.records if record.exc_info] == [ZeroDivisionError]


def test_one_that_nobody_asks_about_is_cancelled(jobs: Jobs, monkeypatch: pytest.MonkeyPatch) -> None:
    work = Work()
    job = jobs.start("some", b"", work)
    assert work.begun.acquire(timeout=PATIENCE_S)
    monkeypatch.setattr(job_registry, "UNASKED_S", 0.0)
    assert ended(job).state == "cancelled"


def test_those_that_wait_and_nobody_asks_about_leave_their_place(jobs: Jobs, monkeypatch: pytest.MonkeyPatch) -> None:
    work = Work()
    running = [jobs.start("some", bytes([number]), work) for number in range(MOST_RUNNING)]
    for _ in running:
        assert work.begun.acquire(timeout=PATIENCE_S)
    waiting = [jobs.start("some", bytes([9, number]), work) for number in range(MOST_WAITING)]
    time_s = time.monotonic() + job_registry.UNASKED_S + 1
    monkeypatch.setattr(job_registry.time, "monotonic", lambda: time_s)
    for job in (*running, *waiting[1:]):
        jobs.get(job.id)
    added = jobs.start("some", b"more", work)
    assert [job.state for job in (*running, waiting[0], added)] == ["running", "running", "cancelled", "waiting"]
    assert {job.state for job in waiting[1:]} == {"waiting"}


def test_one_that_is_not_there_is_not_found(client: TestClient) -> None:
    for ask in (client.get, client.delete):
        answer = ask("/api/v1/jobs/0")
        assert answer.status_code == 404
        assert "There is no job '0'" in answer.json()["errors"][0]["message"]
