"""A Klipper whose clock tests set: its configuration, its G-code, and a planner of its own for one straight way.

Written from Klipper's documentation (G-Codes, Config_Reference, Status_Reference) and from what its planner does; it
shares nothing with the code under test.
"""

from __future__ import annotations

import configparser
import fnmatch
import itertools
import math
import posixpath
from collections.abc import Callable, Iterator
from typing import Any

CONFIG = """\
# An Ender, more or less
[include macros/*.cfg]
[mcu]
serial: /dev/ttyUSB0

[printer]
kinematics: cartesian
max_velocity: 300  ; as it came
max_accel: 3000
max_z_velocity: 5
max_z_accel = 100

[stepper_x]
step_pin: PB9
microsteps: 16
rotation_distance: 40
position_max: 235

[stepper_y]
step_pin: PB7
microsteps: 16
rotation_distance: 40
full_steps_per_rotation: 400
position_min: -5
position_max: 235

[stepper_z]
step_pin: PB5
microsteps: 16
rotation_distance: 32
gear_ratio: 80:20
position_max: 250
"""
MACROS = "[gcode_macro START]\ngcode:\n  G28\n  {% if True %}\n  M117 printing\n  {% endif %}\n"
START_S = 0.25
"""So long a motion waits before it begins."""
TICK_S = 0.001


class GcodeError(Exception):
    pass


