"""The page as a person uses it: looked at, pressed, typed into and dragged, in any browser."""

from typing import Any

from browser.stepramp_page import StepRampPage, until
from engines.engine import Engine

Place = tuple[int, int]

KEYS = {
    "Tab": "\ue004",
    "Enter": "\ue006",
    "Shift": "\ue008",
    "Control": "\ue009",
    "Escape": "\ue00c",
    "Space": " ",
    "ArrowUp": "\ue013",
    "ArrowRight": "\ue014",
}
"""WebDriver's characters for keys that have none."""

PLACE = """(selector, right, down) => {
    const one = document.querySelector(selector);
    if (!one || one.disabled) return null;
    one.scrollIntoView({block: 'nearest', inline: 'nearest'});
    const box = one.getBoundingClientRect();
    const [x, y] = [Math.round(box.x + right * box.width), Math.round(box.y + down * box.height)];
    return one.contains(document.elementFromPoint(x, y)) ? [x, y] : null;
}"""
"""A place on an element, once it is there to be pressed: enabled, in sight and not under another."""

CURVES = """() => Object.fromEntries((document.querySelector('.figure')?.data ?? [])
    .filter((trace) => trace.visible).map((trace) => [trace.uid, Array.from(trace.y)]))"""


class EnginePage:
    """The open page in a browser."""

    def __init__(self, engine: Engine, url: str) -> None:
        self.engine, self.url = engine, url

    def open(self) -> None:
        """Open it as if the browser had never seen it."""
        self.engine.open(f"{self.url}favicon.svg")
        self.engine.call("() => { localStorage.clear(); localStorage.setItem('stepramp.guide', 'closed'); }")
        self.engine.open(self.url)
        self.wait_for(".figure .scatterlayer path.js-line")

    def follow(self, link: str) -> None:
        """Open a link to the page in the open page."""
        self.engine.call("(link) => { location.href = link; }", link)

    # ---- looking ----

    def is_shown(self, selector: str) -> bool:
        function = "(selector) => document.querySelector(selector)?.checkVisibility() ?? false"
        return bool(self.engine.call(function, selector))

    def wait_for(self, selector: str) -> None:
        until(lambda: self.is_shown(selector))

    def text(self, selector: str) -> str:
        return str(self.engine.call("(selector) => document.querySelector(selector).innerText", selector))

    def wait_for_text(self, selector: str, words: str) -> None:
        until(lambda: words in self.text(selector))

    def value(self, selector: str) -> str:
        return str(self.engine.call("(selector) => document.querySelector(selector).value", selector))

    def has_focus(self, selector: str) -> bool:
        """Whether what has the focus is such an element or within one."""
        return bool(self.engine.call("(selector) => document.activeElement.closest(selector) !== null", selector))

    def curves(self) -> dict[str, list[float]]:
        """Return the y values of every visible trace, by method and plot: "first_order-error"."""
        return dict(self.engine.call(CURVES))

    def x_range(self) -> list[float]:
        return list(self.engine.call("() => document.querySelector('.figure').layout.xaxis.range"))

    def requests(self, end: str) -> int:
        """Count the requests of their own, not over a socket, to addresses that end so."""
        function = "(end) => performance.getEntriesByType('resource').filter(({name}) => name.endsWith(end)).length"
        return int(self.engine.call(function, end))

    def table_rows(self) -> list[list[str]]:
        function = """() => Array.from(document.querySelectorAll('#table-rows tr.row'),
            (row) => Array.from(row.querySelectorAll('input'), (cell) => cell.value))"""
        return list(self.engine.call(function))

    # ---- the pointer ----

    def place(self, selector: str, right: float = 0.5, down: float = 0.5) -> Place:
        """Return a place in an element, by parts of its width and height, once it rests and can be pressed."""
        seen: list[Any] = [None]

        def rests() -> bool:
            seen.append(self.engine.call(PLACE, selector, right, down))
            return seen[-1] is not None and seen[-1] == seen[-2]

        until(rests)
        x, y = seen[-1]
        return x, y

    def click(self, selector: str, down: float = 0.5, times: int = 1, held_ms: int = 0) -> None:
        held = {"type": "pause", "duration": held_ms}
        self._point(move(self.place(selector, down=down)), *[DOWN, held, UP] * times)

    def hold(self, start: Place, end: Place) -> None:
        """Press at a place and move to another, without letting go."""
        self._point(move(start), DOWN)
        self.move_on(start, end)

    def move_on(self, start: Place, end: Place) -> None:
        """Move from a place to another in a few steps."""
        self._point(*(move(between(start, end, part / 8), duration_ms=20) for part in range(1, 9)))

    def let_go(self) -> None:
        self._point(UP)

    def drag(self, start: Place, end: Place) -> None:
        self.hold(start, end)
        self.let_go()

    def _point(self, *actions: dict[str, Any]) -> None:
        mouse = {"type": "pointer", "id": "mouse", "parameters": {"pointerType": "mouse"}}
        self.engine.perform({**mouse, "actions": list(actions)})

    # ---- the keys ----

    def press(self, keys: str) -> None:
        """Press keys together, as "Control+z"."""
        values = [KEYS.get(name, name) for name in keys.split("+")]
        down = [{"type": "keyDown", "value": value} for value in values]
        self._keys(down + [{"type": "keyUp", "value": value} for value in reversed(values)])

    def type(self, text: str) -> None:
        values = text.replace("\n", KEYS["Enter"])
        self._keys([{"type": kind, "value": value} for value in values for kind in ("keyDown", "keyUp")])

    def fill(self, selector: str, text: str) -> None:
        """Type into a field instead of what it holds."""
        self.click(selector)
        self.press("Control+a")
        self.type(text)

    def tab_to(self, selector: str, presses: int, keys: str = "Tab") -> None:
        """Go to an element by Tab, in so many presses at most."""
        for _ in range(presses):
            self.press(keys)
            if self.has_focus(selector):
                return
        raise AssertionError(f"{selector} is not reached by {presses} presses of {keys}")

    def _keys(self, actions: list[dict[str, Any]]) -> None:
        self.engine.perform({"type": "key", "id": "keyboard", "actions": actions})

    # ---- what is done in several steps ----

    def connect(self) -> None:
        self.click("#connect")
        self.wait_for_text(".panel.device .pill", "ready")

    def push(self) -> None:
        self.click("#push")
        self.wait_for(".push-head .verified")

    def move_by(self, steps: int) -> None:
        self.click('#device-sections [data-value="move"]')
        self.fill("#move-steps", str(steps))
        self.click("#move")

    def device(self) -> dict[str, Any]:
        """Return the one device as the server tells it, not the page."""
        [device] = StepRampPage.ask(self.url, "GET", "devices")["devices"]
        return dict(device)


DOWN = {"type": "pointerDown", "button": 0}
UP = {"type": "pointerUp", "button": 0}


def move(place: Place, duration_ms: int = 0) -> dict[str, Any]:
    return {"type": "pointerMove", "x": place[0], "y": place[1], "duration": duration_ms}


def between(start: Place, end: Place, part: float) -> Place:
    return round(start[0] + part * (end[0] - start[0])), round(start[1] + part * (end[1] - start[1]))


def parameter(path: str) -> str:
    """Return where the number of a parameter is typed."""
    return f'.parameter[data-path="{path}"] input.number'


def slider(path: str) -> str:
    return f'.parameter[data-path="{path}"] .slider'
