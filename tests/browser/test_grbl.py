"""The page with a grbl behind a pseudo-terminal: the whole path, from what it can't do to what it had before."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import pytest
from playwright.sync_api import expect

from browser.conftest import Watch, finding
from browser.stepramp_page import LOST, SLEW_SPEED, StepRampPage, until
from controllers.grbl.emulator import Eeprom, GrblEmulator, GrblOnACable


@pytest.fixture
def cable(watch: Watch) -> Iterator[GrblOnACable]:
    watch.expected.append(LOST)
    with GrblOnACable() as made:
        yield made


@pytest.fixture
def attached(open_page: Callable[..., StepRampPage], cable: GrblOnACable) -> StepRampPage:
    """Return a page that finds the grbl's port, and the virtual one."""
    stepramp = open_page(prepare=finding(cable.port, "A grbl"))
    stepramp.show_panel("device")
    return stepramp


def test_a_listing_that_is_pasted_becomes_designs(stepramp: StepRampPage) -> None:
    listing = "$$\n$100=80.000\n$101=400.000\n$110=3000.000\n$111=600.000\n$120=200.000\n$121=50.000\nok"
    script = """(text) => { const data = new DataTransfer(); data.setData('text/plain', text);
        const paste = new ClipboardEvent('paste', {clipboardData: data, bubbles: true, cancelable: true});
        document.body.dispatchEvent(paste); }"""
    stepramp.page.evaluate(script, listing)
    until(lambda: stepramp.design()["name"] == "grbl axis X")
    # 3000 mm/min at 80 steps/mm; 200 mm/s².
    ramp = stepramp.design()["ramp"]
    assert (ramp["slew_speed_steps_per_s"], ramp["acceleration_steps_per_s2"]) == (4000, 16_000)
    assert len(stepramp.kept()["machine"]["axes"]) == 2


def test_its_family_is_found_by_what_it_says_as_it_starts(
    attached: StepRampPage, cable: GrblOnACable, monkeypatch: pytest.MonkeyPatch
) -> None:
    page = attached.page
    page.locator("#port").select_option(cable.port)
    expect(page.locator("#family")).to_have_value("stepramp")
    page.locator("#find-family").click()
    expect(page.locator("#family")).to_have_value("grbl")
    expect(page.locator("#announcements")).to_contain_text("It says “Grbl 1.1h ['$' for help]”: grbl.")
    # A board that goes on when its port is opened says nothing: what was chosen stays.
    monkeypatch.setattr(cable.grbl, "opened", lambda: None)
    page.locator("#find-family").click()
    expect(page.locator("#connect")).to_have_text("Listening…")
    expect(page.locator("#announcements")).to_contain_text("It says nothing of itself as it starts: choose its family.")
    expect(page.locator("#family")).to_have_value("grbl")
    # It is remembered for the port, and nothing was connected by it.
    attached.reload()
    attached.show_panel("device")
    page.locator("#port").select_option(cable.port)
    expect(page.locator("#family")).to_have_value("grbl")
    expect(attached.state).to_have_text("not connected")


def see_backups(stepramp: StepRampPage, grbl: GrblEmulator) -> None:
    """What was saved is there though nothing is connected, and is restored once that is again."""
    page = stepramp.page
    stepramp.push()
    page.locator("#connect").click()
    expect(stepramp.state).to_have_text("not connected")
    page.locator("#examples").click()
    page.get_by_role("button", name="Backups of controllers").click()
    expect(page.locator("#backup-text")).to_contain_text("$120=10.000")
    expect(page.locator("#backup-why")).to_have_text("To restore it, connect the controller first.")
    expect(page.locator("#backup-restore")).to_be_disabled()
    page.locator("#connect").click()
    expect(stepramp.state).to_have_text("ready")
    grbl.settings[120] = grbl.eeprom.settings[120] = 77.0
    page.locator("#backup-restore").click()
    until(lambda: grbl.eeprom.settings == Eeprom().settings)
    expect(page.locator("#backups-dialog")).to_be_hidden()


