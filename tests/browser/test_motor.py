"""The motor on the page: chosen, judged, mended by a proposal, removed; designs with one travel as files."""

import json
import math

from playwright.sync_api import Locator, Page, expect

from browser.conftest import Watch
from browser.stepramp_page import ACCELERATION, REFUSED_VALUE, SLEW_SPEED, StepRampPage, drop_file, until

NEMA_17 = "NEMA 17 · 17HS19-2004S1"


def unfold(stepramp: StepRampPage, section: str) -> None:
    """Have a section open, which may open by itself just then, and be closed by the click."""
    found = stepramp.page.locator(section)
    until(lambda: found.get_attribute("open") is not None or found.locator("summary").first.click())


def test_a_motor_says_whether_it_makes_the_move_and_a_proposal_mends_it(stepramp: StepRampPage, watch: Watch) -> None:
    page = stepramp.page
    verdict = page.locator("#motor-verdict")
    expect(verdict).to_be_hidden()
    assert "motor" not in stepramp.design()
    assert "torque" not in page.locator("#shape option").evaluate_all("(all) => all.map(({value}) => value)")
    page.locator("#motor-presets").select_option(NEMA_17)
    expect(verdict).to_contain_text("Safe")
    expect(page.locator(".torque-chart")).to_be_visible()
    stepramp.field("axis.microsteps").fill("16")
    stepramp.field("ramp.base_speed_steps_per_s").fill("40000")
    stepramp.field(SLEW_SPEED).fill("45000")
    stepramp.field("move.steps").fill("20000")
    expect(verdict).to_contain_text("Stalls: it starts too fast")
    proposal = page.locator("#motor-proposals button").first
    expect(proposal).to_contain_text("Lower the base speed to")
    proposal.click()
    expect(verdict).to_contain_text("Safe")
    assert stepramp.design()["ramp"]["base_speed_steps_per_s"] < 40000
    # What makes no motor is told at its field; the verdict is of the last one that did.
    watch.expected.append(REFUSED_VALUE)
    unfold(stepramp, "#motor-data")
    stepramp.field("motor.inductance_mh").fill("0")
    message = page.locator('[data-path="motor.inductance_mh"] .message')
    expect(message).to_contain_text("Inductance is 0; allowed: a number from 0.01")
    expect(page.locator(".motor-found")).to_have_class("motor-found stale")
    stepramp.field("motor.inductance_mh").fill("3")
    expect(page.locator(".motor-found")).to_have_class("motor-found")
    page.locator("#motor-presets").select_option("")
    expect(verdict).to_be_hidden()
    assert not {"motor", "drive", "load"} & stepramp.design().keys()


def test_a_ramp_is_shaped_by_the_torque_and_survives_a_reload_and_a_file(stepramp: StepRampPage) -> None:
    page = stepramp.page
    page.locator("#motor-presets").select_option(NEMA_17)
    stepramp.field("axis.microsteps").fill("16")
    for path, text in ((ACCELERATION, "10000000"), (SLEW_SPEED, "60000"), ("move.steps", "100000")):
        stepramp.field(path).fill(text)
    stepramp.field("timer.frequency_hz").fill("16000000")
    before = stepramp.curves()["exact-velocity"]
    page.locator("#shape").select_option("torque")
    until(lambda: stepramp.curves()["exact-velocity"] != before)
    expect(stepramp.field("ramp.shape.margin")).to_have_value("0.6")
    expect(page.locator("#motor-not-covered")).to_contain_text("Not covered: closed-loop drives, hot windings")
    expect(page.locator("#motor-details")).to_contain_text("up to 60 % of the torque")
    stepramp.field("drive.supply_v").fill("48")
    page.locator("#mechanism").select_option("screw")
    kept = stepramp.design()
    assert kept["load"] == {"mechanism": {"name": "screw", "lead_mm": 8, "mass_kg": 1}}
    stepramp.reload()
    assert stepramp.design() == kept
    drop_file(page, "motor.json", json.dumps({**kept, "name": "From a file"}))
    until(lambda: stepramp.design()["name"] == "From a file")
    opened = stepramp.design()
    assert all(opened[part] == kept[part] for part in ("motor", "drive", "load", "ramp", "schema"))
    # Without its motor the ramp has the usual shape.
    page.locator("#motor-presets").select_option("")
    until(lambda: "shape" not in stepramp.design()["ramp"])