class Printer:
    """Klipper. clock: its own time [s]. files: of its configuration."""

    def __init__(self, clock: Callable[[], float], files: dict[str, str] | None = None) -> None:
        self.clock = clock
        self.files = {"printer.cfg": CONFIG, "macros/start.cfg": MACROS} if files is None else files
        self.state, self.message = "ready", "Printer is ready"
        self.config_file = "/home/pi/printer_data/config/printer.cfg"
        self.scripts: list[str] = []
        self.homed = "xyz"
        self.prints = "standby"
        self.has_current = False
        self.save_config_pending = False
        self.held_up: list[str] = []
        """G-code that waits for a macro of somebody else to end."""
        self.is_held_up = False
        self.refuses: str | None = None
        """What it says to moves and limits, whose script ends there: what comes after it in it is not carried out."""
        self.restarts = 0
        self.position = [100.0, 100.0, 100.0]
        self.start()

    def start(self) -> None:
        """Read the configuration, as a restart does."""
        self.sections = self._read()
        printer = self.sections.get("printer", {})
        self.velocity = float(printer.get("max_velocity", "nan"))
        self.accel = float(printer.get("max_accel", "nan"))
        self.cruise, self.corner = float(printer.get("minimum_cruise_ratio", 0.5)), 5.0
        self.queue: list[tuple[list[float], float]] = []
        self.target = list(self.position)
        self.speed = self.fastest = self.length = 0.0
        self.ticks = self.clock()
        self.begins_s = self.busy_until_s = 0.0
        self.gcode = {"absolute": True, "factor": 1.0, "feed": 1500.0}
        self.saved: dict[str, dict[str, Any]] = {}
        for option, limit in (("max_z_velocity", self.velocity), ("max_z_accel", self.accel)):
            if float(printer.get(option, limit)) > limit:
                self.state = "error"
                self.message = f"Option '{option}' in section 'printer' must have maximum of {limit}"

    def restart(self) -> None:
        self.restarts += 1
        self.homed, self.has_current, self.state, self.message = "", False, "ready", "Printer is ready"
        self.save_config_pending = False
        self.start()

    def emergency_stop(self) -> None:
        self.advance()
        self.state, self.message = "shutdown", "Shutdown due to webhooks request"
        self.queue, self.speed, self.target, self.held_up = [], 0.0, list(self.position), []
        self.is_held_up = False

    def run(self, script: str) -> None:
        """Carry G-code out."""
        if self.state != "ready":
            raise GcodeError(self.message)
        self.scripts.append(script)
        self.advance()
        for line in script.split("\n"):
            self._line(line)

    def status(self) -> dict[str, dict[str, Any]]:
        """Return its objects, as Status_Reference has them."""
        self.advance()
        low = [float(self.sections[f"stepper_{axis}"].get("position_min", 0)) for axis in "xyz"]
        high = [float(self.sections[f"stepper_{axis}"]["position_max"]) for axis in "xyz"]
        return {
            "webhooks": {"state": self.state, "state_message": self.message},
            "toolhead": {
                "position": [*self.target, 0.0],
                "homed_axes": self.homed,
                "axis_minimum": [*low, 0.0],
                "axis_maximum": [*high, 0.0],
                "print_time": self.clock(),
                "estimated_print_time": self.clock(),
                "max_velocity": self.velocity,
                "max_accel": self.accel,
                "minimum_cruise_ratio": self.cruise,
                "square_corner_velocity": self.corner,
            },
            "motion_report": {"live_position": [*self.position, 0.0], "live_velocity": self.speed},
            "print_stats": {"state": self.prints, "filename": ""},
            "virtual_sdcard": {"is_active": self.prints == "printing"},
            "idle_timeout": {"state": "Printing" if self.clock() < self.busy_until_s else "Ready"},
            "stepper_enable": {"steppers": {f"stepper_{axis}": self.has_current for axis in "xyz"}},
            "configfile": {
                "config": {name: dict(options) for name, options in self.sections.items()},
                "save_config_pending": self.save_config_pending,
            },
        }

    def advance(self) -> None:
        """Move on to the clock's time: faster as long as it can still slow down to the end of what is queued."""
        now_s = self.clock()
        while self.ticks < now_s:
            self.ticks += TICK_S
            if self.queue and self.ticks >= self.begins_s:
                self._tick()
        if self.queue:
            self.busy_until_s = now_s + 0.5

    def _tick(self) -> None:
        left = self._left()
        z_share = abs(self.queue[0][0][2] - self.position[2]) / max(math.dist(self.queue[0][0], self.position), 1e-12)
        printer = self.sections["printer"]
        accel, fast = self.accel, min(self.queue[0][1], self.velocity)
        if z_share > 1e-9:
            accel = min(accel, float(printer.get("max_z_accel", self.accel)) / z_share)
            fast = min(fast, float(printer.get("max_z_velocity", self.velocity)) / z_share)
        fast = min(fast, math.sqrt(self.length * accel * (1 - self.cruise)))
        self.speed = min(self.speed + accel * TICK_S, fast, math.sqrt(2 * accel * left))
        self.fastest = max(self.fastest, self.speed)
        way = min(max(self.speed, 0.02) * TICK_S, left)
        while self.queue:
            goal = self.queue[0][0]
            length = math.dist(goal, self.position)
            if way < length:
                share = way / length
                self.position = [at + (to - at) * share for at, to in zip(self.position, goal, strict=True)]
                return
            self.position, way = list(goal), way - length
            self.queue.pop(0)
        self.speed = self.length = 0.0

    def _left(self) -> float:
        places = [self.position, *(goal for goal, _ in self.queue)]
        return sum(math.dist(one, other) for one, other in itertools.pairwise(places))

    def _line(self, line: str) -> None:
        word, *rest = line.split()
        given = dict(each.split("=") for each in rest) if word.isupper() and "_" in word else {}
        if self.refuses is not None and word in ("G1", "SET_VELOCITY_LIMIT"):
            raise GcodeError(self.refuses)
        match word:
            case "SAVE_GCODE_STATE":
                self.saved[given["NAME"]] = dict(self.gcode)
            case "RESTORE_GCODE_STATE":
                if given["NAME"] not in self.saved:
                    raise GcodeError(f"Unknown g-code state: {given['NAME']}")
                assert "MOVE" not in given
                self.gcode = dict(self.saved[given["NAME"]])
            case "G90" | "G91":
                self.gcode["absolute"] = word == "G90"
            case "M220":
                self.gcode["factor"] = float(rest[0].removeprefix("S")) / 100
            case "G1":
                self._move({each[0]: float(each[1:]) for each in rest})
            case "SET_VELOCITY_LIMIT":
                names = {"VELOCITY": "velocity", "ACCEL": "accel"}
                names |= {"MINIMUM_CRUISE_RATIO": "cruise", "SQUARE_CORNER_VELOCITY": "corner"}
                for name, value in given.items():
                    if float(value) < 0 or (name in ("VELOCITY", "ACCEL") and float(value) == 0):
                        raise GcodeError(f"Error on '{line}': {name} must be above 0")
                    setattr(self, names[name], float(value))
            case _:
                raise GcodeError(f'Unknown command:"{word}"')

    def _move(self, words: dict[str, float]) -> None:
        self.gcode["feed"] = words.pop("F", self.gcode["feed"])
        goal = list(self.target)
        for letter, value in words.items():
            axis = "XYZ".index(letter)
            if "xyz"[axis] not in self.homed:
                raise GcodeError("Must home axis first: 100.000 100.000 100.000 [0.000]")
            goal[axis] = value if self.gcode["absolute"] else goal[axis] + value
            options = self.sections[f"stepper_{'xyz'[axis]}"]
            # Compared as exactly as Klipper does.
            if not float(options.get("position_min", 0)) <= goal[axis] <= float(options["position_max"]):
                raise GcodeError(f"Move out of range: {goal} [0.000]")
        if not self.queue:
            self.begins_s = self.clock() + START_S
        self.length += math.dist(goal, self.target)
        self.queue.append((goal, self.gcode["feed"] / 60 * self.gcode["factor"]))
        self.target, self.has_current, self.busy_until_s = goal, True, self.clock() + 0.5

    def _read(self) -> dict[str, dict[str, str]]:
        parser = configparser.RawConfigParser(strict=False, inline_comment_prefixes=(";", "#"))
        parser.read_string("\n".join(self._included("printer.cfg")))
        return {name: dict(parser.items(name)) for name in parser.sections()}

    def _included(self, path: str) -> Iterator[str]:
        """Yield the lines of a file, with those of what it includes where it does so: hidden files are in no glob."""
        for line in self.files[path].split("\n"):
            if not line.startswith("[include "):
                yield line
                continue
            folder, _, name = posixpath.join(posixpath.dirname(path), line[9:].split("]")[0]).rpartition("/")
            for each in sorted(self.files):
                inside, _, last = each.rpartition("/")
                if inside == folder and fnmatch.fnmatchcase(last, name) and not last.startswith("."):
                    yield from self._included(each)
