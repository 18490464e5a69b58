"""The rows of the lead-screw stage's table, and their points in the plot."""

import math

from playwright.sync_api import Locator

from browser.stepramp_page import StepRampPage, until

ROWS = [[3, 8284], [7, 4783], [15, 3131], [31, 2139], [63, 1488], [101, 1115]]
"""Of the lead-screw stage: last ramp index, delay in µs. The row to index 15 ends with step 14."""


# Where Plotly itself puts values, and which values it finds at a pixel of the page.
PLOTLY_PIXELS = """([x, y]) => { const gd = document.querySelector('.figure'), full = gd._fullLayout,
    box = gd.getBoundingClientRect();
    return [box.x + full.xaxis._offset + full.xaxis.d2p(x), box.y + full.yaxis2._offset + full.yaxis2.d2p(y)]; }"""


PLOTLY_VALUES = """([x, y]) => { const gd = document.querySelector('.figure'), full = gd._fullLayout,
    box = gd.getBoundingClientRect();
    return [full.xaxis.p2d(x - box.x - full.xaxis._offset), full.yaxis2.p2d(y - box.y - full.yaxis2._offset)]; }"""


def view(stepramp: StepRampPage, name: str) -> None:
    stepramp.page.locator(f'#view-choice [data-value="{name}"]').click()
    until(lambda: (stepramp.x_axis()["type"] == "log") == (name == "start"))


def handle(stepramp: StepRampPage, row: int) -> Locator:
    """Return the point of a row, counted from 0."""
    return stepramp.page.locator(f'.point[data-row="{row}"]')


def centre(stepramp: StepRampPage, row: int) -> tuple[float, float]:
    box = handle(stepramp, row).locator(".dot").bounding_box()
    assert box
    return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2


def plotted(stepramp: StepRampPage, x: float, delay_us: float) -> tuple[float, float]:
    return tuple(stepramp.page.evaluate(PLOTLY_PIXELS, [x, delay_us]))


def values_at(stepramp: StepRampPage, pixel: tuple[float, float]) -> tuple[float, float]:
    return tuple(stepramp.page.evaluate(PLOTLY_VALUES, list(pixel)))


def rows_of(stepramp: StepRampPage) -> list[list[int]]:
    return [[int(cell.replace(",", "")) for cell in row] for row in stepramp.table_rows()]


def press(stepramp: StepRampPage, row: int) -> tuple[float, float]:
    x, y = centre(stepramp, row)
    stepramp.page.mouse.move(x + 1, y - 1)
    stepramp.page.mouse.down()
    return x, y


def drag(stepramp: StepRampPage, row: int, by: tuple[float, float]) -> tuple[float, float]:
    """Drag a row's point and let go; return where its centre should be."""
    x, y = press(stepramp, row)
    stepramp.page.mouse.move(x + 1 + by[0], y - 1 + by[1], steps=6)
    stepramp.page.mouse.up()
    return x + by[0], y + by[1]


def assert_on_data(stepramp: StepRampPage, row: int, x: float, delay_us: float) -> None:
    """A point is where Plotly puts the corner of the staircase, to half a pixel."""
    until(lambda: math.dist(centre(stepramp, row), plotted(stepramp, x, delay_us)) < 0.5)