def test_what_was_measured_of_a_motor_takes_the_place_of_what_is_guessed(stepramp: StepRampPage, watch: Watch) -> None:
    page = stepramp.page
    watch.expected.append(REFUSED_VALUE)
    page.locator("#motor-presets").select_option(NEMA_17)
    origins = page.locator("#motor-origins")
    expect(origins).to_contain_text("pull-out factor")
    # What is left open shows what stands for it; typed and emptied it is open again.
    supply, link = stepramp.field("drive.supply_v"), page.get_by_role("button", name="Supply is left open")
    assert [supply.get_attribute("placeholder"), supply.input_value()] == ["24", ""]
    supply.fill("36")
    expect(link).to_have_attribute("aria-pressed", "false")
    expect(origins.locator("dd").nth(1)).to_have_text("supply")
    supply.fill("")
    expect(link).to_have_attribute("aria-pressed", "true")
    assert stepramp.design()["drive"] == {}
    # A current is asked what it is: RMS and peak differ by 41 %.
    expect(page.locator("#current-is")).to_be_hidden()
    stepramp.field("drive.current_a").fill("1.5")
    expect(page.locator(".choice:has(#current-is) .message")).to_contain_text("'rms' or 'peak'")
    page.locator('#current-is [data-value="peak"]').click()
    expect(page.locator(".choice:has(#current-is) .message")).to_have_count(0)
    # Where it stalled is asked for, and not made up.
    unfold(stepramp, "#motor-measured")
    page.locator("#stall-point").click()
    expect(stepramp.field("motor.stalled.rpm")).to_be_focused()
    expect(stepramp.message("motor.stalled.torque_nm")).to_contain_text("Stall torque is empty")
    expect(stepramp.field("motor.pull_out_factor")).to_be_hidden()
    stepramp.field("motor.stalled.rpm").fill("1180")
    stepramp.field("motor.stalled.torque_nm").fill("0.12")
    expect(page.locator(".motor-found")).to_have_class("motor-found")
    expect(origins).to_contain_text("stall point")
    expect(page.locator("#motor-measured summary")).to_contain_text("stalled at 1,180 rpm")
    # It was measured with what drives the motor now, which another supply leaves as it is.
    then = {"supply_v": 24, "current_a": 1.5, "current_is": "peak"}
    expect(stepramp.field("motor.measured_with.supply_v")).to_have_value("24")
    supply.fill("48")
    assert stepramp.design()["motor"]["measured_with"] == then
    expect(page.locator('#current-then-is [data-value="peak"]')).to_have_attribute("aria-pressed", "true")
    page.locator("#stall-point").click()
    expect(stepramp.field("motor.pull_out_factor")).to_be_visible()
    assert "stalled" not in stepramp.design()["motor"]
    # A curve with a heading; a line that is none is named, and nothing of the text is taken.
    curve, said = page.locator("#torque-curve"), page.locator(".motor-curve .message")
    curve.fill("rpm, Nm\n100, 0.35\n600, about 0.3")
    expect(said).to_contain_text("Line 3 is “600, about 0.3”")
    assert stepramp.design()["motor"].get("torque_curve") is None
    curve.fill("rpm, Nm\n100, 0.24\n600, 0.21\n1500, 0.15")
    expect(said).to_have_count(0)
    assert stepramp.design()["motor"]["torque_curve"] == [[100, 0.24], [600, 0.21], [1500, 0.15]]
    curve.fill("100, 0.35")
    expect(said).to_contain_text("Torque curve")
    curve.blur()
    page.get_by_role("button", name="Undo").click()
    expect(curve).to_have_value("")


