"""What a page does by itself in each browser: drawn curves, drags, sockets, dialogs, the clipboard and the keys."""

import pytest

from browser.server import Server
from browser.stepramp_page import ACCELERATION, SLEW_SPEED, until
from browser.test_main_path import GAUGE_ROWS, GAUGE_TABLE
from engines.page import EnginePage, parameter, slider

FAR = 1_000_000
PEAK = '[data-figure="peak"]'
POINT = '.points .point[data-row="3"]'
DIALOGS = {"paste-table": "paste-dialog", "fit-table": "fit-dialog", "head-export": "export-dialog"}
"""Dialogs by the button that opens them."""
GONE = ["connection", "NetworkError"]


def test_from_opening_the_page_to_a_motor_that_was_stopped(page: EnginePage) -> None:
    assert page.value(".design-name") == "Lead-screw stage"
    before = page.curves()
    page.fill(parameter(SLEW_SPEED), "1,500")
    in_whole_ticks_of_2_mhz = 2_000_000 / 1333
    until(lambda: max(page.curves()["exact-velocity"]) == in_whole_ticks_of_2_mhz)
    after = page.curves()
    for curve in ("exact-velocity", "exact-delay", "first_order-error", "table-error"):
        assert after[curve] != before[curve]

    page.connect()
    page.push()
    page.move_by(FAR)
    until(lambda: page.device()["position_steps"] > 0)
    assert page.device()["state"] == "moving"
    page.wait_for_text(".panel.device .pill", "moving")
    page.click("#stop", held_ms=400)
    until(lambda: page.device()["state"] == "ready")
    reached = page.device()["position_steps"]
    assert 0 < reached < FAR
    page.wait_for_text("#live-position", f"{reached:,}")


def test_a_point_of_the_table_is_dragged_over_the_plot(page: EnginePage) -> None:
    before = page.table_rows()
    x, y = page.place(POINT)
    page.hold((x, y), (x, y - 60))
    # It comes in several moves, and a busy browser shows those on the way, too.
    until(lambda: page.place(POINT) == pytest.approx((x, y - 60), abs=1))
    assert page.table_rows() != before
    page.let_go()
    after = page.table_rows()
    assert after[:3] + after[4:] == before[:3] + before[4:]
    delay_us = float(after[3][1].replace(",", ""))
    assert delay_us > float(before[3][1].replace(",", ""))
    # Shown in whole ticks of 2 MHz.
    until(lambda: any(abs(shown - delay_us) <= 0.25 for shown in page.curves()["table-delay"]))
    page.press("Control+z")
    until(lambda: page.table_rows() == before)


def test_a_slider_is_dragged_and_a_part_of_the_plots_chosen(page: EnginePage) -> None:
    page.drag(page.place(slider(ACCELERATION)), page.place(slider(ACCELERATION), right=0.75))
    number = float(page.value(parameter(ACCELERATION)).replace(",", ""))
    assert 90_000 < number < 120_000, "three quarters of the way from 100 to 1,000,000 on a logarithmic slider"
    page.wait_for_text(PEAK, "1,000")

    whole = page.x_range()
    page.drag(page.place(".scope", right=0.25, down=0.15), page.place(".scope", right=0.5, down=0.15))
    until(lambda: page.x_range() != whole)
    begin, end = page.x_range()
    assert (end - begin) / (whole[1] - whole[0]) == pytest.approx(0.25, abs=0.04)

    def shown_whole() -> bool:
        """Two presses are none of one where a busy browser hears the second half a second late: press again."""
        page.click(".scope", down=0.15, times=2)
        return page.x_range() == whole

    until(shown_whole)


def test_curves_come_over_the_socket_while_a_slider_moves(page: EnginePage) -> None:
    slow, middle, fast = (page.place(slider(SLEW_SPEED), right=part) for part in (0.3, 0.5, 0.6))
    page.hold(slow, middle)  # The first question opens the socket.
    page.wait_for_text(PEAK, page.value(parameter(SLEW_SPEED)))
    requests, before = page.requests("/curves"), page.curves()
    page.move_on(middle, fast)
    until(lambda: page.curves() != before)
    page.wait_for_text(PEAK, page.value(parameter(SLEW_SPEED)))
    assert page.requests("/curves") == requests
    page.let_go()


def test_the_server_goes_and_comes_back(page: EnginePage, server: Server, expected_errors: list[str]) -> None:
    expected_errors.extend(GONE)
    page.wait_for_text("#server-state", "server connected")
    server.stop()
    page.wait_for_text("#server-state", "Server gone")
    page.fill(parameter(SLEW_SPEED), "700")
    page.click("#stop")
    page.wait_for_text("#stop-failure", "Not delivered")
    server.start()
    page.wait_for_text("#server-state", "server connected")
    page.wait_for_text(PEAK, "of 700 asked for")
    page.connect()


def test_a_dialog_takes_the_focus_and_escape_gives_it_back_and_stops(page: EnginePage) -> None:
    page.connect()
    page.push()
    page.move_by(FAR)
    for button, dialog in DIALOGS.items():
        page.click(f"#{button}")
        page.wait_for(f"#{dialog}")
        assert page.has_focus(f"#{dialog}")
        page.press("Escape")
        until(lambda closed=dialog: not page.is_shown(f"#{closed}"))
        assert page.has_focus(f"#{button}")
    until(lambda: page.device()["state"] == "ready")
    assert 0 < page.device()["position_steps"] < FAR


def test_a_table_is_pasted_and_a_link_goes_over_the_clipboard(page: EnginePage) -> None:
    page.click("#paste-table")
    page.type(GAUGE_TABLE)
    page.wait_for_text("#paste-dialog button[type=submit]", "Use 5 rows")
    page.click("#paste-dialog button[type=submit]")
    assert page.table_rows() == GAUGE_ROWS
    page.click("#head-link")
    page.wait_for_text("#notice", "Link copied")
    page.click("#paste-table")
    page.press("Control+v")
    link = page.value("#paste-text")
    assert link.startswith(f"{page.url}#d=")
    page.press("Tab")
    assert page.has_focus("#paste-dialog button")
    page.press("Escape")
    page.open()
    assert page.table_rows() != GAUGE_ROWS
    page.follow(link)
    until(lambda: page.table_rows() == GAUGE_ROWS)


def test_the_device_is_reached_and_a_motor_moved_by_the_keys_alone(page: EnginePage) -> None:
    page.tab_to('.skip[href="#device"]', 4)
    page.press("Enter")
    page.tab_to("#connect", 6)
    page.press("Enter")
    page.wait_for_text(".panel.device .pill", "ready")
    page.tab_to("#push", 9)
    page.press("Enter")
    page.wait_for(".push-head .verified")
    page.tab_to('#device-sections [data-value="move"]', 6, "Shift+Tab")
    page.press("Space")
    page.tab_to("#move-steps", 6)
    page.press("Control+a")
    page.type(str(FAR))
    page.press("Enter")
    until(lambda: page.device()["state"] == "moving")
    page.press("Escape")
    until(lambda: page.device()["state"] == "ready")
    assert 0 < page.device()["position_steps"] < FAR
