"""A Tic's settings, saved as a file that its maker's programs take, and what of that can be written again."""

from __future__ import annotations

import struct

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from controllers.bench import by
from controllers.tic.bench import Bench
from controllers.tic.damage import flipping
from controllers.tic.emulator import READ, TicEmulator
from designs import design
from stepramp.controllers.tic.backup import Backup, backup_text
from stepramp.controllers.tic.controller import TicController
from stepramp.controllers.tic.products import PRODUCTS
from stepramp.controllers.tic.ramp import TicRamp
from stepramp.controllers.tic.read_settings import read_settings
from stepramp.controllers.tic.settings import END, FIRST, Settings
from stepramp.devices.backups import marked
from stepramp.errors import Refused

AS_NEW = """product: T825
control_mode: serial
never_sleep: false
disable_safe_start: false
ignore_err_line_high: false
auto_clear_driver_error: true
soft_error_response: decel_to_hold
soft_error_position: 0
serial_baud_rate: 9600
serial_device_number: 14
serial_alt_device_number: 0
serial_enable_alt_device_number: false
serial_14bit_device_number: false
command_timeout: 1000
serial_crc_for_commands: false
serial_crc_for_responses: false
serial_7bit_responses: false
serial_response_delay: 0
vin_calibration: 0
input_averaging_enabled: true
input_hysteresis: 0
input_scaling_degree: linear
input_invert: false
input_min: 0
input_neutral_min: 2015
input_neutral_max: 2080
input_max: 4095
output_min: -200
output_max: 200
encoder_prescaler: 1
encoder_postscaler: 1
encoder_unlimited: false
scl_config: default
sda_config: default
tx_config: default
rx_config: default
rc_config: default
invert_motor_direction: false
max_speed: 2000000
starting_speed: 0
max_accel: 40000
max_decel: 0
step_mode: 1
current_limit: 192
current_limit_during_error: -1
decay_mode: mixed
auto_homing: false
auto_homing_forward: false
homing_speed_towards: 1000000
homing_speed_away: 1000000
"""
"""What ticcmd writes of a new T825, but for the speed that the emulator leaves a switch at."""
CHANGED = {
    0x01: 6, 0x02: 0b111, 0x04: 1, 0x05: 103, 0x06: 0, 0x07: 0x05, 0x14: 0xA7, 0x15: 0xFE, 0x1B: 1, 0x20: 2,
    0x31: 3, 0x36: 0b10010, 0x3B: 0xC2, 0x3C: 0x08, 0x3F: 0x85, 0x40: 66, 0x41: 6, 0x42: 2, 0x5C: 1, 0x5E: 100,
    0x69: 0x01, 0x6A: 0x83, 0x6B: 0x02, 0x6C: 1, 0x6D: 6, 0x6E: 3, 0x6F: 1,
}  # fmt: skip
AS_CHANGED = {
    "control_mode": "encoder_position",
    "never_sleep": "true",
    "auto_homing": "true",
    "auto_homing_forward": "true",
    "ignore_err_line_high": "true",
    "serial_baud_rate": "115385",
    "serial_device_number": "133",
    "serial_alt_device_number": "259",
    "serial_enable_alt_device_number": "true",
    "serial_response_delay": "100",
    "vin_calibration": "-345",
    "input_scaling_degree": "cubic",
    "encoder_unlimited": "true",
    "scl_config": "user_input pullup analog",
    "sda_config": "limit_switch_forward active_high",
    "rc_config": "rc pullup active_high",
    "invert_motor_direction": "true",
    "step_mode": "2_100p",
}
OF_PRODUCTS = {
    "T825": ("2048", "96", {"decay_mode": "fast"}),
    "T834": ("2048", "96", {"decay_mode": "fast"}),
    "T500": ("3093", "343", {}),
    "N825": ("2048", "96", {"decay_mode": "fast"}),
    "T249": (
        "2640",
        "120",
        {
            "agc_mode": "on",
            "agc_bottom_current_limit": "75",
            "agc_current_boost_steps": "11",
            "agc_frequency_limit": "225",
        },
    ),
    "36v4": ("4727", "215", {"hp_enable_unrestricted_current_limits": "true"}),
}
VOLATILE = "The Tic forgets these figures when it is reset or switched off."
WRITTEN_BY = "ticcmd --settings FILE or the Tic Control Center writes them."


