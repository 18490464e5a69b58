"""A FluidNC: a grbl with another banner, and a configuration in a file in place of numbered settings.

Written from its wiki and from how its settings are processed: an item that makes the configuration invalid is refused,
and in use all the same.
"""

from __future__ import annotations

import re
import time
from collections.abc import Callable

from controllers.grbl.emulator import GrblEmulator, float32
from controllers.pseudo_terminal import PseudoTerminal

FILE = """\
# Mine, as the wiki has it
board: 6 Pack
name: Router
stepping:
  engine: RMT
  idle_ms: 250
  pulse_us: 4

axes:
  shared_stepper_disable_pin: NO_PIN
  x:
    steps_per_mm: 250
    max_rate_mm_per_min: 500.000
    acceleration_mm_per_sec2: 10
    max_travel_mm: 200.000
    homing:
      cycle: 2
      seek_mm_per_min: 200.000
    motor0:
      limit_neg_pin: gpio.39:low
      tmc_2209:
        microsteps: 16
        run_amps: 0.750
  y:
    steps_per_mm: 250
    max_rate_mm_per_min: 500.000
    acceleration_mm_per_sec2: 10
    motor0:
      standard_stepper:
        step_pin: I2SO.5
  z:
    steps_per_mm: 250
    max_rate_mm_per_min: 500.000
    acceleration_mm_per_sec2: 10

uart1:
  mode: 8N1
macros:
  startup_line0:
  startup_line1:
  after_reset:
  after_unlock:
  macro0: $SD/Run=lift.nc & G0 X0
Huanyang:
  speed_map: 0=0% 0=25% 6000=25% 24000=100%
report_inches: false
"""
ITEMS = {"STEPS_PER_MM": 100, "MAX_RATE_MM_PER_MIN": 110, "ACCELERATION_MM_PER_SEC2": 120}
ITEM = re.compile(r"\$/AXES/([XYZ])/(\w+)=(.*)")
ASKED = re.compile(r"\$/AXES/([XYZ])/(\w+)")
MOST_STEPS_PER_S = 100_000


class FluidNcEmulator(GrblEmulator):
    """One FluidNC with its motors."""

    def __init__(self, clock: Callable[[], float] = time.monotonic, decimals: int = 3) -> None:
        self.decimals = decimals
        self.file = FILE
        self.file_name = "config.yaml"
        self.has_file_system = True
        self.has_written = False
        super().__init__(clock)
        self.banner = "Grbl 3.7 [FluidNC v3.7.2 (wifi) '$' for help]"
        self.version = ["[VER:3.7 FluidNC v3.7.2:]", "[OPT:MPHS]", "[MSG: Machine: Router]"]
        self.dumps_as: Callable[[str], str] = lambda text: text

    def _macro(self, name: str) -> str:
        found = re.search(rf"\n  {name}: *(.*)", self.file)
        return found[1].strip() if found else ""

    def _begin_anew(self, after_s: float) -> None:
        # G-code is refused while it is locked, also that of its macros.
        self.eeprom.startup = [self._macro(name) for name in ("startup_line0", "startup_line1", "after_reset")]
        super()._begin_anew(after_s)

    def _load(self) -> None:
        super()._load()
        for axis, letter in enumerate("xyz"):
            block = self.file.partition(f"\n  {letter}:")[2]
            for item, first in ITEMS.items():
                found = re.search(rf"\n    {item.lower()}: *([\d.]+)", block)
                self.settings[first + axis] = float32(float(found[1])) if found else 0.0

    def power_up(self) -> None:
        super().power_up()
        # As an ESP32 begins, at a baud rate that happens to be this one.
        self._said.insert(0, (self._now_s, b"ets Jul 29 2019 12:21:46\r\n\r\nrst:0x1 (POWERON_RESET),boot:0x13\r\n"))
        self._said.insert(
            1, (self._now_s, b"[MSG:INFO: FluidNC v3.7.2]\r\n[MSG:INFO: Configuration file:config.yaml]\r\n")
        )

    def _obey(self, line: str) -> None:
        item = ITEM.fullmatch(line)
        if item is not None:
            self._set_item(*item.groups())
        elif (asked := ASKED.fullmatch(line)) is not None:
            value = self.settings[ITEMS[asked[2]] + "XYZ".index(asked[1])]
            self._say(f"{line.lower()}={value:.{self.decimals}f}")
            self._say("ok")
        elif line == "$CD":
            for each in self.dumps_as(self._dump()).split("\n"):
                self._say(each)
            self._say("ok")
        elif line.startswith("$CD="):
            self.has_written = True
            self._say("ok")
        elif line == "$CONFIG/FILENAME":
            self._say(f"$Config/Filename={self.file_name}")
            self._say("ok")
        elif line.startswith("$LOCALFS/SHOW="):
            if not self.has_file_system or line != "$LOCALFS/SHOW=/CONFIG.YAML":
                self._say("error:60")
                return
            for each in self.file.split("\n"):
                self._say(each)
            self._say("ok")
        elif line in ("$$", "$N") or re.match(r"\$1\d\d=", line):
            self._say("error:3")
        else:
            super()._obey(line)
            if line == "$X":
                self._run_block(self._macro("after_unlock"))

    def _set_item(self, letter: str, item: str, text: str) -> None:
        if self.state not in ("Idle", "Alarm"):
            self._say("error:8")
            return
        number = ITEMS[item] + "XYZ".index(letter)
        self.settings[number] = float32(min(max(float(text), 0.001), 100_000.0))
        axis = number % 10
        rate = self.settings[100 + axis] * self.settings[110 + axis] / 60
        if rate > MOST_STEPS_PER_S:
            self._say(f"[MSG:ERR: Configuration change failed: Stepping rate {rate:.0f} steps/sec exceeds the maximum]")
        self._say("error:152" if rate > MOST_STEPS_PER_S else "ok")

    def _dump(self) -> str:
        """Return its configuration as it writes it: without comments, each number with so many decimals."""
        lines, letter = [], ""
        for line in self.file.split("\n"):
            if line.startswith("#"):
                continue
            if (axis := re.fullmatch(r"  ([xyz]):", line)) is not None:
                letter = axis[1]
            item = re.fullmatch(r"    (\w+): *[\d.]+(?: *#.*)?", line)
            if item is not None and item[1].upper() in ITEMS:
                value = self.settings[ITEMS[item[1].upper()] + "xyz".index(letter)]
                lines.append(f"    {item[1]}: {value:.{self.decimals}f}")
            else:
                lines.append(line)
        return "\n".join(lines)


class FluidNcOnACable(PseudoTerminal):
    """A FluidNC at a pseudo-terminal, plugged in while the context lasts."""

    def __init__(self, fluidnc: FluidNcEmulator | None = None) -> None:
        super().__init__()
        self.fluidnc = fluidnc or FluidNcEmulator()

    def opened(self) -> None:
        self.fluidnc.opened()

    def exchange(self, data: bytes) -> bytes:
        return self.fluidnc.exchange(data)
