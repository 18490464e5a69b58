"""How long it takes from a slider's event to the painted frame, measured in Chromium, in the page itself.

usage: python tests/benchmarks/frame_times.py [--edits N]
"""

import argparse
import os
import statistics
import sys
from collections.abc import Collection
from pathlib import Path
from typing import Any

from playwright.sync_api import Page, sync_playwright

# As a script it finds only its own folder; ./dev bench finds it beside the others.
sys.path.insert(0, str(Path(__file__).parents[1]))

from browser.server import CHROMIUM, CHROMIUM_ARGUMENTS, Server
from browser.stepramp_page import ACCELERATION, SLEW_SPEED, StepRampPage

FOUR_METHODS = {"exact", "first_order", "second_order", "newton"}
FOR_ALL_SHAPES = {"exact", "ideal", "midpoint", "newton"}
SHAPES = ("constant", "s_curve", "cosine", "drawn")
MOVES = {10_000: ("2000", "450"), 1_000_000: ("10000", "500")}
"""By steps of the move: slew speed and acceleration, as they are typed."""
WARM_UP, EVENTS = 30, 200
EDITS = 10_000

MEASURE = """async ([path, count, isPaced]) => {
    const slider = document.querySelector(`.parameter[data-path="${path}"] .slider`);
    const asked = () => document.querySelector('[data-figure="peak"] .more').textContent;
    const wanted = () => document.querySelector(`.parameter[data-path="${path}"] input.number`).value;
    const frame = () => new Promise((done) => requestAnimationFrame(done));
    // After the frame that follows: what was drawn before it is on the screen.
    const painted = () => frame().then(() => new Promise((done) => {
        const channel = new MessageChannel();
        channel.port1.onmessage = () => done(performance.now());
        channel.port2.postMessage(0);
    }));
    const events = [], times = [], scripts = [];
    let done = 0;
    const watch = new MutationObserver(async () => {
        const text = asked();
        const at = await painted();
        const index = events.findLastIndex((event) => text.includes(` ${event.value} `));
        for (; done <= index; done += 1) times.push(at - events[done].at);
    });
    const figure = document.querySelector('[data-figure="peak"]');
    watch.observe(figure, {childList: true, subtree: true, characterData: true});
    const [low, high] = [Number(slider.max) * 0.45, Number(slider.max) * 0.55];
    for (let i = 0; i < count; i += 1) {
        slider.value = String(Math.round(low + (high - low) * (0.5 + 0.5 * Math.sin(i / 7))) + (i % 3));
        const before = wanted();
        const at = performance.now();
        slider.dispatchEvent(new Event('input', {bubbles: true}));
        if (wanted() === before) continue; // nothing is asked then, so nothing will be painted
        scripts.push(performance.now() - at);
        events.push({at, value: wanted()});
        if (isPaced) await frame();
        else {
            while (done < events.length && performance.now() - at < 3000) await new Promise((go) => setTimeout(go, 1));
            await new Promise((go) => setTimeout(go, Math.random() * 17));
        }
    }
    await new Promise((go) => setTimeout(go, 1000));
    slider.dispatchEvent(new Event('change', {bubbles: true}));
    watch.disconnect();
    return {times, missed: events.length - times.length, scripts};
}"""

EDIT = """async ([path, count]) => {
    const slider = document.querySelector(`.parameter[data-path="${path}"] .slider`);
    for (let i = 0; i < count; i += 1) {
        slider.value = String(Number(slider.max) * (0.45 + 0.1 * ((i * 7919) % 1000) / 1000));
        slider.dispatchEvent(new Event('input', {bubbles: true}));
        if (i % 5 === 4) await new Promise((done) => requestAnimationFrame(done));
    }
    slider.dispatchEvent(new Event('change', {bubbles: true}));
    await new Promise((done) => setTimeout(done, 1500));
}"""


def frame_times(edits: int = EDITS) -> None:
    """Print the times of frames, and what many edits leave behind in memory."""
    with Server() as server, sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=CHROMIUM_ARGUMENTS)
        print(f"Chromium {browser.version}, load {os.getloadavg()[0]:.1f} at the beginning")
        print("\n| steps | events | to the painted frame ms: median | 95 % | largest | script ms: median |")
        print("|---:|---|---:|---:|---:|---:|")
        page = browser.new_page(viewport={"width": 1440, "height": 900})
        stepramp = StepRampPage(page, server.url).open()
        for steps in MOVES:
            prepare(stepramp, steps)
            for words, is_paced in (("one after another", False), ("one a frame", True)):
                measure(page, WARM_UP, is_paced)
                print(f"| {steps:,} | {words} {row(measure(page, EVENTS, is_paced))}", flush=True)
        print("\n| 10,000 steps, one after another | ms: median | 95 % | largest | script ms: median |")
        print("|---|---:|---:|---:|---:|")
        for shape in SHAPES:
            prepare(stepramp, 10_000, FOR_ALL_SHAPES, shape)
            measure(page, WARM_UP, False)
            print(f"| {shape} {row(measure(page, EVENTS, False))}", flush=True)
        prepare(stepramp, 10_000)
        page.evaluate(EDIT, [SLEW_SPEED, 500])
        before = left_behind(page)
        page.evaluate(EDIT, [SLEW_SPEED, edits])
        after = left_behind(page)
        print(f"\n| {edits:,} edits | before | after |\n|---|---:|---:|")
        for name, value in before.items():
            print(f"| {name} | {value:,.1f} | {after[name]:,.1f} |")
        browser.close()


def prepare(
    stepramp: StepRampPage, steps: int, methods: Collection[str] = FOUR_METHODS, shape: str = "constant"
) -> None:
    """Show a move of so many steps with four methods."""
    stepramp.page.locator("#shape").select_option(shape)
    speed, acceleration = MOVES[steps]
    for path, text in (("timer.frequency_hz", "16000000"), ("timer.counter_bits", "32"), (SLEW_SPEED, speed),
                       (ACCELERATION, acceleration), ("move.steps", str(steps))):  # fmt: skip
        stepramp.field(path).fill(text)
    for chip in stepramp.page.locator(".chip").all():
        is_on = chip.get_attribute("aria-pressed") == "true"
        if is_on != (chip.get_attribute("data-method") in methods):
            chip.click()
    stepramp.page.wait_for_timeout(1500)


def measure(page: Page, events: int, is_paced: bool) -> dict[str, Any]:
    """Move the slider of the slew speed and return what the page measured."""
    return page.evaluate(MEASURE, [SLEW_SPEED, events, is_paced])


def row(measured: dict[str, Any]) -> str:
    """Return the cells of a table's line."""
    times = measured["times"]
    cells = (statistics.median(times), statistics.quantiles(times, n=20)[-1], max(times))
    script = statistics.median(measured["scripts"])
    missed = f" ({measured['missed']} never painted)" if measured["missed"] else ""
    return missed + "| " + " | ".join(f"{cell:.1f}" for cell in (*cells, script)) + " |"


def left_behind(page: Page) -> dict[str, float]:
    """Return what the page holds after a collection of garbage."""
    session = page.context.new_cdp_session(page)
    session.send("HeapProfiler.collectGarbage")
    heap, counters = session.send("Runtime.getHeapUsage"), session.send("Memory.getDOMCounters")
    session.detach()
    return {
        "JS heap MiB": heap["usedSize"] / 2**20,
        "DOM nodes": counters["nodes"],
        "event listeners": counters["jsEventListeners"],
    }


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--edits", type=int, default=EDITS)
    frame_times(parser.parse_args().edits)
