"""FluidNC: an axis's items of its YAML configuration."""

from stepramp.controllers.fluidnc.ramp import fluidnc_ramp
from stepramp.controllers.given_numbers import steps_per_unit, typed
from stepramp.controllers.losses import slower
from stepramp.design import Design
from stepramp.exports.machines.sheet import AxisLetter, Setting, Sheet, commented


def fluidnc_items(design: Design, letter: AxisLetter) -> Sheet:
    """Return an axis's items; raises Rejected for what FluidNC can't take."""
    given = fluidnc_ramp(design)
    per_minute = given.scale / given.terms.seconds
    settings = (
        Setting("steps_per_mm", "steps/mm", float(steps_per_unit(design.axis)), given.steps_per_mm),
        Setting(
            "max_rate_mm_per_min",
            "mm/min",
            float(typed(design.ramp.slew_speed_steps_per_s) / per_minute),
            given.speed,
        ),
        Setting("acceleration_mm_per_sec2", "mm/s²", float(slower(design) / given.scale), given.acceleration),
    )
    axis = letter.lower()
    lines = ["axes:", f"  {axis}:", *(f"    {each.name}: {each.sent}" for each in settings)]
    about = (
        f"Items of FluidNC's configuration: put them in the place of those of axis {axis}, and keep the file as it "
        f"was. Until a restart the same is tried by lines such as $/axes/{axis}/{settings[-1].name}={settings[-1].sent}"
    )
    remarks = tuple(given.losses(design))
    return Sheet(commented(design, "#", about, remarks, lines), settings, remarks)
