"""The page as a person uses it: what the tests do with it and read off it, in one place."""

import contextlib
import json
import re
import urllib.error
import urllib.request
from typing import Any, Self

from playwright.sync_api import Locator, Page, expect

from waiting import until

SLEW_SPEED = "ramp.slew_speed_steps_per_s"
ACCELERATION = "ramp.acceleration_steps_per_s2"
REFUSED_VALUE = r"status of 422"
"""The browser itself reports every refused request as an error; tests of wrong values expect it."""
LOST = r"status of 502.*/devices/"
"""What the page asks by itself, a preview or a trace, may be on its way when the cable is pulled."""

# Where the page has its modules from: they are loaded once.
FOLDER = "document.querySelector('script[type=module]').src.replace('app/main.js', '')"
GUIDE_CLOSED = """if (location.protocol.startsWith('http') && localStorage.getItem('stepramp.guide') === null)
    localStorage.setItem('stepramp.guide', 'closed');"""
# What the page would write a moment later, it writes at once when it is left.
RECORD = "`stepramp.tab.${sessionStorage.getItem('stepramp.tab')}`"
KEPT = f"() => {{ dispatchEvent(new Event('pagehide')); return JSON.parse(localStorage.getItem({RECORD})); }}"


def drop_file(page: Page, name: str, text: str) -> None:
    """Drop a file on the page."""
    script = """([name, text]) => { const data = new DataTransfer(); data.items.add(new File([text], name));
        document.body.dispatchEvent(new DragEvent('drop', {dataTransfer: data, bubbles: true, cancelable: true})); }"""
    page.evaluate(script, [name, text])


def call(page: Page, module: str, function: str, *arguments: object) -> Any:
    """Call a function of one of the page's modules."""
    script = f"async ([module, name, values]) => (await import({FOLDER} + module))[name](...values)"
    return page.evaluate(script, [module, function, list(arguments)])


