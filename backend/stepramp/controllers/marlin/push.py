"""Pushing designs to a Marlin: which settings are sent, what came of it, and what of the designs is lost."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

from stepramp.controllers.contract import FigureUnit, OwnTerms, PreviewItem, PushItem, PushPreview, PushReport
from stepramp.controllers.losses import other_scale, slower
from stepramp.controllers.marlin.memory import Figure
from stepramp.controllers.marlin.ramp import marlin_ramp
from stepramp.controllers.marlin.settings import (
    ACCELERATION,
    ACCELERATIONS,
    DECIMALS,
    EXTRUDER,
    HALF_TOLD,
    JERK,
    SPEED,
    STEPS_PER_MM,
    AxisSettings,
    Settings,
    is_rounded,
    is_same,
    most_of,
    shared_by,
)
from stepramp.controllers.order import lowered_first
from stepramp.controllers.per_mm import PerMm
from stepramp.controllers.remark import OnTrial, Remark, of_axes, quantity
from stepramp.design import Design
from stepramp.errors import Count, Refused, Rejected, Rejection

FULL_SPEED, GAIN, SHARED_GAIN = "Full speed", "Acceleration", "Acceleration, for all axes"
NAMES = {SPEED: FULL_SPEED, ACCELERATION: GAIN, ACCELERATIONS: SHARED_GAIN}
VOLATILE = OnTrial("The controller forgets these settings when it is reset or switched off.")
RESTORE = "The settings are not those that were sent. Restore a backup of this device, or push again."


@dataclass(frozen=True)
class Setting:
    """A setting that is sent. kept: as the controller reads it [mm/s, mm/s²]."""

    axis: int
    figure: Figure
    text: str
    kept: Fraction

    @property
    def line(self) -> str:
        """What is sent."""
        code, letter = self.figure
        return f"{code} {letter}{self.text}"


@dataclass(frozen=True)
class PushPlan:
    """What will be sent for designs, by axes."""

    designs: dict[int, Design]
    ramps: dict[int, PerMm]
    scales: Sequence[AxisSettings]
    settings: tuple[Setting, ...]
    lines: Sequence[str]
    """What is sent, in that order."""
    depends_on: Mapping[Figure, Fraction | None]
    """What was there as it was worked out, and makes another plan of another value."""

    @classmethod
    def of(
        cls, designs: Sequence[Design], first_axis: int | None, scales: Sequence[AxisSettings], present: Settings
    ) -> "PushPlan":
        """Return the plan; Rejected for axes that aren't there, and for what Marlin can't take."""
        if first_axis is not None and first_axis >= len(scales):
            raise Rejected([Rejection("to_axis", first_axis, f"an axis of this controller: 0 to {len(scales) - 1}")])
        if len(designs) > len(scales):
            raise Rejected([Rejection("axes", Count(f"{len(designs)} designs"), f"up to {len(scales)} designs")])
        by_axis = {(first_axis or 0) + number: design for number, design in enumerate(designs)}
        ramps = {
            axis: marlin_ramp(
                design, "" if first_axis is not None else f"axes.{axis}.", Fraction(scales[axis].steps_per_mm)
            )
            for axis, design in by_axis.items()
        }
        settings = tuple(_settings(ramps, scales, present))
        sent = (each for each in settings if not _is_there(each, present))
        lines = [each.line for each in lowered_first(sent, lambda each: _is_raised(each, present))]
        depends_on = {figure: present.number(*figure) for axis in by_axis for figure in _sources(scales[axis].letter)}
        return cls(by_axis, ramps, scales, settings, lines, depends_on)

    def refuse_changed(self, present: Settings) -> None:
        """Refused where the settings are no longer those that it was worked out with, as changed at a display."""
        for (code, letter), before in self.depends_on.items():
            now = present.number(code, letter)
            if now != before:
                raise Refused(
                    f"{code} {letter} is {_told(now)}, and was {_told(before)} as this push was worked out: it was "
                    "changed meanwhile, as at the machine. Nothing was sent: look at the preview, and push again."
                )

    @property
    def wanted(self) -> dict[Figure, Fraction]:
        """What is to be read back: what was sent, and the steps per mm that it was worked out with."""
        scales = {(STEPS_PER_MM, self.scales[axis].letter): self.scales[axis].steps_per_mm for axis in self.designs}
        return scales | {each.figure: each.kept for each in self.settings}

    @property
    def bytes(self) -> int:
        """Length of the lines [bytes]."""
        return sum(len(line) + 1 for line in self.lines)

    def report(self, read_back: Settings, remarks: Sequence[str], *, verified: bool, kept: bool) -> PushReport:
        """Return what came of the push. remarks: what else there is to say."""
        return PushReport(
            items=tuple(self._items(read_back)),
            verified=verified,
            segments=None,
            bytes=self.bytes,
            largest_deviation_us=None,
            sequence=None,
            kept=kept,
            warnings=(*self._losses(read_back), *remarks),
        )

    def preview(self, present: Settings) -> PushPreview:
        """Return what the push would change of the settings as they were last read."""
        items = tuple(
            PreviewItem(each.name, each.unit, each.read_back, each.sent, each.axis, each.own)
            for each in self._items(present)
        )
        return PushPreview(
            items=items,
            same=not any(item.differs for item in items),
            segments=None,
            bytes=self.bytes,
            largest_deviation_us=None,
            warnings=tuple(self._losses(present)),
        )

    def _items(self, present: Settings) -> Iterator[PushItem]:
        for each in self.settings:
            code, letter = each.figure
            scale, ramp = self.scales[each.axis].steps_per_mm, self.designs[each.axis].ramp
            told = present.number(code, letter)
            # What is told the same is shown as the same: it lists two decimals.
            there = each.kept if is_same(told, each.kept) else told
            unit: FigureUnit = "steps/s" if code == SPEED else "steps/s²"
            asked = ramp.slew_speed_steps_per_s if code == SPEED else float(slower(self.designs[each.axis]))
            own = OwnTerms(
                f"{code} {letter}",
                "mm/s" if code == SPEED else "mm/s²",
                float(each.text),
                None if told is None else round(float(told), 2),
            )
            yield PushItem(
                NAMES[code],
                unit,
                asked,
                float(each.kept * scale),
                None if there is None else float(there * scale),
                each.axis,
                own,
            )

    def _losses(self, present: Settings) -> Iterator[str]:
        losses = dict[int, list[str]]()
        for axis, design in self.designs.items():
            letter, scale = self.scales[axis].letter, self.scales[axis].steps_per_mm
            kept = self.ramps[axis].ramp_losses(design)
            losses[axis] = [*kept, *other_scale(design, "Marlin", scale), *_jerk(present, letter, scale)]
        yield from of_axes(losses)
        for axis in self.designs:
            if is_rounded(scale := self.scales[axis].steps_per_mm):
                yield _rounded_scale(self.scales[axis].letter, scale)
        for each in self.settings:
            code, letter = each.figure
            if code == ACCELERATIONS and letter != shared_by(EXTRUDER) and each.line in self.lines:
                yield (
                    f"M204 {letter} is raised to {each.text} mm/s²: it holds for all axes, each of which keeps its own "
                    "M201."
                )


def _settings(ramps: dict[int, PerMm], scales: Sequence[AxisSettings], present: Settings) -> Iterator[Setting]:
    """Yield what an axis is to have.

    An axis gains speed no faster than M204 says; the extruder on its own gains it as that says, whatever its limit is.
    Where it is what is asked already by that, M201 is left: it is another limit when the axis moves with others.
    """
    shared = _shared(ramps, scales, present)
    for axis, ramp in ramps.items():
        letter, gain = scales[axis].letter, ramp.terms.kept(ramp.acceleration)
        figure = (ACCELERATIONS, shared_by(letter))
        limit = shared[figure].kept if figure in shared else present.number(*figure)
        now = scales[axis].effective_acceleration
        later = replace(scales[axis], shared_acceleration=limit).effective_acceleration
        if is_same(now, gain) and is_same(later, gain) and not is_same(scales[axis].acceleration, gain):
            if figure not in shared:
                yield Setting(axis, figure, ramp.acceleration, gain)
        else:
            yield Setting(axis, (ACCELERATION, letter), ramp.acceleration, gain)
        yield Setting(axis, (SPEED, letter), ramp.speed, ramp.terms.kept(ramp.speed))
    yield from shared.values()


def _shared(ramps: dict[int, PerMm], scales: Sequence[AxisSettings], present: Settings) -> dict[Figure, Setting]:
    """Return what M204 is to be where it isn't enough, or is the extruder's own."""
    shared: dict[Figure, Setting] = {}
    for axis, ramp in ramps.items():
        letter, gain = scales[axis].letter, ramp.terms.kept(ramp.acceleration)
        figure = (ACCELERATIONS, shared_by(letter))
        told = present.number(*figure)
        is_needed = told is not None and not is_same(told, gain) and (letter == EXTRUDER or told < gain)
        if is_needed and (figure not in shared or shared[figure].kept < gain):
            shared[figure] = Setting(axis, figure, ramp.acceleration, gain)
    return shared


def _is_there(setting: Setting, present: Settings) -> bool:
    """Tell whether it is one of M204 that holds already."""
    return setting.figure[0] == ACCELERATIONS and is_same(present.number(*setting.figure), setting.kept)


def _rounded_scale(letter: str, scale: Fraction) -> str:
    return (
        f"M92 {letter} is told as {float(scale):.{DECIMALS}f}, rounded: speed and acceleration are sent for up to "
        f"{float(most_of(scale)):.7g} steps/mm. Ways of {math.ceil(scale / (2 * HALF_TOLD)):,} steps or more may come "
        "out a step short or long."
    )


def _sources(letter: str) -> Iterator[Figure]:
    """Yield what the settings that are sent to an axis depend on."""
    yield STEPS_PER_MM, letter
    yield ACCELERATION, letter
    yield ACCELERATIONS, shared_by(letter)


def _told(value: Fraction | None) -> str:
    return "not told" if value is None else f"{float(value):,.7g}"


def _is_raised(setting: Setting, present: Settings) -> bool:
    told = present.number(*setting.figure)
    return told is not None and setting.kept > told


def _jerk(present: Settings, letter: str, scale: Fraction) -> Iterator[str]:
    """Yield with which speed a move begins where jerk is built in."""
    jerk = present.number(JERK, letter)
    if jerk:
        yield Remark(
            f"M205 {letter}{float(jerk):g}: a move begins at up to ", quantity(float(jerk * scale), "steps/s"),
            " at once, without a ramp.",
        )  # fmt: skip