def test_what_does_not_fit_together_is_seen(stepramp: StepRampPage) -> None:
    page = stepramp.page
    page.locator("#motor-presets").select_option(NEMA_17)
    unfold(stepramp, "#motor-data")
    stepramp.field("motor.full_steps_per_rev").fill("200")
    page.locator("#motor-data summary").click()
    # A section with something to look at opens by itself.
    stepramp.field("axis.full_steps_per_rev").fill("400")
    expect(stepramp.message("motor.full_steps_per_rev")).to_contain_text("and the axis 400")
    stepramp.field("motor.full_steps_per_rev").fill("")
    expect(stepramp.message("motor.full_steps_per_rev")).to_have_count(0)
    unfold(stepramp, "#motor-measured")
    # .59 Nm at 2 A RMS.
    page.locator("#torque-curve").fill("100, 0.7\n600, 0.21")
    expect(page.locator(".motor-curve .message")).to_contain_text("hold the rotor with 0.59 Nm")


def test_where_and_why_it_stalls_is_seen_in_the_plots_and_in_what_the_rotor_does(stepramp: StepRampPage) -> None:
    page = stepramp.page
    page.locator("#motor-presets").select_option(NEMA_17)
    page.locator("#mechanism").select_option("screw")
    typed = {SLEW_SPEED: "60000", ACCELERATION: "10000000", "move.steps": "6000", "load.mechanism.mass_kg": "20"}
    for path, text in {"axis.microsteps": "16", "timer.frequency_hz": "16000000", **typed}.items():
        stepramp.field(path).fill(text)
    expect(page.locator("#motor-verdict")).to_contain_text("Stalls")
    marked = page.locator(".motor-marks")
    expect(marked).to_contain_text("starts at once up to")
    expect(marked.locator(".band")).to_have_count(2)
    answer = stepramp.ask(stepramp.url, "POST", "motor/simulate", {"design": stepramp.design(), "max_points": 10})
    lost = f"step {answer['first_lost_step']:,} is lost"
    expect(marked.locator(".lost-text")).to_have_text(lost)
    page.get_by_role("button", name="Acceleration", exact=True).click()
    expect(marked.locator(".sudden").first).to_be_attached()
    # In the units shown: 8 mm a turn of 3,200 steps.
    page.locator(".units [data-value=mm]").click()
    fastest = answer["greatest_start_speed_steps_per_s"] / 400
    # Rounded down, so that it does start.
    expect(marked).to_contain_text(f"starts at once up to {math.floor(10 * fastest) / 10:g} mm/s")
    page.locator("#open-rotor").click()
    dialog = page.locator("#rotor-dialog")
    expect(dialog.locator(".verdict")).to_contain_text("Stalls")
    expect(dialog.locator("h3").last).to_contain_text("mm/s")
    expect(dialog.locator(".small-chart .mark")).to_have_count(2)
    cells = dialog.locator(".rotor-runs tr").nth(1).locator("td")
    assert cells.all_inner_texts() == [f"{abs(run['lost_full_steps']):,}" for run in answer["runs"]]
    expect(dialog).to_contain_text("Not covered")
    ways = dialog.locator(".small-chart .line")
    over_time = ways.first.get_attribute("d")
    dialog.locator('[data-value="step"]').click()
    assert ways.first.get_attribute("d") != over_time
    # It follows the design: without its load no step is lost.
    page.evaluate("document.querySelector('#mechanism').value = ''")
    page.locator("#mechanism").dispatch_event("change")
    expect(dialog.locator(".verdict")).not_to_contain_text("Stalls")
    expect(dialog.locator(".small-chart .mark")).to_have_count(0)
    dialog.get_by_role("button", name="Close").last.click()
    expect(page.locator("#open-rotor")).to_be_focused()


