import threading
from collections.abc import Callable, Iterator

import pytest

from stepramp.errors import DeviceLost, Refused
from stepramp.link.worker import Worker

PATIENCE_S = 10.0


class Port:
    """What a worker owns in these tests; counts polls and remembers how it ended."""

    def __init__(self) -> None:
        self.polled = threading.Semaphore(0)
        self.poll_pause_s = 0.01
        self.poll_error: Exception | None = None
        self.ends: list[DeviceLost | None] = []
        self.ended = threading.Event()
        self.worker = Worker("test", self.poll, self.end)

    def poll(self) -> float:
        if self.poll_error:
            raise self.poll_error
        self.polled.release()
        return self.poll_pause_s

    def end(self, loss: DeviceLost | None) -> None:
        self.ends.append(loss)
        self.ended.set()

    def occupy(self) -> "LongCall":
        return LongCall(self.worker)


class LongCall:
    """A call that lasts until it is released, and gives way when told to."""

    def __init__(self, worker: Worker) -> None:
        self._begun, self._release = threading.Event(), threading.Event()
        self._gap = threading.Semaphore(0)
        self._worker = worker
        self._thread = threading.Thread(target=lambda: worker.call(self._run))
        self._thread.start()
        assert self._begun.wait(PATIENCE_S)

    def _run(self) -> None:
        self._begun.set()
        while not self._release.is_set():
            if self._gap.acquire(timeout=0.01):
                self._worker.give_way()

    def give_way(self) -> None:
        self._gap.release()

    def end(self) -> None:
        self._release.set()
        self._thread.join(PATIENCE_S)


def in_thread(call: Callable[[], object], results: list[object]) -> threading.Thread:
    def run() -> None:
        try:
            results.append(call())
        except Exception as error:
            results.append(error)

    thread = threading.Thread(target=run)
    thread.start()
    return thread


def wait_until(condition: Callable[[], bool]) -> None:
    pause = threading.Event()
    for _ in range(1000):
        if condition():
            return
        pause.wait(0.01)
    raise AssertionError("it did not come about")


@pytest.fixture
def port() -> Iterator[Port]:
    port = Port()
    yield port
    port.worker.close()


