from pathlib import Path
from typing import Any

import pytest

from designs import design
from exports.c_program import compiled
from exports.test_files import NASTY
from stepramp.exports.export import Options, export

USE = "int main(void) { return 0; }\n"


@pytest.mark.parametrize("format_name", ["c_table", "c_segments", "c_ramp_image", "c_compromise", "c_newton"])
@pytest.mark.parametrize("name", [NASTY, "*/ int x = 1; /*", "\\", "default"])
def test_no_name_of_a_design_breaks_a_header(tmp_path: Path, format_name: Any, name: str) -> None:
    compiled(tmp_path, export(design(name=name), format_name, Options()).content.decode(), "", USE)


def test_headers_of_one_design_can_be_used_together(tmp_path: Path) -> None:
    both = [export(design(), name, Options()).content.decode() for name in ("c_table", "c_segments")]
    compiled(tmp_path, "".join(both), "test", "int main(void) { return test_delay(1) != 0 && test_up[0].count; }\n")
