"""What a Klipper keeps: limits in use, which a restart forgets, and the files of its configuration.

Nothing is written but options of the section [printer]. `SAVE_CONFIG` would not do: it writes values that Klipper has
calibrated itself, never these, and restarts it whatever goes on.
"""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from datetime import UTC, datetime
from time import monotonic

from stepramp.controllers.given_numbers import typed
from stepramp.controllers.klipper.backup import Backup
from stepramp.controllers.klipper.configuration import (
    Configuration,
    Place,
    Sections,
    paths_of,
    same_sections,
    with_option,
)
from stepramp.controllers.klipper.conversation import Answered, Conversation
from stepramp.controllers.klipper.files import Files
from stepramp.controllers.klipper.machine import PRINTER, Limits, Machine, Senseless
from stepramp.controllers.klipper.options import number, to_write, with_options
from stepramp.controllers.klipper.seen import READY, SHUTDOWN, Seen
from stepramp.controllers.order import lowered_first
from stepramp.errors import DeviceLost, Refused, Rejected, Rejection

AT_RUN_TIME = {"max_accel": "ACCEL", "max_velocity": "VELOCITY"}
"""What SET_VELOCITY_LIMIT calls the options that it sets."""
OTHERS = {"MINIMUM_CRUISE_RATIO": "minimum_cruise_ratio", "SQUARE_CORNER_VELOCITY": "square_corner_velocity"}
"""What it sets besides, as toolhead tells it: saved, and never changed but by a restore."""
STARTED = "it has started with this already"
RESTART_S = 30.0
"""So long Klipper may take to start anew [s]."""