class StepRampPage:
    """The open page."""

    def __init__(self, page: Page, url: str) -> None:
        self.page, self.url = page, url

    def open(self) -> Self:
        """Open it as somebody who has closed the guide; that of a first visit has tests of its own."""
        self.page.add_init_script(GUIDE_CLOSED)
        return self.load()

    def load(self) -> Self:
        self.page.goto(self.url)
        self.wait_for_plots()
        return self

    def kept(self) -> dict[str, Any]:
        """Return what the tab keeps: its machine, and how that is looked at."""
        return self.page.evaluate(KEPT)

    def design(self) -> dict[str, Any]:
        """Return the design in hand as the browser keeps it."""
        machine = self.kept()["machine"]
        return machine["axes"][machine["active"]]

    def keep(self, **changes: object) -> None:
        """Let the tab find something else kept when it is loaded again."""
        write = f"localStorage.setItem({RECORD}, JSON.stringify(record))"
        script = f"(record) => addEventListener('pagehide', () => {{ {write}; }})"
        self.page.evaluate(script, {**self.kept(), **changes})

    def reload(self) -> None:
        self.page.reload()
        self.wait_for_plots()

    def wait_for_plots(self) -> None:
        self.page.locator(".figure .scatterlayer path.js-line").first.wait_for()

    def field(self, path: str) -> Locator:
        return self.page.locator(f'.parameter[data-path="{path}"] input.number')

    def slider(self, path: str) -> Locator:
        return self.page.locator(f'.parameter[data-path="{path}"] .slider')

    def message(self, path: str) -> Locator:
        return self.page.locator(f'.parameter[data-path="{path}"] .message')

    def curves(self) -> dict[str, list[float]]:
        """Return the y values of every visible trace, by method and plot: "first_order-error"."""
        # As one text: number by number it takes the browser 17 times as long, and it is asked for again and again.
        script = """() => JSON.stringify(Object.fromEntries(document.querySelector('.figure').data
            .filter((trace) => trace.visible).map((trace) => [trace.uid, Array.from(trace.y)])))"""
        return dict(json.loads(self.page.evaluate(script)))

    def x_axis(self) -> dict[str, Any]:
        script = "() => { const axis = document.querySelector('.figure').layout.xaxis; "
        return self.page.evaluate(script + "return {type: axis.type, range: axis.range, title: axis.title.text}; }")

    def edit_and_wait(self, path: str, text: str) -> None:
        """Type a value that is right and wait until the plots show it."""
        before = self.curves()
        self.field(path).fill(text)
        until(lambda: self.curves() != before)

    def figure_text(self, name: str) -> str:
        return self.page.locator(f'[data-figure="{name}"]').inner_text()

    def table_rows(self) -> list[list[str]]:
        rows = self.page.locator("#table-rows tr.row")
        return [[cell.input_value() for cell in row.locator("input").all()] for row in rows.all()]

    def paste_into_table(self, text: str, *, as_method: bool = False) -> None:
        """Paste as Ctrl+V does, with the focus in the grid, and use the rows where there is something to choose."""
        script = """(text) => { const data = new DataTransfer(); data.setData('text/plain', text);
            document.querySelector('#table-rows').dispatchEvent(
                new ClipboardEvent('paste', {clipboardData: data, bubbles: true, cancelable: true})); }"""
        self.page.evaluate(script, text)
        use = self.page.locator("#paste-dialog [type=submit]")
        if use.is_visible() and use.is_enabled():
            self.page.locator("#paste-as-method").set_checked(as_method)
            use.click()

    def show_panel(self, name: str) -> None:
        """Choose a tab where there are tabs."""
        tab = self.page.locator(f'.tabs [data-value="{name}"]')
        if tab.is_visible():
            tab.click()

    def start_over(self) -> None:
        """Go back to what a fresh page shows, without the second that loading it takes."""
        self.choose_example("Lead-screw stage")
        self.page.locator('#axis-choice [data-value="step"]').click()
        self.page.locator('#view-choice [data-value="whole"]').click()
        until(lambda: "671.8 ms" in self.figure_text("duration").replace("\u202f", " "))
        until(lambda: self.x_axis()["range"][0] < 1 and 500 < self.x_axis()["range"][1] < 505)

    def choose_example(self, title: str) -> None:
        self.page.locator("#examples").click()
        self.page.locator("#menu-list button b", has_text=re.compile(f"^{title}")).click()

    @property
    def state(self) -> Locator:
        return self.page.locator(".panel.device .pill")

    @property
    def position(self) -> Locator:
        return self.page.locator("#live-position")

    def connect(self) -> None:
        self.show_panel("device")
        self.page.locator("#port").select_option("sim://")
        self.page.locator("#connect").click()
        expect(self.state).to_have_text("ready")

    def device_section(self, name: str) -> None:
        """Show a section of the device panel: push, move, jog, trace."""
        self.page.locator(f'#device-sections [data-value="{name}"]').click()

    def push(self) -> None:
        self.device_section("push")
        self.page.locator("#push").click()
        expect(self.page.locator(".push-head .verified")).to_be_visible(timeout=20_000)
        expect(self.state).to_have_text("ready")

    def move(self, steps: str, kind: str = "by") -> None:
        self.device_section("move")
        self.page.locator(f'.panel.device .segmented [data-value="{kind}"]').click()
        self.page.locator("#move-steps").fill(steps)
        self.page.locator("#move").click()

    def devices(self) -> list[dict[str, Any]]:
        return self.ask(self.url, "GET", "devices")["devices"]

    @staticmethod
    def ask(url: str, method: str, path: str, body: object = None) -> Any:
        """Ask the server without the page, as another program would."""
        content = None if body is None else json.dumps(body).encode()
        headers = {} if body is None else {"Content-Type": "application/json"}
        request = urllib.request.Request(f"{url}api/v1/{path}", content, headers, method=method)
        with urllib.request.urlopen(request, timeout=60) as response:
            return json.load(response)

    @classmethod
    def release_devices(cls, url: str) -> None:
        """Stop and disconnect every device."""
        for device in cls.ask(url, "GET", "devices")["devices"]:
            with contextlib.suppress(urllib.error.HTTPError):  # It is lost: nothing moves that could be stopped.
                cls.ask(url, "POST", f"devices/{device['id']}/halt")
            until(lambda one=device["id"]: cls.ask(url, "GET", f"devices/{one}")["state"] in ("ready", "lost"))
            with contextlib.suppress(urllib.error.HTTPError):  # It is lost.
                cls.take_limits_away(url, device)
            cls.ask(url, "DELETE", f"devices/{device['id']}")

    @classmethod
    def take_limits_away(cls, url: str, device: dict[str, Any]) -> None:
        """Let all axes of a device go anywhere: the server remembers their limits for whoever connects it next."""
        free = [{"axis": axis["axis"]} for axis in device["axes"]]
        if free:
            cls.ask(url, "PUT", f"devices/{device['id']}/soft_limits", {"axes": free})