def of_product(text: str, product: str) -> dict[str, str]:
    """Return what a YAML parser of ticcmd's kind reads, all as strings, once a product is told."""
    read = yaml.load(text.replace(f"#{product} ", ""), Loader=yaml.BaseLoader)
    assert isinstance(read, dict)
    return read


def saved(bench: Bench) -> str:
    bench.controller.connect()
    return bench.controller.backup()


def test_a_new_tic_is_saved_as_ticcmd_saves_it(bench: Bench) -> None:
    text = marked(saved(bench))
    assert of_product(text, "T825") == yaml.load(AS_NEW, Loader=yaml.BaseLoader)
    # As it is it has no product, which ticcmd names as the reason; nothing else is lacking.
    assert "product" not in yaml.load(text, Loader=yaml.BaseLoader)
    assert {command[0] for command in bench.tic.commands} <= READ


@pytest.mark.parametrize("product", PRODUCTS)
def test_every_setting_has_its_maker_s_words(bench: Bench, product: str) -> None:
    text = saved(bench)
    bench.tic.other_settings = CHANGED
    new, changed = of_product(text, product), of_product(bench.controller.backup(), product)
    limit, during_error, others = OF_PRODUCTS[product]
    own = {"current_limit": limit, "current_limit_during_error": during_error, **others}
    assert {name: value for name, value in changed.items() if new.get(name) != value} == AS_CHANGED | own


def test_nothing_that_is_told_is_lost(bench: Bench) -> None:
    """Also what no settings file has, and what there are no words for."""
    bench.tic.other_settings = {address: (address * 37 + 11) % 256 for address in range(0x0C, 0x70)} | {0x41: 0}
    bench.tic.other_settings |= dict(enumerate(struct.pack("<4I", 5, 2_000_000, 0, 40_000), 0x43))
    text = saved(bench)
    kept = Backup.of(text).kept.bytes
    assert kept == dict(enumerate(memory(bench.tic), FIRST))
    # 0x20 is 171, 0x53 is 10.
    assert "# input_scaling_degree is 171, without a word for it\n" in text
    assert "# soft_error_response is 10, without a word for it\n" in text
    assert yaml.safe_load(text)["max_speed"] == 2_000_000


def memory(tic: TicEmulator) -> bytes:
    asked = (bytes([0xA8, address, 1]) for address in range(FIRST, END))
    return b"".join(map(tic.exchange, asked))


def test_what_is_in_use_is_told_apart_from_what_is_stored(bench: Bench, controller: TicController) -> None:
    bench.tic.step_mode, bench.tic.current_limit, bench.tic.decay_mode = 4, 9, 2
    text = controller.backup()
    told = yaml.safe_load(text)
    assert (told["max_speed"], told["max_accel"], told["step_mode"]) == (2_000_000, 40_000, 1)
    for line in ("max_speed: 10000000", "max_accel: 500000", "step_mode: 16", "current_limit: code 9", "position: 0"):
        assert f"# in use: {line}\n" in text
    controller.roll_back()
    assert controller.use_backup(text) == (VOLATILE,)
    assert bench.tic.ramp == [0, 10_000_000, 500_000, 500_000]


def test_a_design_of_it_has_the_ramp_in_use(controller: TicController) -> None:
    [axis] = read_settings(controller.backup(), design(axis__microsteps=8))
    assert TicRamp.of(axis.design) == TicRamp(0, 10_000_000, 500_000, 500_000)
    assert axis.design.axis.microsteps == 1
    assert axis.remarks[0].startswith("The ramp in use is taken: the one that the Tic has stored")
    assert controller.preview_push([axis.design]).same
    controller.roll_back()
    [axis] = read_settings(controller.backup(), design())
    assert len(axis.remarks) == 1


def test_what_differs_of_the_stored_settings_is_told_by_name(bench: Bench, controller: TicController) -> None:
    text = controller.backup()
    bench.tic.command_timeout_ms = 1500
    bench.tic.other_settings = {0x0C: 251, 0x3C: 0x87, 0x40: 12, 0x6C: 1}
    stored = bench.tic.other_settings.copy()
    assert controller.use_backup(text) == (
        "The Tic keeps other settings than in the backup, of which its serial port writes none: command_timeout "
        "1500 (in the backup 1000), sda_config kill_switch pullup (in the backup default), low_vin_timeout 251 "
        "(in the backup 250), current_limit code 12 (in the backup code 6), byte 0x6c code 1 (in the backup code 0). "
        f"{WRITTEN_BY}",
        VOLATILE,
    )
    assert bench.tic.other_settings == stored


