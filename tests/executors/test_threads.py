"""The cores of this machine, as those who compute many things at once."""

import threading
from collections.abc import Callable, Iterable, Iterator

import pytest

from stepramp.executors.threads import AHEAD, Threads

PATIENCE_S = 10.0


def doubled(item: int, _: Callable[[], bool]) -> int:
    return 2 * item


def test_each_item_comes_back_once_with_its_result() -> None:
    assert sorted(Threads(2).results(doubled, range(50), lambda: True)) == [(item, 2 * item) for item in range(50)]


def test_it_ends_when_nobody_waits_and_what_has_begun_is_told() -> None:
    wanted, begun, ended = threading.Event(), threading.Semaphore(0), threading.Semaphore(0)
    wanted.set()

    def until_unwanted(_: int, is_wanted: Callable[[], bool]) -> None:
        begun.release()
        while is_wanted():
            threading.Event().wait(0.001)
        ended.release()

    def give_up() -> None:
        for _ in range(2):
            begun.acquire(timeout=PATIENCE_S)
        wanted.clear()

    giving_up = threading.Thread(target=give_up)
    giving_up.start()
    assert list(Threads(2).results(until_unwanted, range(100), wanted.is_set)) == []
    giving_up.join()
    for _ in range(2):
        assert ended.acquire(timeout=PATIENCE_S)
    # Of the others at most those that were handed out.
    assert sum(begun.acquire(blocking=False) for _ in range(100)) <= 2 * AHEAD - 2


class Noted(list[int]):
    """Items that note which of them were taken."""

    def __init__(self, items: Iterable[int]) -> None:
        super().__init__(items)
        self.taken: list[int] = []

    def __iter__(self) -> Iterator[int]:
        for item in super().__iter__():
            self.taken.append(item)
            yield item


def test_no_more_are_handed_out_while_slow_ones_last() -> None:
    """Else others who ask would wait behind them."""
    wanted, items = threading.Event(), Noted(range(100))
    wanted.set()
    looks = iter(range(6))

    def is_wanted() -> bool:
        if next(looks, None) is None:
            wanted.clear()
        return wanted.is_set()

    def until_unwanted(_: int, __: Callable[[], bool]) -> None:
        while wanted.is_set():
            threading.Event().wait(0.001)

    assert list(Threads(2).results(until_unwanted, items, is_wanted)) == []
    assert len(items.taken) == 2 * AHEAD


def test_what_a_task_raises_is_raised() -> None:
    def odd(item: int, _: Callable[[], bool]) -> int:
        if item % 2:
            raise ValueError(item)
        return item

    with pytest.raises(ValueError, match=r"[13]"):
        list(Threads(2).results(odd, range(4), lambda: True))


def test_who_asks_later_needn_t_wait_for_all_of_who_asked_first() -> None:
    threads, turns = Threads(1), list[str]()

    def note(name: str, _: Callable[[], bool]) -> None:
        turns.append(name)

    first = threads.results(note, ["first"] * 100, lambda: True)
    next(first)
    assert len(list(threads.results(note, ["second"], lambda: True))) == 1
    assert turns.index("second") <= 1 + 2 * AHEAD
    assert len(list(first)) == 99
