"""Lookup tables read from C, whole files of it, CSV and sheets, and written."""

import time
from typing import Any

import pytest

from frontend.modules import Modules
from stepramp.design import MOST_TABLE_ROWS
from waiting import PATIENCE_S


def read(modules: Modules, text: str) -> list[dict[str, Any]]:
    reading = modules.call("documents/table_text.js", "readTables", text)
    assert reading["problem"] is None
    return list(reading["tables"])


def problem(modules: Modules, text: str) -> str:
    reading = modules.call("documents/table_text.js", "readTables", text)
    assert reading["tables"] is None
    return str(reading["problem"])


@pytest.mark.parametrize(
    "text",
    [
        "#pragma once\n" + "//\n" * 300_000 + "int a[][2] = {{1, 2}};",
        "#endif /*" + " " * 1_000_000 + "*/ int a[][2] = {{1, 2}};",
        "int a[][2] = {{1, 2}}; " + "/* " * 400_000,
    ],
)
def test_long_comments_are_gone_over_once(modules: Modules, text: str) -> None:
    """Looked at again from each of their places, they would take hours."""
    assert [table["rows"] for table in read(modules, text)] == [[[1, 2]]]


LIBRARY = """/*
 *  A gauge library; its ticks are its own.
 */
#include <Arduino.h>
#include "Gauge.h"

// How the needle speeds up.
// The first number is the step, the second the delay in microseconds { so they say }
static unsigned short defaultTable[][2] = {
  {   20, 3000},
  {   50, 1500},
  {  100, 1000}
  // some needles go faster than 400uS; it's { a matter of } weight
};

#define TABLE_ROWS (sizeof(defaultTable)/sizeof(*defaultTable))
const int resetDelay = 300;

void Gauge::write() {
  static byte states[] = {0x9, 0x1, 0x7, 0x6, 0xE, 0x8};
  for (int i = 0; i < 4; i++) { digitalWrite(pins[i], states[state] & (1 << i)); }
  Serial.println("{ not a \\" brace");
  while (defaultTable[i][0] < vel) { i++; }
  if (a[1][2] == b) { delay = defaultTable[i][1]; }
}
"""
"""Written as gauge libraries are: one table among comments, other arrays and functions."""

HEADER = """#ifndef TABLES_H
#define TABLES_H
#define F_TICKS 2000000UL
#define COLUMNS 2
#define SLOW (F_TICKS / 200) \\
  + 5
#define ROW(step, delay) {step, delay}
constexpr uint16_t FAST = 0x4B0;
const uint16_t PROGMEM slow[][COLUMNS] = { // ticks
  { 10, (uint16_t)SLOW }, { 20, FAST * 2 - 1 },
};
const PROGMEM uint16_t fast[2][2] PROGMEM = { { 5u, 1'000 }, { 300, (1 << 9) + 7 % 4 } };
uint16_t brackets[][2] { {1, 0b101}, {2, +4} };
const uint16_t wide[][3] = { {1, 2, 3} };
static const uint16_t unknown[][2] = { {1, SPEED} };
#endif
"""


def test_the_table_of_a_library_is_found_in_its_whole_source(modules: Modules) -> None:
    for text in (LIBRARY, LIBRARY.replace("\n", "\r\n"), LIBRARY[200:], LIBRARY[: LIBRARY.index("void") + 60]):
        [table] = read(modules, text)
        assert (table["name"], table["unit"]) == ("defaultTable", "us")
        assert table["rows"] == [[20, 3000], [50, 1500], [100, 1000]]
    assert read(modules, LIBRARY)[0]["line"] == 9
    page = "Some words.\n\n<pre><code>" + LIBRARY[LIBRARY.index("static") :] + "</code></pre> and {% more %} words"
    assert read(modules, page)[0]["rows"] == [[20, 3000], [50, 1500], [100, 1000]]


def test_all_tables_of_a_file_are_told_by_name(modules: Modules) -> None:
    tables = read(modules, HEADER)
    assert [(table["name"], table["line"], table["rows"]) for table in tables] == [
        ("slow", 9, [[10, 10005], [20, 2399]]),
        ("fast", 12, [[5, 1000], [300, 515]]),
        ("brackets", 13, [[1, 5], [2, 4]]),
        ("unknown", 15, None),
    ]
    assert tables[0]["unit"] == "ticks"
    assert "unit" not in tables[1]
    assert tables[3]["problem"] == "Row 1: “SPEED” is not a number."