class Memory:
    """The memory of a Klipper as it was last read."""

    def __init__(self, conversation: Conversation) -> None:
        self._conversation = conversation
        self._files = Files(conversation)
        self._loaded: Sections = {}
        """What it has read when it started."""
        self._expected: Sections = {}
        """The same with what was written since over this connection: what its files should say."""
        self._found: Sections | None = None
        """What its files said when they were last read; None before."""
        self._obstacle: Refused | DeviceLost | None = None
        """Why they couldn't be read for a preview; None: they could."""
        self._machine: Machine | None = None
        self._stored: Limits | None = None
        self.version: str | None = None
        self.trouble: str | None = None
        """What it says while it isn't ready; None while it is."""
        self.is_starting = False
        """It starts anew, as it was told here."""
        self.was_halted = False
        """It was shut down from here meanwhile."""

    @property
    def machine(self) -> Machine:
        """Its axes, known once learnt; Refused where nothing that makes sense is told of them."""
        if self._machine is None:
            raise Refused(f"Klipper isn't ready: {self.trouble}")
        return self._machine

    @property
    def knows_axes(self) -> bool:
        """Whether axes are known; what isn't ready may tell of none."""
        return self._machine is not None

    @property
    def stored(self) -> Limits:
        """The limits that its configuration has; Refused as machine."""
        if self._stored is None:
            raise Refused(f"Klipper isn't ready: {self.trouble}")
        return self._stored

    @property
    def awaits_start(self) -> bool:
        """Whether limits of z are stored that hold only once Klipper has started anew."""
        loaded, stored = self.machine.limits, self.stored
        return (loaded.z_velocity, loaded.z_accel) != (stored.z_velocity, stored.z_accel)

    @property
    def homes_by(self) -> Sections:
        """What the places of its axes follow from once they are homed: all that it has loaded but limits."""
        options = {name: each for name, each in self._loaded.get(PRINTER, {}).items() if not name.startswith("max_")}
        return {**self._loaded, PRINTER: options}

    def learn(self) -> None:
        """Read the configuration that it has loaded, or, where it has none, that in its files.

        Raises Refused for one that makes no sense, unless Klipper isn't ready: then a backup may be written again.
        """
        info = self._conversation.ask("printer.info")
        told = info if isinstance(info, dict) else {}
        self.version = str(told.get("software_version", "")) or None
        self.trouble = None if told.get("state") == READY else str(told.get("state_message") or told.get("state"))
        self._files.learn(str(told.get("config_file", "")))
        self._found = self._obstacle = None
        answer = self._conversation.ask("printer.objects.query", {"objects": {"configfile": ["config"]}})
        status = answer.get("status") if isinstance(answer, dict) else None
        known = status.get("configfile") if isinstance(status, dict) else None
        loaded = known.get("config") if isinstance(known, dict) else None
        try:
            self._loaded = self._expected = _sections(loaded) or self._files.configuration()[0].sections
            self._machine = Machine.of(self._loaded)
        except (Senseless, Refused) as error:
            self._machine = self._stored = None
            if self.trouble is None:
                raise Refused(
                    f"Klipper at {self._conversation.name} has axes that can't be used here: {error}."
                ) from error
        else:
            self._stored = self._machine.limits

    def in_use(self, seen: Seen) -> Limits:
        """Return the limits in use: those of z are as loaded."""
        toolhead = seen.toolhead
        return replace(self.machine.limits, velocity=typed(toolhead.max_velocity), accel=typed(toolhead.max_accel))

    def use(self, options: Mapping[str, str]) -> Limits:
        """Set limits at run time, one at a time, and return those in use then; Answered when one is refused."""
        toolhead = self._conversation.last.toolhead
        names = [name for name in options if name in AT_RUN_TIME]
        for name in lowered_first(names, lambda name: float(options[name]) > getattr(toolhead, name)):
            self._limit(AT_RUN_TIME[name], options[name])
        return self.in_use(self._conversation.look())

    def _limit(self, word: str, value: str) -> None:
        """Set a limit at run time. It moves nothing, so no stop waits for it, and none shuts Klipper down for it."""
        self._conversation.script(f"SET_VELOCITY_LIMIT {word}={value}", moves=False)

    def store(self, options: Mapping[str, str]) -> Iterator[str]:
        """Write options to the configuration, read it again, and yield what there is to say.

        Raises Refused when it can't be written, or isn't what was sent.
        """
        configuration, files = self._read()
        sections = configuration.sections
        self._refuse_other(sections, options)
        wanted, remarks = to_write(sections, options)
        places = {name: _place(configuration, name) for name in wanted}
        changed = dict(files)
        # From the last line up: an option that is new moves those below it.
        for name in sorted(wanted, key=lambda name: -_line(places[name])):
            path = places[name].path
            changed[path] = with_option(changed[path], places[name], name, wanted[name])
        to_be = Configuration(changed, self._files.main)
        if to_be.sections != with_options(sections, wanted):
            raise Refused("The configuration can't be written to: its options would not be what is to be sent.")
        yield from self._write(files, changed)
        self._require(to_be)
        self._expected = with_options(self._expected, wanted)
        self._stored = Limits.of(self._expected)
        if not wanted:
            yield "Nothing is written: Klipper's configuration has this already."
        yield from remarks

    def look_at_files(self) -> None:
        """Read the configuration for the next preview, which tells, too, why it can't be read."""
        self._obstacle = None
        try:
            self._read()
        except (Refused, DeviceLost) as error:
            # Files that aren't given don't end a connection over which limits can be tried, and axes moved.
            self._obstacle = error

    def consequences(self, options: Mapping[str, str], seen: Seen) -> Iterator[str]:
        """Yield what storing options would do besides setting them, by the files as they were last read."""
        sections = self._expected if self._found is None else self._found
        try:
            if self._obstacle is not None:
                raise self._obstacle
            self._refuse_other(sections, options)
        except (Refused, DeviceLost) as error:
            yield f"Storing it is refused: {error}"
            return
        wanted, remarks = to_write(sections, options)
        if wanted:
            lines = ", ".join(f"{name}: {value}" for name, value in wanted.items())
            yield f"Storing it writes {lines} to [{PRINTER}] of Klipper's configuration."
        else:
            yield "Storing it writes nothing: Klipper's configuration has this already."
        yield from remarks
        reason = STARTED if self._has_started_with_options(wanted, sections) else self._reason_to_leave(seen, sections)
        if reason is None:
            yield "Storing it restarts Klipper: its axes have to be homed again after that."
        else:
            yield f"Storing it doesn't restart Klipper: {reason}."

    def start_anew(self) -> Iterator[str]:
        """Have Klipper read its configuration, where it has to and that costs nothing, and yield what there is to say.

        A restart switches motors off and forgets where they are. Raises Refused when it doesn't start.
        """
        sections = self._read()[0].sections
        # Last, since files take a while: somebody may have switched motors on, or calibrated something, meanwhile.
        seen = self._conversation.look()
        if self._has_started_with_options({}, sections):
            yield f"Klipper was not restarted: {STARTED}."
            return
        is_busy = seen.is_printing or seen.is_busy
        reason = "it is busy" if is_busy else self._reason_to_leave(seen, sections)
        if reason is not None:
            yield f"Klipper was not restarted, so that it starts with this is known of its file only: {reason}."
            return
        self.is_starting, self.was_halted = True, False
        try:
            is_restarted = self._restart()
        finally:
            self.is_starting = False
        if not is_restarted:
            yield "Klipper refuses to be restarted: that it starts with this is known of its file only."

    def _restart(self) -> bool:
        """Have Klipper start anew, and return whether it was willing to; Refused when it doesn't start."""
        restarts = self._conversation.restarts
        try:
            self._conversation.ask("printer.restart")
        except Answered:
            return False
        try:
            self._await_start(restarts)
        finally:
            # It was told to, and may have said so only by now.
            self._conversation.restarts = 0
        return True

    def _await_start(self, restarts: int) -> None:
        deadline_s = monotonic() + RESTART_S
        while True:
            state = self._conversation.await_ready(restarts, deadline_s)
            try:
                self._learn_anew(state)
            except Answered as error:
                # Moonraker calls it ready a moment earlier than it reaches it, and a moment longer.
                if monotonic() > deadline_s:
                    raise Refused(
                        f"All is written, and Klipper wasn't seen to start with it. {error} See whether it does."
                    ) from error
            else:
                return

    def _learn_anew(self, state: str) -> None:
        """Learn what it has read as it started, by which it came to a state; Refused where that isn't ready."""
        self.learn()
        if state == SHUTDOWN and self.was_halted:
            raise Refused(
                "All is written, and Klipper was halted before it was seen to start with it: say FIRMWARE_RESTART, and "
                "see whether it does."
            )
        if state != READY:
            raise Refused(f"Klipper doesn't start: {self.trouble} Restore a backup of this device.")
        self._conversation.subscribe()

    def everything(self, seen: Seen | None) -> str:
        """Return its configuration's files and the limits in use as text; seen: None for one that isn't ready."""
        limits: dict[str, float] = {}
        if seen is not None:
            told = seen.toolhead
            limits = {word: getattr(told, name) for name, word in AT_RUN_TIME.items()}
            limits |= {word: getattr(told, name) for word, name in OTHERS.items() if getattr(told, name) is not None}
        return Backup(self._files.main, limits, self._files.texts()).text

    def restore(self, backup: Backup, seen: Seen | None) -> Iterator[str]:
        """Write what differs of a backup, and yield what there is to say; seen: as before.

        Rejected for a configuration with which Klipper wouldn't start: that of one that was saved while it didn't; and
        for one that it doesn't read. Refused when it reads something else besides, once all is written.
        """
        if backup.main != self._files.main:
            allowed = f"a backup whose first file is that which Klipper reads, {self._files.main}"
            raise Rejected([Rejection("text", backup.main, allowed)])
        to_be = _sensible(backup)
        present = self._files.present(backup.files)
        is_other = present != backup.files
        if is_other:
            yield from self._write(present, backup.files)
        self._require(to_be)
        if seen is not None:
            for word, value in backup.limits.items():
                self._limit(word, repr(value))
        if is_other:
            self._expected = to_be.sections
            self._stored = Limits.of(self._expected)

    def _write(self, before: Mapping[str, str | None], wanted: Mapping[str, str]) -> Iterator[str]:
        """Write the files that differ, each of them copied first beside it on the printer.

        before: what is in them, None where there is none; one that is missing couldn't be read, and is copied, too.
        """
        others = [path for path, text in wanted.items() if path not in before or before[path] != text]
        # Not .cfg: what is included is mostly all files that end so. To the microsecond: none overwrites another.
        stamp = datetime.now(UTC).strftime("%Y%m%d-%H%M%S-%f")
        copies = {path: f"{path}.stepramp-{stamp}" for path in others if path not in before or before[path] is not None}
        included = paths_of({**dict.fromkeys(copies.values(), ""), **wanted}, self._files.main)
        for path, beside in copies.items():
            if beside in included:
                raise Refused(
                    f"The configuration includes whatever lies beside {path}, so it would include a copy of it, too, "
                    "and nothing is written without. Have it include *.cfg only."
                )
        for path in others:
            if path in copies:
                self._files.copy(path, copies[path])
                yield f"{path} as it was is {copies[path]} on the printer."
            self._files.write(path, wanted[path], before)

    def _require(self, to_be: Configuration) -> None:
        """Refused unless the configuration, now that it is written, says what it was to say."""
        configuration = self._read()[0]
        if configuration.sections == to_be.sections:
            return
        more = ", ".join(path for path in configuration.paths if path not in to_be.paths)
        what = f"it includes {more}, too: take that away" if more else "somebody has changed it meanwhile: look at it"
        raise Refused(f"All is written, but Klipper's configuration says something else: {what} at the printer.")

    def _refuse_other(self, sections: Sections, options: Iterable[str]) -> None:
        """Refuse to change options that somebody else has changed since Klipper started."""
        for name in options:
            there, expected = (each.get(PRINTER, {}).get(name) for each in (sections, self._expected))
            if there != expected:
                raise Refused(
                    f"Klipper goes by {name} {expected}, and its file has {there}: somebody has changed it since it "
                    "started. Say RESTART first."
                )

    def _read(self) -> tuple[Configuration, dict[str, str]]:
        """Return the configuration and its files as they are now."""
        configuration, files = self._files.configuration()
        self._found = configuration.sections
        return configuration, files

    def _has_started_with_options(self, options: Mapping[str, str], sections: Sections) -> bool:
        """Whether Klipper runs with what its files say, once options are written to these sections."""
        return same_sections(self._loaded, with_options(sections, options))

    def _reason_to_leave(self, seen: Seen, sections: Sections) -> str | None:
        """Return why Klipper is not to be restarted while it rests, as the end of a sentence; None when it may be.

        sections: what its files say, but for what is to be written.
        """
        if seen.has_current:
            return "a restart switches the motors off, and they have current"
        if seen.has_unsaved:
            return "it has calibrations that nobody has saved yet (SAVE_CONFIG)"
        for name, options in self._loaded.items():
            if name.startswith("delayed_gcode") and number(options.get("initial_duration", "0")) != 0:
                return f"with [{name}] it carries something out when it starts"
        if not same_sections(sections, self._expected):
            return "its files have been changed since it started, by somebody else"
        return None


def stored_differs(stored: Limits, in_use: Limits) -> bool:
    """Whether limits are in use that a restart would forget."""
    return (stored.velocity, stored.accel) != (in_use.velocity, in_use.accel)


def _sensible(backup: Backup) -> Configuration:
    """Return the configuration of a backup; Rejected when Klipper wouldn't start with it."""
    try:
        configuration = Configuration(backup.files, backup.main)
        Machine.of(configuration.sections)
    except (Senseless, Refused) as error:
        why = str(error).rstrip(".")
        allowed = f"a backup of a configuration that Klipper starts with, which this is not: {why}"
        raise Rejected([Rejection("text", backup.main, allowed)]) from error
    return configuration


def _place(configuration: Configuration, name: str) -> Place:
    place = configuration.place(PRINTER, name)
    if place is None:
        raise Refused("The configuration has no section [printer] that could be written to.")
    return place


def _line(place: Place) -> int:
    return place.header if place.line is None else place.line


def _sections(told: object) -> dict[str, dict[str, str]]:
    """Return a configuration as it is told; nothing for what is none."""
    if not isinstance(told, dict):
        return {}
    return {
        str(name): {str(option): str(value) for option, value in options.items()}
        for name, options in told.items()
        if isinstance(options, dict)
    }
