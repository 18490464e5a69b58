"""Jobs: what is computed for longer than a request lasts. Who began one asks for it, and may cancel it.

Who asks the same has a job of their own, and one computation answers all of them: it ends when none of them is left. It
has a thread of its own, which only waits for those that compute: `stepramp.executors`.
"""

import logging
import threading
import time
from collections.abc import Callable, MutableMapping
from concurrent.futures import Future, ThreadPoolExecutor
from functools import partial
from secrets import token_hex
from typing import Literal, TypeVar

from stepramp.errors import NotFound, Overloaded, StepRampError, TooOften, shown
from stepramp.executors.priority import be_nicer
from stepramp.executors.threads import NICER
from stepramp.http_api.access import ASKING
from stepramp.http_api.answer import Answer

State = Literal["waiting", "running", "done", "cancelled", "failed"]

MOST_RUNNING = 2
MOST_WAITING = 8
MOST_OF_A_CLIENT = 3
"""So many of one client run or wait, where several share the server."""
MOST_ALIKE = 32
"""So many may ask the same before it is answered."""
MOST_KEPT = 32
"""So many that have ended are kept; the oldest is forgotten."""
UNASKED_S = 120.0
"""A job that nobody has asked about for so long is cancelled: its page is gone. Hidden pages ask once a minute [s]."""

_logger = logging.getLogger(__name__)


class Computation:
    """What answers a question, for all jobs that ask it. Who computes it tells how far it is, from any thread."""

    def __init__(self) -> None:
        """Make one that waits for its turn."""
        self.progress = 0.0
        self.result: Answer | None = None
        """What is known so far; of one that is done, all."""
        self.error: StepRampError | None = None
        """Why it failed."""
        self._state: State = "waiting"
        self._jobs: list[Job] = []
        self._lock = threading.Lock()

    @property
    def state(self) -> State:
        """What has become of it."""
        return self._state

    @property
    def has_ended(self) -> bool:
        """Whether nothing more comes."""
        return self._state not in ("waiting", "running")

    def take(self, job: "Job") -> bool:
        """Note that one more job asks for it; return False where it has come to nothing. Raises Overloaded."""
        with self._lock:
            if self._state in ("cancelled", "failed"):
                return False
            if len(self._jobs) >= MOST_ALIKE:
                raise Overloaded(f"{MOST_ALIKE} jobs ask the same already. Cancel one, or ask again later.")
            if self._state != "done":
                self._jobs.append(job)
            return True

    def leave(self, job: "Job") -> None:
        """Note that a job doesn't ask for it any more; with the last one it ends."""
        with self._lock:
            self._jobs = [each for each in self._jobs if each is not job]
            if not self._jobs and not self.has_ended:
                self._state = "cancelled"

    def is_wanted(self) -> bool:
        """Tell who computes it whether to go on: not when it has ended, or nobody asks about it any more."""
        for job in tuple(self._jobs):
            if job.is_abandoned:
                job.cancel()
        return not self.has_ended

    def tell(self, progress: float, result: Answer) -> None:
        """Note how far it is, from 0 to 1, and what is known so far."""
        self.progress, self.result = progress, result

    def begin(self) -> bool:
        """Note that its turn has come; return whether it is still wanted."""
        is_wanted = self.is_wanted()
        with self._lock:
            if self._state == "waiting":
                self._state = "running"
        return is_wanted

    def end(self, state: State, error: StepRampError | None = None) -> None:
        """Note its end; the first one holds."""
        with self._lock:
            if not self.has_ended:
                self._state, self.error = state, error
            self._jobs = []


class Job:
    """What one client has asked for, and may cancel, whoever else asks the same."""

    def __init__(self, kind: str, computation: Computation) -> None:
        """Make a job that a computation answers, once that has taken it."""
        self.id, self.kind = token_hex(8), kind
        self.client = ASKING.get()
        """Who has begun it, where that has to be known."""
        self._computation = computation
        self._asked_s = time.monotonic()
        self._left: tuple[float, Answer | None] | None = None

    @property
    def state(self) -> State:
        """What has become of it."""
        return "cancelled" if self._left else self._computation.state

    @property
    def has_ended(self) -> bool:
        """Whether nothing more comes."""
        return self._left is not None or self._computation.has_ended

    @property
    def progress(self) -> float:
        """How far it is, from 0 to 1; of one that was cancelled, how far it was then."""
        return self._left[0] if self._left else self._computation.progress

    @property
    def result(self) -> Answer | None:
        """What is known so far; of one that was cancelled, what was known then."""
        return self._left[1] if self._left else self._computation.result

    @property
    def error(self) -> StepRampError | None:
        """Why it failed."""
        return None if self._left else self._computation.error

    @property
    def is_abandoned(self) -> bool:
        """Whether nobody has asked about it for long."""
        return time.monotonic() - self._asked_s > UNASKED_S

    def asked(self) -> None:
        """Note that somebody still waits for it."""
        self._asked_s = time.monotonic()

    def cancel(self) -> None:
        """End it, unless it has ended; the others that ask the same go on."""
        if not self.has_ended:
            self._left = self._computation.progress, self._computation.result
            self._computation.leave(self)