def test_the_whole_path_with_a_grbl(attached: StepRampPage, cable: GrblOnACable) -> None:
    page, grbl = attached.page, cable.grbl
    # Before anything is connected: what it can't do, and what it would play.
    page.locator("#port").select_option(cable.port)
    page.locator("#family").select_option("grbl")
    page.locator("#cannot summary").click()
    expect(page.locator("#cannot")).to_contain_text("Base speed: grbl starts from 0.")
    expect(page.locator("#own-chip")).to_contain_text("As grbl plays it")
    until(lambda: {"own-velocity", "own-delay", "own-error"} <= set(attached.curves()))
    page.locator("#own-chip").click()
    until(lambda: "own-velocity" not in attached.curves())
    page.locator("#own-chip").click()
    # Connect.
    page.locator("#connect").click()
    expect(attached.state).to_have_text("ready")
    assert grbl.eeprom.writes == 0
    # Its scale is offered to the design: 250 steps/mm.
    expect(page.locator("#machine-scale")).to_contain_text("The controller is set to 250 steps/mm")
    page.locator("#use-scale").click()
    expect(page.locator("#machine-scale")).to_be_hidden()
    axis = attached.design()["axis"]
    assert axis["full_steps_per_rev"] * axis["microsteps"] / axis["travel_per_rev"] == pytest.approx(250)
    expect(page.get_by_label("Device settings: soft limits", exact=True)).to_be_enabled()
    # The difference, in both terms.
    attached.edit_and_wait(SLEW_SPEED, "900")
    preview = page.locator("#push-preview")
    expect(preview).to_contain_text("A push would change")
    expect(preview).to_contain_text("$110, mm/min")
    expect(preview).to_contain_text("216")
    expect(preview).to_contain_text("grbl works its intervals out itself")
    # Push, and what was read back.
    attached.push()
    expect(page.locator("#push-report")).to_contain_text("Read back as sent")
    expect(page.locator("#push-report tbody tr").first).to_contain_text("$110")
    expect(preview).to_contain_text("The device has this ramp")
    assert grbl.eeprom.settings[110] == 216.0
    # Move, and stop for good.
    attached.move("300")
    until(lambda: grbl.position[0] == 300)
    expect(attached.state).to_have_text("ready")
    attached.move("20000")
    until(lambda: grbl.position[0] > 500)
    page.locator("#stop").click()
    expect(attached.state).to_have_text("ready")
    steps = grbl.steps
    assert (grbl.is_moving, steps < 20_000) == (False, True)
    # Restore what it had.
    attached.device_section("push")
    expect(page.locator("#backup option")).to_have_count(1)
    page.locator("#restore-backup").click()
    until(lambda: grbl.eeprom.settings == Eeprom().settings)
    expect(preview).to_contain_text("A push would change")
    # And start from that: then a push changes nothing.
    page.locator("#start-from").click()
    expect(preview).to_contain_text("The device has this ramp")
    assert attached.design()["ramp"]["slew_speed_steps_per_s"] == pytest.approx(500 / 60 * 250)
    assert grbl.steps == steps
    see_backups(attached, grbl)