def test_a_settings_file_of_a_product_is_compared_in_its_words(bench: Bench, controller: TicController) -> None:
    text = AS_NEW.replace("192", "224").replace("step_mode: 1", "step_mode: full") + "hp_toff: 50\n"
    text = text.replace("serial_crc_for_commands: false", "serial_crc_enabled: true")
    differing, unseen = controller.use_backup(text)
    assert differing == (
        "The Tic keeps other settings than in the backup, of which its serial port writes none: "
        f"serial_crc_enabled false (in the backup true), current_limit 192 (in the backup 224). {WRITTEN_BY}"
    )
    assert unseen == f"What a Tic's serial port doesn't tell can't be compared: hp_toff 50. {WRITTEN_BY}"
    assert bench.tic.ramp == [0, 2_000_000, 40_000, 40_000]


def test_one_of_an_older_version_has_the_ramp_in_use_only(bench: Bench, controller: TicController) -> None:
    text = "starting_speed: 0\nmax_speed: 9000000\nmax_decel: 500000\nmax_accel: 500000\nstep_mode: 1\n"
    assert controller.use_backup(text) == (VOLATILE,)
    assert bench.tic.ramp == [0, 9_000_000, 500_000, 500_000]


def test_one_that_has_the_ramp_in_use_and_what_was_stored_as_bytes(bench: Bench, controller: TicController) -> None:
    """As versions saved it that came before settings files of all."""
    text = "starting_speed: 0\nmax_speed: 9000000\nmax_decel: 500000\nmax_accel: 500000\nstep_mode: 1\n"
    text += "# command_timeout: 1000\n# stored 00: 00 00 00 00 00 e1 04 0e 01 e8 03 00 fa 00 70\n"
    bench.tic.command_timeout_ms = 2000
    differing, forgotten = controller.use_backup(text)
    assert "writes none: command_timeout 2000 (in the backup 1000). " in differing
    assert forgotten == VOLATILE
    assert bench.tic.ramp == [0, 9_000_000, 500_000, 500_000]


@pytest.mark.parametrize("end", [0x5E, 0x60, 0x6C])
def test_an_old_tic_that_is_silent_about_later_settings(bench: Bench, end: int) -> None:
    bench.tic.settings_end = end
    text = saved(bench)
    assert ("# homing_speed_away isn't told\n" in text) == (end < 0x6C)
    assert yaml.safe_load(text)["max_decel"] == 0
    assert bench.controller.status().axes[0].position_steps == bench.tic.position
    assert bench.controller.use_backup(text) == ()


@pytest.mark.parametrize("place", range(0, 600, 7))
def test_a_flipped_bit_is_no_other_setting(bench: Bench, place: int) -> None:
    text = saved(bench)
    bench.tic.on_the_way_out = flipping(place, 4)
    assert bench.controller.backup() == text


def test_a_line_on_which_no_two_readings_agree_saves_nothing(bench: Bench) -> None:
    bench.controller.connect()
    number = iter(range(10**6))

    def damage(said: bytes) -> bytes:
        return bytes([next(number) % 256]) + said[1:] if len(said) == 14 and said[:1] != b"\n" else said

    bench.tic.on_the_way_out = damage
    with pytest.raises(Refused, match="tells something else each time: is its serial line disturbed"):
        bench.controller.backup()


def test_a_motor_that_is_held_is_not_let_go_of_meanwhile(bench: Bench, controller: TicController) -> None:
    """A Tic that hears nothing but questions for a second times out, and may be set to cut the current then."""
    bench.tic.soft_error_response = 0
    controller.move_by(by(10))
    bench.rest()
    bench.lasts_s = 0.04
    controller.backup()
    assert bench.tic.energized


@given(st.dictionaries(st.integers(FIRST, END - 1), st.integers(0, 255)))
def test_whatever_a_tic_tells_is_yaml(kept: dict[int, int]) -> None:
    text = backup_text(Settings(kept), {"position": "0"})
    read = yaml.load(text, Loader=yaml.BaseLoader)
    assert read is None or all(isinstance(value, str) for value in read.values())
    assert Backup.of("max_speed: 1\nmax_accel: 100\n" + text.partition("#T825")[2]).kept.bytes == kept


def test_where_a_motor_is_that_moves_is_not_told(controller: TicController) -> None:
    assert "# in use: position: 0\n" in controller.backup()
    controller.move_by(by(5000))
    assert "position:" not in controller.backup().partition("# in use")[2]