class Jobs:
    """The application's jobs: so many run, so many wait for their turn, and so many are kept when they have ended."""

    def __init__(self) -> None:
        self._pool = ThreadPoolExecutor(MOST_RUNNING, "job", initializer=be_nicer, initargs=(NICER,))
        self._lock = threading.Lock()
        self._of_questions: dict[tuple[str, bytes], Computation] = {}
        self._jobs: dict[str, Job] = {}

    def start(self, kind: str, question: bytes, work: Callable[[Computation], None]) -> Job:
        """Return a new job, answered by a computation that answers or answered the same question, or else by a new one.

        kind, question: what tells computations apart. work: computes it, telling the computation, in a thread of its
        own; it ends when that isn't wanted any more, as it likes. Raises Overloaded when too many wait, TooOften
        when one client has begun too many.
        """
        with self._lock:
            self._refuse_too_many_of_one()
            known = self._of_questions.get((kind, question))
            if known is not None and known.take(job := Job(kind, known)):
                self._keep(job)
                return job
            waiting = [each for each in self._of_questions.values() if each.state == "waiting"]
            # Whose page is gone keeps nobody from their turn.
            if sum(each.is_wanted() for each in waiting) >= MOST_WAITING:
                raise Overloaded(f"{MOST_WAITING} jobs wait for their turn already. Cancel one, or ask again later.")
            computation = Computation()
            job = Job(kind, computation)
            computation.take(job)
            self._of_questions.pop((kind, question), None)
            self._of_questions[kind, question] = computation
            self._keep(job)
        self._pool.submit(_run, computation, work).add_done_callback(partial(_ended, computation))
        return job

    def get(self, job_id: str) -> Job:
        """Return a job that is asked about. Raises NotFound when there is none, or none any more."""
        with self._lock:
            job = self._jobs.get(job_id)
        if job is None:
            raise NotFound(f"There is no job {shown(job_id)}; of those that have ended the last {MOST_KEPT} are kept.")
        job.asked()
        return job

    def close(self) -> None:
        """Cancel all of them."""
        with self._lock:
            jobs = list(self._jobs.values())
        for job in jobs:
            job.cancel()
        self._pool.shutdown(wait=False, cancel_futures=True)

    def _refuse_too_many_of_one(self) -> None:
        client = ASKING.get()
        theirs = (each for each in self._jobs.values() if each.client == client and not each.has_ended)
        if client is not None and sum(1 for _ in theirs) >= MOST_OF_A_CLIENT:
            raise TooOften(f"{MOST_OF_A_CLIENT} jobs of yours run or wait already. Cancel one, or ask again later.")

    def _keep(self, job: Job) -> None:
        self._jobs[job.id] = job
        _forget(self._jobs)
        _forget(self._of_questions)


K = TypeVar("K")


def _forget(kept: MutableMapping[K, Job] | MutableMapping[K, Computation]) -> None:
    """Forget the oldest of those that have ended."""
    ended = [key for key, each in kept.items() if each.has_ended]
    for key in ended[:-MOST_KEPT]:
        del kept[key]


def _run(computation: Computation, work: Callable[[Computation], None]) -> None:
    if computation.begin():
        work(computation)


def _ended(computation: Computation, done: Future[None]) -> None:
    error = None if done.cancelled() else done.exception()
    if error is None:
        computation.end("done")
    elif isinstance(error, StepRampError):
        computation.end("failed", error)
    elif not computation.has_ended:  # What is raised by what nobody wants any more is told to nobody.
        _logger.error("A job failed", exc_info=error)
        computation.end("failed", StepRampError(f"StepRamp made a mistake: {type(error).__name__}. It is logged."))
