from __future__ import annotations

import pytest

from controllers.conformance.answers import refused
from controllers.protocol_line import Line
from controllers.ramps import IMAGE
from stepramp.controllers.stepramp.messages.ramps import CommitRequest, RollBackRequest
from stepramp.controllers.stepramp.messages.reply import ReplyStatus
from stepramp.controllers.stepramp.messages.settings import (
    SETTINGS_BYTES,
    ReadSettingsRequest,
    SettingsReply,
    WriteSettingsRequest,
)
from stepramp.controllers.stepramp.messages.status import StatusFlag
from stepramp.controllers.stepramp.settings import StepRampSettings


def test_settings_begin_with_defaults_and_are_kept_with_a_ramp(port: str) -> None:
    line = Line(port)
    ask = ReadSettingsRequest()
    usual = line.good(ask, SettingsReply).settings
    assert usual[:SETTINGS_BYTES] == StepRampSettings().pack()
    line.store(IMAGE)
    other = StepRampSettings(pulse_width_us=7, direction_setup_us=500, enable_level="high", direction_inverted=(1, 3))
    line.good(WriteSettingsRequest(other.pack()))
    assert line.status().flags & StatusFlag.ON_TRIAL
    assert line.good(ask, SettingsReply).settings == other.pack(usual)
    line.good(RollBackRequest())
    assert line.good(ask, SettingsReply).settings == usual
    line.good(WriteSettingsRequest(other.pack()))
    line.good(CommitRequest())
    line.wait_for_rest()
    assert not line.status().flags & StatusFlag.ON_TRIAL
    line.port.close()
    line = Line(port)
    assert line.good(ask, SettingsReply).settings == other.pack(usual)
    line.port.close()


@pytest.mark.parametrize(
    ("place", "value"),
    [(0, 2), (1, 16), (2, 16), (3, 128), (4, 2), (5, 101), (6, 19), (7, 60), (9, 4)],
)
def test_settings_out_of_range(line: Line, place: int, value: int) -> None:
    before = line.good(ReadSettingsRequest(), SettingsReply).settings
    packed = bytearray(before)
    packed[place] = value
    first_byte = {7: 6, 9: 8}.get(place, place)
    refused(line, WriteSettingsRequest(bytes(packed)), ReplyStatus.OUT_OF_RANGE, first_byte)
    assert line.good(ReadSettingsRequest(), SettingsReply).settings == before
