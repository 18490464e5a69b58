"""The Arduino library as a package: its properties, its keywords, the ramps in its examples."""

import math
import re
import subprocess
import sys
from pathlib import Path

import pytest

from firmware.arduino.board import EXAMPLES, LIBRARY, sources_of
from firmware.arduino.sketches import RAMPS, TICKS_HZ, image_in
from firmware.host import Host, missing_compiler
from firmware.motion import build as build_driver
from firmware.protocol import expand
from tools import require

SOURCES = LIBRARY / "src"
CATEGORIES = {
    *("Display", "Communication", "Signal Input/Output", "Sensors", "Device Control", "Timing", "Data Storage"),
    *("Data Processing", "Other", "Uncategorized"),
}
"""Of the Arduino library specification."""


def properties() -> dict[str, str]:
    lines = (LIBRARY / "library.properties").read_text().splitlines()
    return dict(line.split("=", 1) for line in lines if line and not line.startswith("#"))


def header() -> str:
    """Return what a sketch may use of the library's headers, without comments."""
    text = (SOURCES / "StepRamp.h").read_text() + (SOURCES / "StepRampAxis.h").read_text()
    return re.sub(r"/\*.*?\*/|//[^\n]*|private:.*?(?=^};)", "", text, flags=re.DOTALL | re.MULTILINE)


def test_the_properties_have_all_that_the_specification_demands() -> None:
    found = properties()
    demanded = ("name", "version", "author", "maintainer", "sentence", "paragraph", "category", "url", "architectures")
    assert [field for field in demanded if not found.get(field)] == []
    assert re.fullmatch(r"[A-Za-z0-9][A-Za-z0-9 _.-]{0,62}", found["name"])
    assert found["category"] in CATEGORIES
    assert found["architectures"] == "*"
    assert (SOURCES / found["includes"]).exists()
    assert found["sentence"].endswith(".")


def test_the_version_is_the_firmwares() -> None:
    limits = (SOURCES / "stepramp/edge/board_limits.h").read_text()
    parts = [re.search(rf"#define FIRMWARE_{part} (\d+)", limits) for part in ("MAJOR", "MINOR", "PATCH")]
    assert properties()["version"] == ".".join(part[1] for part in parts if part)


def test_keywords_are_the_public_names() -> None:
    lines = [line for line in (LIBRARY / "keywords.txt").read_text().splitlines() if line and not line.startswith("#")]
    keywords = {kind: set() for kind in ("KEYWORD1", "KEYWORD2", "LITERAL1")}
    for line in lines:
        word, kind = line.split("\t")
        keywords[kind].add(word)
    text = header()
    types = set(re.findall(r"(?:class|enum) (\w+)", text)) | set(re.findall(r"extern \w+ (\w+);", text))
    methods = set(re.findall(r"(\w+)\([^()]*\)(?: const)?;", text)) - types
    constants = set(re.findall(r"^ *(?:constexpr \w+ )?(STEPRAMP_[A-Z_]+)(?= =|,| *$)", text, re.MULTILINE))
    assert keywords == {"KEYWORD1": types, "KEYWORD2": methods, "LITERAL1": constants}


def test_each_example_is_in_a_folder_of_its_name() -> None:
    moving = ["ExportedRamp", "LeadScrewStage", "LineOfTwoMotors", "OneMotor", "StopInFlight", "ThreeGauges"]
    assert sorted(["Controller", "EmergencyStop", "Homing", *moving]) == EXAMPLES
    for name in EXAMPLES:
        text = (LIBRARY / "examples" / name / f"{name}.ino").read_text()
        assert text.startswith("/*")
        assert re.search(r"#include <StepRamp(Axis)?\.h>", text)
        assert not re.search(r"\b(delay|String|malloc|new)\b *\(", text)