def test_rows_of_a_type_of_rows_are_found_where_no_array_says_two(modules: Modules) -> None:
    for declaration in ("static const Row rows[] =", "std::array<std::array<int, 2>, 2> rows =", "Row rows[COUNT] ="):
        [table] = read(modules, f"int pins[] = {{1, 2}};\n{declaration} {{{{ {{10, 5000}}, {{30, 1500}} }}}};")
        assert (table["name"], table["rows"]) == ("rows", [[10, 5000], [30, 1500]])


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("int f() { return 1; }\nint pins[4] = {1, 2, 3, 4};\nint w[][3] = {{1,2,3}};", "has: pins[4], w[][3]."),
        ("int pins[3] = {1, 2, 3};", "No array here has rows of two numbers"),
        ("Row rows[] = {{1, 2}, {3}};", "Row 2 has 1 value"),
        ("#include <x.h>\nint f() { return 1; }", "There is no array with rows of two numbers here"),
        ("#include <x.h>\n#define A 5\n", "There is no array with rows of two numbers here"),
        ("extern int speeds_count;\nvoid setup(void);\n", "There is no array with rows of two numbers here"),
        ("int t[][2] = { {1, 2}, {3, 4}", "what “t” holds has no end"),
        ("#define A 5\n#define A 6\nint t[][2] = { {1, A} };", "Row 1: “A” is defined as 5 and as 6."),
        ("#define A A\nint t[][2] = { {1, A} };", "Row 1: “A” is not a number."),
        ("int t[][2] = {\n{1, 2},\n#if FAST\n{3, 4}\n#endif\n};", "“#if FAST” stands between the rows"),
        ("int t[][2] = { {1, MS(5)} };", "Row 1: “MS(5)” is not a number."),
        ("int t[][2] = { {1, 5 / 0} };", "divides by 0"),
        ("int t[][2] = { {1, (5} };", "“(5” is not a number"),
        ("2026-01-02, 5", "Row 1: “2026-01-02” is not a number"),
        ("\x00\x01\x02{", "1 closing brace “}” is missing"),
    ],
)
def test_sources_without_a_table_are_explained(modules: Modules, text: str, words: str) -> None:
    assert words in problem(modules, text)


def test_as_many_rows_as_a_design_takes_are_read_and_not_one_more(modules: Modules) -> None:
    def source(rows: int) -> str:
        return (
            "uint32_t t[][2] = {\n" + "".join(f"  {{ {10 * row}, {90000 - row} }},\n" for row in range(rows)) + "};\n"
        )

    [table] = read(modules, source(MOST_TABLE_ROWS))
    assert len(table["rows"]) == MOST_TABLE_ROWS
    for text in (source(MOST_TABLE_ROWS + 1), "".join(f"{row}, 500\n" for row in range(MOST_TABLE_ROWS + 1))):
        assert problem(modules, text) == "It has 1,001 rows; a table has at most 1,000."


@pytest.mark.parametrize(
    "text",
    [
        "{" * 500_000,
        "a[" * 300_000,
        "x = {" * 200_000,
        "( " * 500_000 + "{}",
        "/*" * 500_000,
        "uint16_t t[][2] = {" + "{1, 2}," * 100_000 + "};",
        "a" * 1_000_000 + " {",
        "1, 2\n" * 300_000,
        "const x = " * 100_000 + "{",
        "a[]={1};\n" * 200_000,
        "a[1]" * 200_000 + "{",
        " {}" * 300_000,
        "#define A A+A+A+A+A\nint t[][2] = { {1, A} };",
        "\n" * 500_000 + "{",
        "sep=;",
    ],
)
def test_nonsense_of_any_length_is_answered_at_once(modules: Modules, text: str) -> None:
    # Where time grew with the square of the length, it took many minutes.
    before = time.monotonic()
    reading = modules.call("documents/table_text.js", "readTables", text)
    assert reading["problem"]
    assert time.monotonic() - before < PATIENCE_S
    assert "at most 2,000,000 are read" in problem(modules, " " * 2_000_001)