def test_results_and_errors_come_back(port: Port) -> None:
    assert port.worker.call(lambda: 42) == 42
    with pytest.raises(ZeroDivisionError):
        port.worker.call(lambda: 1 // 0)
    assert port.worker.call(lambda: "still there") == "still there"


def test_all_calls_of_all_threads_run_in_the_one_thread(port: Port) -> None:
    results: list[object] = []
    threads = [in_thread(lambda: port.worker.call(threading.get_ident), results) for _ in range(20)]
    for thread in threads:
        thread.join(PATIENCE_S)
    assert len(results) == 20
    assert set(results) != {threading.get_ident()}
    assert len(set(results)) == 1


def test_it_polls_when_nothing_else_is_to_be_done(port: Port) -> None:
    for _ in range(5):
        assert port.polled.acquire(timeout=PATIENCE_S)


def test_an_urgent_call_runs_in_the_midst_of_a_long_one(port: Port) -> None:
    push = port.occupy()
    stopped = port.worker.call_urgently(lambda: "stopped")
    push.give_way()
    assert stopped.result(PATIENCE_S) == "stopped"
    push.end()


def test_urgent_calls_come_in_their_order_and_do_not_interrupt_each_other(port: Port) -> None:
    push = port.occupy()
    order: list[str] = []

    def stop() -> None:
        order.append("stop begins")
        port.worker.give_way()
        order.append("stop ends")

    futures = [port.worker.call_urgently(stop), port.worker.call_urgently(lambda: order.append("halt"))]
    push.give_way()
    for future in futures:
        future.result(PATIENCE_S)
    push.end()
    assert order == ["stop begins", "stop ends", "halt"]


def test_a_stop_refuses_the_moves_that_wait(port: Port) -> None:
    push = port.occupy()
    moved: list[object] = []
    move = in_thread(lambda: port.worker.call(lambda: "moved"), moved)
    wait_until(lambda: bool(port.worker._waiting))
    stopped = port.worker.call_urgently(lambda: "stopped")
    move.join(PATIENCE_S)
    assert isinstance(moved[0], Refused)
    push.end()
    assert stopped.result(PATIENCE_S) == "stopped"


def test_a_pause_ends_with_its_time(port: Port) -> None:
    assert port.worker.call(lambda: port.worker.give_way(0.02)) is None


def lose() -> None:
    raise DeviceLost("gone")


def test_a_loss_ends_everything_and_is_seen_before_the_caller_hears_of_it(port: Port) -> None:
    with pytest.raises(DeviceLost, match="gone"):
        port.worker.call(lose)
    assert [str(loss) for loss in port.ends] == ["gone"]
    with pytest.raises(DeviceLost, match="gone"):
        port.worker.call(lambda: None)
    with pytest.raises(DeviceLost, match="gone"):
        port.worker.call_urgently(lambda: None)


def test_a_loss_found_by_a_stop_ends_the_long_call_too(port: Port) -> None:
    results: list[object] = []
    begun = threading.Event()

    def push() -> None:
        begun.set()
        port.worker.give_way(PATIENCE_S)
        port.worker.give_way(PATIENCE_S)

    thread = in_thread(lambda: port.worker.call(push), results)
    assert begun.wait(PATIENCE_S)
    stopped = port.worker.call_urgently(lose)
    with pytest.raises(DeviceLost):
        stopped.result(PATIENCE_S)
    thread.join(PATIENCE_S)
    assert isinstance(results[0], DeviceLost)


@pytest.mark.parametrize("error", [DeviceLost("unplugged"), Refused("unplugged")])
def test_a_loss_found_by_a_poll(port: Port, error: Exception) -> None:
    port.poll_error = error
    assert port.ended.wait(PATIENCE_S)
    assert [str(loss) for loss in port.ends] == ["unplugged"]


@pytest.mark.filterwarnings("ignore::pytest.PytestUnhandledThreadExceptionWarning")
def test_a_mistake_in_a_poll_leaves_nobody_waiting(port: Port) -> None:
    port.poll_error = ZeroDivisionError("a mistake")
    assert port.ended.wait(PATIENCE_S)
    with pytest.raises(Refused, match="disconnected"):
        port.worker.call(lambda: None)


def test_calls_that_wait_hear_of_the_loss(port: Port) -> None:
    results: list[object] = []
    begun, go_on = threading.Event(), threading.Event()

    def lose_later() -> None:
        begun.set()
        assert go_on.wait(PATIENCE_S)
        lose()

    threads = [in_thread(lambda: port.worker.call(lose_later), results)]
    assert begun.wait(PATIENCE_S)
    threads.append(in_thread(lambda: port.worker.call(lambda: "moved"), results))
    wait_until(lambda: bool(port.worker._waiting))
    go_on.set()
    for thread in threads:
        thread.join(PATIENCE_S)
    assert [type(result) for result in results] == [DeviceLost, DeviceLost]


def test_closing_lets_the_present_call_end_and_refuses_the_others(port: Port) -> None:
    push = port.occupy()
    results: list[object] = []
    moving = in_thread(lambda: port.worker.call(lambda: "moved"), results)
    wait_until(lambda: bool(port.worker._waiting))
    closing = in_thread(port.worker.close, [])
    push.end()
    for thread in (moving, closing):
        thread.join(PATIENCE_S)
    assert isinstance(results[0], Refused)
    assert port.ends == [None]
    with pytest.raises(Refused, match="disconnected"):
        port.worker.call(lambda: None)
    port.worker.close()
    assert port.ends == [None]


def test_a_mistake_in_telling_the_end_leaves_nobody_waiting(caplog: pytest.LogCaptureFixture) -> None:
    def cant_tell(_: DeviceLost | None) -> None:
        raise ZeroDivisionError("a mistake")

    worker = Worker("test", lambda: 0.01, cant_tell)
    results: list[object] = []
    begun, go_on = threading.Event(), threading.Event()

    def lose_later() -> None:
        begun.set()
        assert go_on.wait(PATIENCE_S)
        lose()

    threads = [in_thread(lambda: worker.call(lose_later), results)]
    assert begun.wait(PATIENCE_S)
    threads.append(in_thread(lambda: worker.call(lambda: "moved"), results))
    wait_until(lambda: bool(worker._waiting))
    go_on.set()
    for thread in threads:
        thread.join(PATIENCE_S)
    assert [type(result) for result in results] == [DeviceLost, DeviceLost]
    assert "could not be told" in caplog.text


def test_a_stop_that_nobody_waits_for_any_more_is_carried_out(port: Port) -> None:
    push = port.occupy()
    stopped = port.worker.call_urgently(lambda: "stopped")
    assert not stopped.cancel()
    push.give_way()
    push.end()
    assert stopped.result(PATIENCE_S) == "stopped"
    assert port.worker.call(lambda: "still there") == "still there"


def test_a_long_call_ends_where_it_gives_way_once_the_thread_is_to_end(port: Port) -> None:
    results: list[object] = []
    begun = threading.Event()

    def connect() -> None:
        begun.set()
        while True:
            port.worker.give_way(0.01)

    thread = in_thread(lambda: port.worker.call(connect), results)
    assert begun.wait(PATIENCE_S)
    port.worker.close(PATIENCE_S)
    thread.join(PATIENCE_S)
    assert isinstance(results[0], Refused)


def test_polls_come_however_many_calls_wait(port: Port) -> None:
    """What a poll sees to, as leases that run out, must not wait for those who ask and ask."""
    ended = threading.Event()

    def ask_and_ask() -> None:
        while not ended.is_set():
            port.worker.call(lambda: None)

    threads = [in_thread(ask_and_ask, []) for _ in range(6)]
    for _ in range(20):
        assert port.polled.acquire(timeout=PATIENCE_S)
    ended.set()
    for thread in threads:
        thread.join(PATIENCE_S)


def test_an_urgent_call_may_leave_those_that_wait(port: Port) -> None:
    push = port.occupy()
    results: list[object] = []
    waiting = in_thread(lambda: port.worker.call(lambda: "asked"), results)
    wait_until(lambda: bool(port.worker._waiting))
    ended = port.worker.call_urgently(lambda: "ended", overtakes=False)
    push.end()
    waiting.join(PATIENCE_S)
    assert (results, ended.result(PATIENCE_S)) == (["asked"], "ended")