def test_what_a_push_has_stored_is_proven_by_a_restart(
    attached: StepRampPage, cable: GrblOnACable, watch: Watch
) -> None:
    page, grbl = attached.page, cable.grbl
    # What a push would change may be asked as it goes, before that is heard.
    watch.expected.append(r"status of 409.*/push/preview")
    page.locator("#port").select_option(cable.port)
    page.locator("#family").select_option("grbl")
    page.locator("#connect").click()
    expect(attached.state).to_have_text("ready")
    attached.edit_and_wait(SLEW_SPEED, "900")
    attached.push()
    report, ask, dialog = page.locator("#push-report"), page.locator("#prove"), page.locator("#prove-dialog")
    expect(report).to_contain_text("Read back as sent")
    expect(page.locator("#proof")).to_contain_text("$110, $120 are in use. What the controller has stored is proven at")
    # On a busy machine it may have been opened twice until it was heard.
    starts = grbl.starts
    ask.click()
    expect(dialog).to_contain_text("This restarts the controller: it forgets where it is.")
    dialog.get_by_role("button", name="Cancel").click()
    assert grbl.starts == starts
    ask.click()
    # It stays away until it was seen so.
    begun, heard = grbl.opened, grbl.exchange
    silent = lambda _: b""  # noqa: E731
    grbl.opened = lambda: setattr(grbl, "exchange", silent)  # type: ignore[method-assign]
    page.locator("#prove-restart").click()
    expect(attached.state).to_have_text("restarting")
    expect(report).to_contain_text("Restarts to prove it is stored")
    expect(report.locator("tbody tr").first).to_contain_text("$110")
    expect(page.locator("#device-axis")).to_be_visible()
    expect(page.locator("#backup")).to_be_visible()
    expect(page.locator("#stop")).to_be_enabled()
    until(lambda: grbl.exchange is silent)
    grbl.opened, grbl.exchange = begun, heard  # type: ignore[method-assign]
    grbl.opened()
    expect(report).to_contain_text("Stored: after a start the controller had $110, $120 as written.")
    expect(page.locator("#notice")).to_contain_text("Stored: after a start the controller had $110, $120")
    expect(ask).to_be_hidden()
    expect(attached.state).to_have_text("ready")
    assert grbl.starts == starts + 1
    # What it doesn't keep is told, and a restore offered.
    grbl.eeprom.is_broken = True
    attached.edit_and_wait(SLEW_SPEED, "800")
    attached.push()
    expect(page.locator("#push-failed")).to_be_hidden()
    ask.click()
    page.locator("#prove-restart").click()
    expect(page.locator(".device-body > .problem")).to_contain_text(
        "Since its start the controller has $110=216.000 where 192.000 was written"
    )
    expect(page.locator("#push-failed")).to_be_visible()
    expect(report).to_contain_text("Not as written since its start")
    expect(report.locator(".others-found tbody")).to_have_text("$110192.000216.000")
    grbl.eeprom.is_broken = False
    attached.edit_and_wait(SLEW_SPEED, "900")
    attached.push()
    expect(page.locator("#push-failed")).to_be_hidden()
    expect(page.locator(".device-body > .problem")).to_have_text("")


def connect_in_mm(stepramp: StepRampPage, cable: GrblOnACable) -> None:
    """Have a design of 50 steps/mm in hand, shown in mm, beside a grbl."""
    page = stepramp.page
    stepramp.choose_example("Lead-screw stage")
    page.locator('[aria-label="Unit of length"] [data-value="mm"]').click()
    page.locator("#port").select_option(cable.port)
    page.locator("#family").select_option("grbl")
    page.locator("#connect").click()
    expect(stepramp.state).to_have_text("ready")


def test_lengths_are_those_of_the_machine_where_its_scale_is_another(
    attached: StepRampPage, cable: GrblOnACable
) -> None:
    page, grbl = attached.page, cable.grbl
    grbl.settings[102] = grbl.eeprom.settings[102] = 400.0
    connect_in_mm(attached, cable)
    attached.push()
    attached.move("5")
    expect(page.locator("#move-in-steps")).to_have_text("1,250 steps")
    expect(page.locator("#move-scale")).to_have_text("Lengths here are the machine’s: 250 steps/mm; the design has 50.")
    until(lambda: grbl.position[0] == 1250)
    expect(attached.position).to_have_text("5.00000")
    expect(attached.state).to_have_text("ready")
    # Each axis of a line by its own.
    page.locator('.panel.device .segmented [data-value="line"]').click()
    for axis in range(3):
        page.locator(f"#line-{axis}").fill("1")
    steps = ("250 steps", "250 steps", "400 steps")
    for axis, text in enumerate(steps):
        expect(page.locator(f"#line-{axis}-in-steps")).to_have_text(text)
    page.locator("#move").click()
    until(lambda: grbl.position == [1500, 250, 400])


def test_the_report_of_a_push_keeps_the_scale_it_was_made_with(attached: StepRampPage, cable: GrblOnACable) -> None:
    page = attached.page
    connect_in_mm(attached, cable)
    page.locator('#time-unit [data-value="min"]').click()
    page.locator("#use-scale").click()
    expect(page.locator("#machine-scale")).to_be_hidden()
    attached.push()
    row = page.locator("#push-report tbody tr").first
    told = row.inner_text()
    page.locator("#restore-backup").click()
    until(lambda: cable.grbl.eeprom.settings == Eeprom().settings)
    expect(attached.state).to_have_text("ready")
    attached.edit_and_wait("axis.travel_per_rev", "8")
    expect(page.locator("#machine-scale")).to_contain_text("the design has")
    assert row.inner_text() == told
