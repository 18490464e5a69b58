"""Which firmware a grbl runs."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

from stepramp.errors import Refused

_VERSION = re.compile(r"\[VER:(?P<version>[^.:\]]+\.[^.:\]]+)[.:][^\]]*\]")
_SUPPORTED = re.compile(r"1\.1\w?")


@dataclass(frozen=True)
class Identity:
    """What it says of itself after $I."""

    version: str
    is_hal: bool

    @classmethod
    def of(cls, said: Sequence[str], port_name: str) -> Self:
        """Return it; Refused for another firmware."""
        found = next((each["version"] for each in map(_VERSION.fullmatch, said) if each is not None), "")
        cls.refuse_other(found, " ".join(said), port_name)
        return cls(found, any("FIRMWARE:grblHAL" in line for line in said))

    @staticmethod
    def refuse_other(version: str, rest: str, port_name: str) -> None:
        """Refuse a firmware that is no grbl 1.1, by its version and what else it says."""
        if "fluidnc" in rest.lower():
            raise Refused(f"FluidNC is at {port_name}, which is another family than grbl.")
        if not _SUPPORTED.fullmatch(version):
            raise Refused(
                f"What is at {port_name} is no grbl 1.1 but {version or 'of a version that it does not tell'}: older "
                "ones have no jogs that can be stopped."
            )
