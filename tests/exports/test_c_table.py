import shutil
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from designs import design
from exports.c_program import READ_TABLE, compiled, printed
from stepramp.errors import Rejected
from stepramp.exports.export import Options, export
from stepramp.ramp.profile import profile_of
from tools import require

TABLES: dict[str, dict[str, Any]] = {
    "us": {},
    "ticks": {"table__interval_unit": "ticks"},
    "one row": {"table__rows": [[5, 777]]},
    "wide": {"table__rows": [[10, 100_000], [70_000, 80_000]]},
}


@pytest.mark.parametrize("table", TABLES)
def test_a_move_by_the_exported_table_is_the_planned_one(tmp_path: Path, table: str) -> None:
    # At 1 MHz a delay in µs is one in ticks.
    asked = design(timer__frequency_hz=1_000_000, method__name="table", move__steps=5000, **TABLES[table])
    header = export(asked, "c_table", Options(name="gauge")).content.decode()
    program = compiled(tmp_path, header, "gauge", READ_TABLE)
    # The gauge library: the first step up is at ramp index 2, the last one down at 0.
    assert asked.table is not None
    top = min(asked.table.rows[-1][0], 2500)
    profile = profile_of(asked).intervals_ticks
    np.testing.assert_array_equal(printed(program, range(2, top + 1)), profile[: top - 1])
    np.testing.assert_array_equal(printed(program, range(top)), profile[::-1][:top])
    assert printed(program, [asked.table.rows[-1][0] + 5]) == asked.table.rows[-1][1]


@pytest.mark.parametrize("table", TABLES)
def test_an_avr_compiler_takes_the_table_in_program_memory(tmp_path: Path, table: str) -> None:
    require(*([] if shutil.which("avr-gcc") else ["avr-gcc"]))
    header = export(design(**TABLES[table]), "c_table_progmem", Options(name="gauge")).content.decode()
    (tmp_path / "exported.h").write_text(header)
    (tmp_path / "main.c").write_text('#include "exported.h"\nint main(void) { return (int)gauge_delay(7); }\n')
    flags = ["-std=c99", "-Os", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-Wconversion", "-mmcu=atmega328p"]
    subprocess.run(["avr-gcc", *flags, "-o", tmp_path / "program.elf", tmp_path / "main.c"], check=True)
    symbols = subprocess.run(["avr-nm", tmp_path / "program.elf"], check=True, capture_output=True, text=True).stdout
    [place] = [line.split()[1] for line in symbols.splitlines() if line.endswith(" gauge_table")]
    assert place == "t", "among the program, not in RAM"


@pytest.mark.parametrize("format_name", ["c_table", "c_table_progmem"])
def test_without_a_table_there_is_none_to_export(format_name: Any) -> None:
    with pytest.raises(Rejected, match="table is missing; allowed: a table"):
        export(design(table=None), format_name, Options())