@pytest.mark.parametrize("example", RAMPS)
def test_the_bytes_are_the_ramp_that_the_comment_promises(example: str) -> None:
    example_ramp = RAMPS[example]
    assert image_in(example) == example_ramp.ramp.image(example_ramp.axes)
    assert example_ramp.ramp.slew == round(TICKS_HZ / example_ramp.speed)
    for segments, rate in (
        (example_ramp.ramp.up, example_ramp.acceleration),
        (example_ramp.ramp.down, example_ramp.deceleration),
    ):
        intervals = expand(segments)
        first = TICKS_HZ / math.sqrt(2 * rate)
        exact = [first / math.sqrt(n + 1) for n in range(len(intervals))]
        assert max(abs(a - b) for a, b in zip(intervals, exact, strict=True)) <= example_ramp.bound_ticks + 0.5
        assert abs(len(intervals) - example_ramp.speed**2 / (2 * rate)) <= 1


def test_the_firmware_finds_the_bytes_good(tmp_path: Path) -> None:
    require(*missing_compiler())
    with Host(build_driver(tmp_path)) as host:
        for example, example_ramp in RAMPS.items():
            assert host.ask("check", image_in(example).hex()) == f"good {example_ramp.axes} 1"


def test_no_header_hides_one_of_the_c_library() -> None:
    """The IDE has src/ on the include path, and some build systems every folder below it."""
    include_folders = ("/usr/include", "/usr/lib/avr/include")
    theirs = {path.name for folder in include_folders for path in Path(folder).glob("*.h")}
    common = {"limits.h", "queue.h", "port.h", "settings.h"}
    ours = [path.name for path in SOURCES.rglob("*.h")]
    assert [name for name in ours if name in theirs | common] == []
    assert len(ours) == len(set(ours))


def test_variables_have_a_prefix_that_no_sketch_uses(tmp_path: Path) -> None:
    require(*missing_compiler())
    shown = ""
    for number, source in enumerate(path for path in sources_of(LIBRARY) if path.suffix == ".c"):
        target = tmp_path / f"{number}.o"
        command = ["gcc", "-std=gnu11", "-fno-common", f"-I{SOURCES}", "-c", str(source), "-o", str(target)]
        subprocess.run(command, check=True)
        shown += subprocess.run(
            ["nm", "--defined-only", str(target)], capture_output=True, text=True, check=True
        ).stdout
    variables = {words[2] for line in shown.splitlines() if (words := line.split())[1] in "BDRGS"}
    assert len(variables) > 5
    assert [name for name in sorted(variables) if not name.startswith("stepramp_")] == []


def test_the_folder_for_the_library_manager_has_the_library_and_nothing_else(tmp_path: Path) -> None:
    """What Arduino's specification and the rules of arduino-lint ask of a library's files."""
    folder, script = tmp_path / "StepRamp", str(LIBRARY / "make_library.py")
    subprocess.run([sys.executable, script, str(folder)], check=True)
    top = {path.name for path in folder.iterdir()}
    assert top == {"library.properties", "keywords.txt", "README.md", "LICENSE", "src", "examples"}
    made = sorted(path.relative_to(folder) for path in folder.rglob("*") if path.is_file())
    assert [path for path in made if path.suffix in {".exe", ".o", ".hex", ".elf"} or path.name.startswith(".")] == []
    assert not any(path.is_symlink() for path in folder.rglob("*"))
    for name in ("library.properties", "keywords.txt", "src/StepRamp.h", "src/stepramp/edge/step_queue.h"):
        assert (folder / name).read_bytes() == (LIBRARY / name).read_bytes()
    again = subprocess.run([sys.executable, script, str(folder)], capture_output=True, text=True, check=False)
    assert (again.returncode, again.stderr) == (1, f"{folder} is there already\n")


def test_the_readme_has_all_that_names_the_megas_chip() -> None:
    root = LIBRARY.parent
    folders = [LIBRARY, root / "backend" / "stepramp", root / "tests" / "simulator"]
    kinds = {".c", ".cpp", ".h", ".S", ".ino", ".py"}
    files = [path for folder in folders for path in folder.rglob("*.*") if path.suffix in kinds]
    files.append(root / "tests" / "firmware" / "arduino" / "board.py")
    named = {
        path.relative_to(root).as_posix(): len(re.findall(r"(?im)^.*mega ?2560.*$", path.read_text())) for path in files
    }
    text = (LIBRARY / "README.md").read_text().partition("\n## A new board\n")[2]
    told = {file: int(lines) for file, lines in re.findall(r"^\| `(.+?)` \| (\d+) \|", text, re.MULTILINE)}
    assert told == {file: lines for file, lines in named.items() if lines}
