"""A lookup table as a C header, in RAM or in an AVR's program memory."""

from stepramp.design import Design
from stepramp.errors import Rejected, Rejection
from stepramp.exports.c_text import filled, heading


def table_header(design: Design, name: str, *, in_progmem: bool) -> str:
    """Return the design's lookup table as a C header. Raises Rejected when it has none."""
    if design.table is None:
        raise Rejected([Rejection("table", None, "a table: this design has none to export")])
    rows = design.table.rows
    unit = "microseconds" if design.table.interval_unit == "us" else f"ticks of {design.timer.frequency_hz:g} Hz"
    is_short = max(max(row) for row in rows) < 2**16
    read = "pgm_read_word" if is_short else "pgm_read_dword"
    index, delay = (f"{name}_table[row][{column}]" for column in (0, 1))
    return filled(
        "table.h",
        heading(design, name, "table") | {
            "unit": unit,
            "include": "#include <avr/pgmspace.h>\n" if in_progmem else "",
            "rows": str(len(rows)),
            "type": "uint16_t" if is_short else "uint32_t",
            "place": " PROGMEM" if in_progmem else "",
            "lines": "\n".join(f"    {{{last}, {interval}}}," for last, interval in rows),
            "index_of_row": f"{read}(&{index})" if in_progmem else index,
            "delay_of_row": f"{read}(&{delay})" if in_progmem else delay,
        },
    )  # fmt: skip
