"""The page's modules are what their JSDoc says they are: checked by TypeScript, which makes nothing of them."""

import shutil
import subprocess
from pathlib import Path

from tools import require

FRONTEND = Path(__file__).parents[2] / "frontend"
NEWER_BROWSERS = Path(__file__).with_name("newer_browsers.d.ts")
OPTIONS = (
    "--noEmit --allowJs --checkJs --strict --target es2022 --module es2022 --moduleResolution node "
    "--lib es2022,dom,dom.iterable"
)


MODULES = sorted(FRONTEND.rglob("*.js"))


def test_typescript_finds_nothing_wrong() -> None:
    require(*([] if shutil.which("tsc") else ["tsc"]))
    command = ["tsc", *OPTIONS.split(), NEWER_BROWSERS, *MODULES]
    found = subprocess.run(command, cwd=FRONTEND, capture_output=True, text=True, check=False)
    assert found.stdout.splitlines() == []
    assert found.returncode == 0


def test_every_module_asks_to_be_checked() -> None:
    assert [module.name for module in MODULES if not module.read_text().startswith("// @ts-check\n")] == []
