import re
from pathlib import Path
from typing import Any

import pytest

from designs import design
from exports.c_program import compiled, printed
from firmware.protocol import Ramp
from stepramp.errors import Rejected
from stepramp.exports.export import Options, export

PRINT_BYTES = """
#include <stdio.h>
int main(void)
{
    for (unsigned i = 0; i < sizeof x_ramp; i++) {
        printf("%u\\n", x_ramp[i]);
    }
    return 0;
}
"""


def exported(format_name: str, asked: Any, bound: int) -> str:
    return export(asked, format_name, Options(name="x", segment_bound_ticks=bound)).content.decode()


def segments_of(header: str, side: str) -> list[tuple[int, int, int]]:
    found = re.search(rf"x_{side}\[\] = {{(.*?)}};", header, re.DOTALL)
    assert found
    rows = re.findall(r"\{(-?\d+), (\d+), (-?\d+)\}", found[1])
    return [(int(interval), int(count), int(add)) for interval, count, add in rows if count != "0"]


@pytest.mark.parametrize("frequency_hz", [2_000_000, 16_000_000])
@pytest.mark.parametrize("deceleration", [None, 3000])
def test_the_bytes_are_the_segments_as_the_protocol_packs_them(
    tmp_path: Path, frequency_hz: int, deceleration: int | None
) -> None:
    """The segments are those of c_segments, whose tests play them; they are packed here by the firmware's own tests."""
    asked = design(
        timer__frequency_hz=frequency_hz, timer__counter_bits=32, ramp__deceleration_steps_per_s2=deceleration
    )
    bound = 20 * frequency_hz // 2_000_000
    segments = exported("c_segments", asked, bound)
    slew = int(re.search(r"X_SLEW (\d+)", segments)[1])  # type: ignore[index]
    wanted = Ramp(segments_of(segments, "up"), slew, segments_of(segments, "down"))
    program = compiled(tmp_path, exported("c_ramp_image", asked, bound), "x", PRINT_BYTES)
    assert bytes(printed(program, []).tolist()) == wanted.image(fast=frequency_hz == 16_000_000)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"timer__frequency_hz": 1_000_000}, "timer.frequency_hz is .*; allowed: 2,000,000 or 16,000,000 Hz"),
        ({"ramp__acceleration_steps_per_s2": 20}, "Too long for a controller: .* of 250 segments; allow"),
        ({"timer__frequency_hz": 16_000_000, "timer__counter_bits": 32, "ramp__acceleration_steps_per_s2": 0.0015,
          "ramp__slew_speed_steps_per_s": 0.06}, "acceleration_steps_per_s2 is 0.0015; allowed: faster"),
    ],
)  # fmt: skip
def test_what_no_image_can_hold_is_refused(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(Rejected, match=message):
        exported("c_ramp_image", design(**changes), 0)


def test_a_ramp_of_too_many_segments_is_told_the_finest_bound_that_fits() -> None:
    """Of those that are tried, which double: half of it is too little."""
    long = design(ramp__acceleration_steps_per_s2=100)
    with pytest.raises(Rejected) as caught:
        exported("c_ramp_image", long, 0)
    [[change]] = [remedy.changes for remedy in caught.value.rejections[0].remedies]
    assert change.field == "segment_bound_ticks"
    assert isinstance(change.value, int)
    assert exported("c_ramp_image", long, change.value)
    with pytest.raises(Rejected):
        exported("c_ramp_image", long, change.value // 2)
