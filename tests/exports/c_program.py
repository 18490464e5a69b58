"""Exported C files, compiled as strictly as people compile, and run."""

import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tools import require

FLAGS = ["-std=c99", "-O1", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-Wconversion"]
IN_CPP = ["-x", "c++", "-std=c++17", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-fsyntax-only"]
"""As sketches for an Arduino are."""

PLAY_MOVES = """
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
int main(int count, char **words)
{
    for (int word = 1; word < count; word++) {
        struct NAME_move move;
        uint64_t ticks;
        NAME_begin(&move, (uint32_t)strtoul(words[word], NULL, 10));
        while ((ticks = NAME_next(&move)) != 0) printf("%" PRIu64 "\\n", ticks);
    }
    return 0;
}
"""

READ_TABLE = """
#include <stdio.h>
#include <stdlib.h>
int main(int count, char **words)
{
    for (int word = 1; word < count; word++)
        printf("%lu\\n", (unsigned long)NAME_delay((uint32_t)strtoul(words[word], NULL, 10)));
    return 0;
}
"""


def compiled(folder: Path, header: str, name: str, program: str) -> Path:
    """Return a program that uses a header whose names begin with `name`, compiled without a warning, as C++ too."""
    require(*(each for each in ("gcc", "g++") if shutil.which(each) is None))
    (folder / "exported.h").write_text(header, encoding="utf-8")
    source = folder / "main.c"
    # Before any other header: it must bring what it needs.
    source.write_text('#include "exported.h"\n' + program.replace("NAME", name), encoding="utf-8")
    subprocess.run(["gcc", *FLAGS, "-o", folder / "program", source], check=True)
    subprocess.run(["g++", *IN_CPP, source], check=True)
    return folder / "program"


def printed(program: Path, arguments: Sequence[int]) -> NDArray[np.int64]:
    """Return the numbers that a program prints for its arguments."""
    run = subprocess.run([program, *map(str, arguments)], check=True, capture_output=True, text=True)
    return np.array(run.stdout.split(), dtype=np.int64)