def test_the_fastest_safe_ramp_is_used_and_taken_back_as_one(stepramp: StepRampPage, watch: Watch) -> None:
    watch.expected.append(REFUSED_VALUE)
    page = stepramp.page
    page.locator("#motor-presets").select_option(NEMA_17)
    typed = {SLEW_SPEED: "60000", ACCELERATION: "100000", "move.steps": "4000"}
    for path, text in {"axis.microsteps": "16", "timer.frequency_hz": "16000000", **typed}.items():
        stepramp.field(path).fill(text)
    before = stepramp.design()
    page.locator("#open-fastest").click()
    dialog = page.locator("#fastest-dialog")
    cards = dialog.locator(".fastest-card")
    expect(cards).to_have_count(4)
    found = stepramp.ask(stepramp.url, "POST", "motor/fastest", {"design": before, "margin": 0.6})
    expect(dialog.locator("#fastest-words")).to_have_text(found["words"])
    shown = dict(zip(("constant", "s_curve", "torque"), cards.all()[1:], strict=True))
    for one in found["candidates"]:
        expect(shown[one["shape"]]).to_contain_text(f"{one['duration_s'] * 1000:.4g} ms")
        assert shown[one["shape"]].locator(".fastest-badge").count() == one["is_fastest"]
    expect(dialog).to_contain_text("Not covered")
    assert (
        len(set(cards.locator(".small-chart .line").evaluate_all("(all) => all.map((one) => one.getAttribute('d'))")))
        == 4
    )
    # On a phone, too, each name and number have a line, beside each other.
    assert page.viewport_size
    usual = page.viewport_size
    page.set_viewport_size({"width": 390, "height": 844})
    lines = "(all) => all.map((one) => [one.clientHeight, one.scrollWidth - one.clientWidth])"
    heights = cards.locator("dl > *").evaluate_all(lines)
    assert len({height for height, _ in heights}) == 1
    assert {beyond for _, beyond in heights} == {0}
    page.set_viewport_size(usual)
    cards.nth(1).get_by_role("button").click()
    expect(cards.nth(1).get_by_role("button")).to_have_text("In use")
    [acceleration] = [one["value"] for one in found["candidates"][0]["changes"] if "acceleration" in one["field"]]
    assert stepramp.design()["ramp"]["acceleration_steps_per_s2"] == acceleration
    # More of the torque is quicker, and no margin at all is refused.
    margin = dialog.locator("#fastest-margin")
    margin.fill("7")
    expect(dialog.locator(".message")).to_contain_text("Part of the torque is 7; allowed: a number from 0.05 to 1")
    margin.fill("0.3")
    expect(cards.nth(1).get_by_role("button")).to_have_text("Use this")
    dialog.get_by_role("button", name="Close").last.click()
    page.get_by_role("button", name="Undo").click()
    assert stepramp.design() == before


def swipe(page: Page, x: float, y: float) -> None:
    """Draw a finger to the left and down."""
    session = page.context.new_cdp_session(page)

    def touch(kind: str, *places: dict[str, float]) -> None:
        session.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": list(places)})

    touch("touchStart", {"x": x, "y": y})
    for part in range(1, 6):
        touch("touchMove", {"x": x - 12 * part, "y": y + 6 * part})
    touch("touchEnd")


def moved_by_pointer_keys_and_finger(stepramp: StepRampPage, dialog: Locator) -> None:
    """Move the design on its map, in three changes."""
    page = stepramp.page
    point, said = dialog.locator(".map-point"), dialog.locator("#map-read")
    # Dragged to where it stalls, as one change, with the verdict there; the map is still that of the design.
    box, ring = dialog.locator(".stall-map:not(.swatch) .ground").bounding_box(), point.bounding_box()
    assert box
    assert ring
    page.mouse.move(ring["x"] + ring["width"] / 2, ring["y"] + ring["height"] / 2)
    page.mouse.down()
    page.mouse.move(box["x"] + box["width"] * 0.9, box["y"] + box["height"] * 0.5, steps=5)
    page.mouse.move(box["x"] + box["width"] * 0.95, box["y"] + box["height"] * 0.05, steps=5)
    page.mouse.up()
    expect(said).to_contain_text("Stalls at")
    dragged = stepramp.design()["ramp"]
    assert dragged["acceleration_steps_per_s2"] > 5e6
    assert dragged["slew_speed_steps_per_s"] > 1e5
    expect(dialog.locator(".stall-map.old")).to_have_count(0)
    # Keys go on from there, along one axis.
    point.press("Shift+ArrowDown")
    until(lambda: stepramp.design()["ramp"]["acceleration_steps_per_s2"] < dragged["acceleration_steps_per_s2"])
    assert stepramp.design()["ramp"]["slew_speed_steps_per_s"] == dragged["slew_speed_steps_per_s"]
    # A finger takes the point up, too; elsewhere it moves nothing.
    stepped = stepramp.design()
    swipe(page, box["x"] + 0.3 * box["width"], box["y"] + 0.5 * box["height"])
    assert stepramp.design() == stepped
    ring = point.bounding_box()
    assert ring
    swipe(page, ring["x"] + ring["width"] / 2, ring["y"] + ring["height"] / 2)
    until(lambda: stepramp.design()["ramp"]["slew_speed_steps_per_s"] < stepped["ramp"]["slew_speed_steps_per_s"])


