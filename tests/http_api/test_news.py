"""News of the devices: written once for all who listen."""

import asyncio
import json
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import pytest

from event_loop import run
from stepramp.devices.view import DeviceView
from stepramp.http_api.news import News

LISTENERS = 20
NEVER_S = 3600.0


class FakeDevices:
    """Devices that change when they are told to."""

    def __init__(self) -> None:
        self.asked = 0
        self.names: list[str] = []
        self.tell: Any = None
        self.mistake: Exception | None = None

    def views(self) -> list[DeviceView]:
        self.asked += 1
        mistake, self.mistake = self.mistake, None
        if mistake is not None:
            raise mistake
        return [DeviceView("1", "sim://", name, "stepramp") for name in self.names]

    @contextmanager
    def listening(self, listener: Any) -> Iterator[None]:
        self.tell = listener
        yield

    def change(self, name: str) -> None:
        self.names = [name]
        self.tell()


def names(edition: str) -> list[str]:
    return [device["name"] for device in json.loads(edition)["devices"]]


def test_each_change_is_written_once_for_all() -> None:
    async def work() -> None:
        devices = FakeDevices()
        news = News(devices, NEVER_S)  # type: ignore[arg-type]  # what it needs of them
        publishing = asyncio.create_task(news.publish())
        listening = [news.editions() for _ in range(LISTENERS)]
        assert [names(await anext(editions)) for editions in listening] == [[]] * LISTENERS
        asked = devices.asked
        waiting = [asyncio.create_task(anext(editions)) for editions in listening]  # type: ignore[arg-type]
        await asyncio.sleep(0)
        devices.change("b")
        assert [names(await each) for each in waiting] == [["b"]] * LISTENERS
        assert devices.asked == asked + 1
        publishing.cancel()
        for editions in listening:
            await editions.aclose()

    run(work())


def test_who_is_slow_gets_the_newest() -> None:
    async def work() -> None:
        devices = FakeDevices()
        news = News(devices, NEVER_S)  # type: ignore[arg-type]
        publishing = asyncio.create_task(news.publish())
        await asyncio.sleep(0)
        slow, quick = news.editions(), news.editions()
        await anext(slow)
        await anext(quick)
        for name in ("b", "c", "d"):
            devices.change(name)
            assert names(await anext(quick)) == [name]
        assert names(await anext(slow)) == ["d"]
        publishing.cancel()
        await slow.aclose()
        await quick.aclose()

    run(work())


def test_who_comes_later_hears_at_once_how_things_are() -> None:
    async def work() -> None:
        devices = FakeDevices()
        news = News(devices, NEVER_S)  # type: ignore[arg-type]
        publishing = asyncio.create_task(news.publish())
        await asyncio.sleep(0)
        devices.change("b")
        editions = news.editions()
        assert names(await anext(editions)) == ["b"]
        publishing.cancel()
        await editions.aclose()

    run(work())


def test_editions_come_without_a_change() -> None:
    async def work() -> None:
        devices = FakeDevices()
        news = News(devices, beat_s=0.0)  # type: ignore[arg-type]
        publishing = asyncio.create_task(news.publish())
        editions = news.editions()
        assert [names(await anext(editions)) for _ in range(3)] == [[]] * 3
        publishing.cancel()
        await editions.aclose()

    run(work())


def test_a_mistake_in_one_edition_is_logged_and_the_next_one_comes(caplog: pytest.LogCaptureFixture) -> None:
    async def work() -> None:
        devices = FakeDevices()
        news = News(devices, NEVER_S)  # type: ignore[arg-type]
        publishing = asyncio.create_task(news.publish())
        await asyncio.sleep(0)
        editions = news.editions()
        await anext(editions)
        devices.mistake = ZeroDivisionError()
        devices.change("b")
        while devices.mistake:
            await asyncio.sleep(0)
        devices.change("c")
        assert names(await anext(editions)) == ["c"]
        assert "could not be told" in caplog.text
        publishing.cancel()
        await editions.aclose()

    run(work())