@pytest.mark.parametrize(
    ("text", "rows"),
    [
        ("{ 10, 5000 }, { 30, 1500 }", [[10, 5000], [30, 1500]]),
        ("{10,5000},{30,1500},", [[10, 5000], [30, 1500]]),
        ("{{10, 5000}, {30, 1500}}", [[10, 5000], [30, 1500]]),
        ("unsigned short accelTable[][2] = {\n {  10, 5000},\n {30,1500}\n};", [[10, 5000], [30, 1500]]),
        ("const uint16_t t[1][2] PROGMEM = { {10u, 5000UL} };", [[10, 5000]]),
        ("uint16_t t[][2] = { 10, 5000, 30, 1500 };", [[10, 5000], [30, 1500]]),
        ("/* {1, 2}, */ {0x0A, 0x1388} // {3, 4}", [[10, 5000]]),
        ("{ 10,\r\n 5000 },\r\n\r\n{ 30, 1500 }", [[10, 5000], [30, 1500]]),
        ("{10, 5e3}", [[10, 5000]]),
        ("{0, 5000}", [[0, 5000]]),
        ("10\t5000\n30\t1500\n", [[10, 5000], [30, 1500]]),
        ("10, 5000\n30; 1500", [[10, 5000], [30, 1500]]),
        ("{-1, 5000}", [[-1, 5000]]),
    ],
)
def test_tables_that_are_understood(modules: Modules, text: str, rows: list[list[float]]) -> None:
    [table] = read(modules, text)
    assert table["rows"] == rows


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "nothing to read"),
        ("  // {1, 2}", "nothing to read"),
        ("{}", "Row 1: a number is missing"),
        ("{{}}", "Row 1: a number is missing"),
        ("t[][2] = {};", "No row found"),
        ("t[][2] = {1, 2, 3};", "3 numbers don’t make rows of two"),
        ("{10}", "Row 1 has 1 value;"),
        ("{10, 5000}, {30}", "Row 2 has 1 value;"),
        ("{10, 5000, 1}, {30, 1500}", "Row 1 has 3 values"),
        ("{10, 5000}, {30, fast}", "Row 2: “fast” is not a number"),
        ("{10, }, {30, 1500}", "Row 1"),
        ("{010, 5000}, {30, 1500}", "octal"),
        ("{{10, 5000", "2 closing braces “}” are missing"),
        ("int main(){", "no array with rows of two numbers"),
        ("10, 5000}", "1 opening brace “{” is missing"),
        ("{{{10, 5000}}, {30, 1500}}", "nested deeper"),
        ("{10, 5000} + {30, 1500}", "stands between the rows"),
        ("{10, 1e999}, {30, 1}", "too large"),
        ("hello", "Row 1 has 1 value"),
    ],
)
def test_tables_that_are_not_understood_are_explained(modules: Modules, text: str, words: str) -> None:
    assert words in problem(modules, text)


@pytest.mark.parametrize(
    ("text", "rows", "unit"),
    [
        ("last step;delay (µs)\r\n3;8284\r\n7;4783,5", [[3, 8284], [7, 4783.5]], "us"),
        ("#\tto index\tdelay, ticks\tsteps/s\n1\t3\t16,568\t120.7\n2\t7\t9,566\t209", [[3, 16568], [7, 9566]], "ticks"),
        ('"3","8,284"\n"7","4,783"', [[3, 8284], [7, 4783]], None),
        ("sep=;\n3;1.234.567", [[3, 1234567]], None),
        ("\ufeffdelay_us,index\n5000,10\n", [[10, 5000]], "us"),
        ("step delay\n10 5000", [[10, 5000]], None),
        ("/* delay in ticks */ {10, 5000}", [[10, 5000]], "ticks"),
        ("bus, status\n10, 5000", [[10, 5000]], None),
    ],
)
def test_sheets_are_understood(modules: Modules, text: str, rows: list[list[float]], unit: str | None) -> None:
    [table] = read(modules, text)
    assert (table["rows"], table.get("unit")) == (rows, unit)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("a,b,c\n1,2,3", "none that are called “step” and “delay”"),
        ("index;delay\n;5", "Row 1: a number is missing"),
        ("index;delay\n3;fast", "Row 1: “fast” is not a number"),
        ("10,5000,,", "Row 1 has 4 values"),
    ],
)
def test_sheets_that_are_not_understood_are_explained(modules: Modules, text: str, words: str) -> None:
    assert words in problem(modules, text)


def test_what_is_written_is_read_back(modules: Modules) -> None:
    for unit in ("us", "ticks"):
        for written in ("tableAsC", "tableAsCsv"):
            text = modules.call("documents/c_table.js", written, [[3, 8284], [70000, 90000]], unit)
            [table] = read(modules, text)
            assert (table["rows"], table["unit"]) == ([[3, 8284], [70000, 90000]], unit)
    assert "uint32_t" in modules.call("documents/c_table.js", "tableAsC", [[3, 70000]], "us")
