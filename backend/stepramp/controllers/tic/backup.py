"""A backup of a Tic: all settings that it keeps, as a settings file, and what it had in use, as comments of that."""

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from stepramp.controllers.tic.products import CODES, HP_NOT_READ, PRODUCTS
from stepramp.controllers.tic.ramp import TicRamp
from stepramp.controllers.tic.read_settings import (
    FIGURES,
    IN_USE,
    NEEDED,
    in_use_by,
    microsteps_told,
    ramp_told,
    told_by,
)
from stepramp.controllers.tic.settings import COMMON, END, FIRST, UNHEEDED, Settings
from stepramp.errors import Count, Rejected, Rejection

ALLOWED = "a backup of a Tic, or its settings file: lines 'max_speed: …' and 'max_accel: …'"
ABOUT = f"""\
# All settings that a Pololu Tic keeps, as far as its serial port tells them, in the lines of ticcmd --get-settings. It
# doesn't tell which product it is, and ticcmd --settings FILE and the Tic Control Center refuse a file without that. So
# take the mark of your product, such as '#T825 ', away from all lines that begin with it, in a copy of this file.
# What a file lacks they set as with a new Tic. This one lacks {", ".join(HP_NOT_READ)} of a 36v4.
"""
LINE_BYTES = 16
_BYTES = re.compile(r"# stored (?P<start>[0-9a-f]{2}):(?P<bytes>(?: (?:[0-9a-f]{2}|--))+)")
NOT_TOLD = "--"
"""In the place of a byte."""
WRITTEN_BY = "ticcmd --settings FILE or the Tic Control Center writes them."
SAME_AS = {"full": "1", "half": "2"}
"""Words of a settings file that say the same as those which ticcmd writes …"""
FORMERLY = {"serial_crc_enabled": "serial_crc_for_commands"}
"""… and names."""


def backup_text(settings: Settings, in_use: Mapping[str, str]) -> str:
    """Return a backup of what a Tic keeps, and has in use."""
    lines = [*_common_lines(settings), *_product_lines(settings)]
    lines += [f"{IN_USE}{name}: {value}" for name, value in in_use.items()]
    lines += _byte_lines(settings)
    return ABOUT + "\n".join(lines) + "\n"


def _common_lines(settings: Settings) -> Iterator[str]:
    for each in COMMON:
        value, number = settings.value(each), settings.number(each)
        if value is not None:
            yield f"{each.name}: {value}"
        else:
            yield f"# {each.name} isn't told" if number is None else f"# {each.name} is {number}, without a word for it"


def _product_lines(settings: Settings) -> Iterator[str]:
    for product, differing in PRODUCTS.items():
        told = {"product": product, **settings.told(differing)}
        yield from (f"#{product} {name}: {value}" for name, value in told.items())


def _byte_lines(settings: Settings) -> Iterator[str]:
    """Yield every byte, since a settings file leaves out what no firmware heeds, and bits that are of no use."""
    told = {address: f"{byte:02x}" for address, byte in settings.bytes.items()}
    for start in range(FIRST, END, LINE_BYTES):
        row = (told.get(each, NOT_TOLD) for each in range(start, min(start + LINE_BYTES, END)))
        yield f"# stored {start:02x}: {' '.join(row)}"


@dataclass(frozen=True)
class Backup:
    """What a text tells."""

    ramp: TicRamp
    microsteps: int | None
    """None: it isn't told."""
    stored: Mapping[str, str]
    """What the Tic had stored, by name; {} with backups of older versions that have the ramp in use only."""
    product: str | None
    kept: Settings
    """The same byte by byte, as far as it is told so."""

    @classmethod
    def of(cls, text: str) -> "Backup":
        """Return it; Rejected for a text that is none, or tells a ramp that no Tic can have."""
        told, in_use = told_by(text), in_use_by(text)
        if not told.keys() >= NEEDED:
            reason = f"This is no backup of a Tic, and none of its settings files; allowed: {ALLOWED}."
            raise Rejected([Rejection("text", Count(f"{len(text.splitlines()):,} lines"), ALLOWED, reason=reason)])
        product = told.pop("product", None)
        used = told | in_use
        kept = _bytes_by(text)
        # Their lines say what was in use.
        is_older = not in_use and product is None and told.keys() <= {*FIGURES, "step_mode"}
        stored = kept.told(COMMON) if is_older else told
        return cls(ramp_told(used), microsteps_told(used), stored, product, kept)

    def left(self, microsteps: int, now: Settings) -> Iterator[str]:
        """Yield what can't be written, as sentences. microsteps: what the Tic makes of a full step."""
        if self.microsteps not in (None, microsteps):
            yield (
                f"The step mode is not as in the backup: it makes {microsteps} of a full step, in the backup "
                f"{self.microsteps}. The Tic Control Center sets it."
            )
        present = now.told((*COMMON, *UNHEEDED, *PRODUCTS.get(self.product or "", ())))
        if differing := [*self._differing(present), *self._differing_codes(now)]:
            yield (
                "The Tic keeps other settings than in the backup, of which its serial port writes none: "
                f"{', '.join(differing)}. {WRITTEN_BY}"
            )
        unseen = [f"{name} {value}" for name, value in self.stored.items() if FORMERLY.get(name, name) not in present]
        if unseen:
            yield f"What a Tic's serial port doesn't tell can't be compared: {', '.join(unseen)}. {WRITTEN_BY}"

    def _differing(self, present: Mapping[str, str]) -> Iterator[str]:
        for name, value in self.stored.items():
            now = present.get(FORMERLY.get(name, name))
            if now is not None and _words(now) != _words(value):
                yield f"{name} {now} (in the backup {value})"

    def _differing_codes(self, now: Settings) -> Iterator[str]:
        """Yield what a settings file leaves out, and what means something else with each product until that is told."""
        for each in (*UNHEEDED, *(CODES if self.product is None else ())):
            was, number = self.kept.number(each), now.number(each)
            if was is not None and number is not None and was != number:
                yield f"{each.name} {each.told(number)} (in the backup {each.told(was)})"


def _bytes_by(text: str) -> Settings:
    rows = filter(None, map(_BYTES.fullmatch, (line.strip() for line in text.splitlines())))
    told = ((int(row["start"], 16), row["bytes"].split()) for row in rows)
    return Settings(
        {start + place: int(byte, 16) for start, row in told for place, byte in enumerate(row) if byte != NOT_TOLD}
    )


def _words(value: str) -> set[str]:
    """Return what a value says, in whichever order."""
    return {SAME_AS.get(each, each) for each in value.split()}