def report_has_the_map(page: Page) -> None:
    page.get_by_role("button", name="Export").click()
    with page.expect_request("**/api/v1/report?format=html") as asked:
        page.locator('input[value="report_html"]').check()
    [shown] = asked.value.post_data_json["maps"]
    assert (shown["over"], len(shown["verdicts"])) == ("slew_speed", len(shown["over_values"]))
    page.locator("#export-dialog").get_by_role("button", name="Close").last.click()


def the_kept_map_is_shown(page: Page) -> None:
    """It comes from the library, whatever the page has."""
    page.locator("#examples").click()
    page.get_by_role("button", name="Library …").click()
    page.locator(".library-design").first.click()
    page.get_by_role("button", name="Show the stall map of revision 1").click()
    dialog = page.locator("#map-dialog")
    expect(dialog.locator("#map-summary")).to_contain_text("safe")
    dialog.get_by_role("button", name="Close").last.click()
    page.keyboard.press("Escape")


def test_the_stall_map_is_kept_with_its_axis_and_the_design_is_a_point_on_it(stepramp: StepRampPage) -> None:
    page = stepramp.page
    page.locator("#motor-presets").select_option(NEMA_17)
    page.locator("#mechanism").select_option("screw")
    typed = {SLEW_SPEED: "40000", ACCELERATION: "1000000", "move.steps": "1500", "load.mechanism.mass_kg": "3"}
    for path, text in {"axis.microsteps": "16", "timer.frequency_hz": "16000000", **typed}.items():
        stepramp.field(path).fill(text)
    page.locator("#open-map").click()
    dialog = page.locator("#map-dialog")
    compute, cancel = dialog.locator("#compute-map"), dialog.get_by_role("button", name="Cancel")
    # Cancelled it says so; asked again it is computed to its end.
    cancel.click()
    expect(dialog.locator(".message", has_text="Cancelled")).to_be_visible()
    compute.click()
    expect(compute).to_be_hidden()
    expect(compute).to_be_visible()
    expect(compute).to_have_text("Refresh")
    expect(dialog.locator("#map-summary")).to_contain_text("safe")
    for verdict in ("safe", "marginal", "stalls"):
        assert dialog.locator(f".stall-map:not(.swatch) .fill.{verdict}").count() > 0
    point, said = dialog.locator(".map-point"), dialog.locator("#map-read")
    expect(said).to_contain_text("Safe at 1,000,000 steps/s² and 40,000 steps/s")
    expect(point).to_have_attribute("aria-valuetext", "1,000,000 steps/s² and 40,000 steps/s: safe")
    before = stepramp.design()
    moved_by_pointer_keys_and_finger(stepramp, dialog)
    for _ in range(3):
        page.get_by_role("button", name="Undo").click()
    assert stepramp.design() == before
    dialog.locator("#map-keep").click()
    expect(page.locator("#notice")).to_contain_text("Stall map kept in the library with")
    dialog.get_by_role("button", name="Close").last.click()
    the_kept_map_is_shown(page)
    report_has_the_map(page)
    # Another mass: the map is of an earlier design. Over a reload it is still there.
    stepramp.field("load.mechanism.mass_kg").fill("2")
    stepramp.reload()
    page.locator("#open-map").click()
    expect(dialog.locator(".stall-map.old")).to_have_count(1)
    expect(dialog.locator(".map-acts")).to_contain_text("Of an earlier design")
    page.locator("#map-dialog").get_by_role("button", name="Close").last.click()
    stepramp.field("load.mechanism.mass_kg").fill("3")
    page.locator("#open-map").click()
    expect(dialog.locator(".stall-map.old")).to_have_count(0)
    # Undone and done again it goes with the design.
    page.get_by_role("button", name="Undo").click()
    expect(dialog.locator(".stall-map.old")).to_have_count(1)
    page.get_by_role("button", name="Redo").click()
    expect(dialog.locator(".stall-map.old")).to_have_count(0)
