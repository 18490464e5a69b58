"""What is said of axes that have come to rest elsewhere than they were sent to, and why that may be."""

from collections.abc import Mapping, Sequence

from stepramp.controllers.marlin.settings import DECIMALS, AxisSettings, is_rounded


def off_target(
    targets: Mapping[int, int], rests: Sequence[int], starts: Mapping[int, int], scales: Sequence[AxisSettings]
) -> str | None:
    """Return it as a sentence or two; None where all are where they were sent to.

    targets: by axis. rests: where all axes rest. starts: where they set out from [steps].
    """
    off = {axis: target for axis, target in targets.items() if rests[axis] != target}
    if not off:
        return None
    too_far = {axis for axis, target in off.items() if (rests[axis] - target) * (target - starts[axis]) > 0}
    told = ", ".join(
        f"{scales[axis].letter} {abs(target - rests[axis]):,} steps{' too far' if axis in too_far else ''}"
        for axis, target in off.items()
    )
    where = "elsewhere than at" if too_far else "short of"
    rounded = ", ".join(
        f"{scale.letter} {float(scale.steps_per_mm):.{DECIMALS}f}"
        for scale in (scales[axis] for axis in off)
        if is_rounded(scale.steps_per_mm)
    )
    why = f" Or it has other steps per mm than it tells (M92), rounded to two decimals: {rounded}." if rounded else ""
    return (
        f"The controller rests {where} its target: {told}. Marlin leaves out ways of fewer than 6 steps "
        "(MIN_STEPS_PER_SEGMENT) until the next one, and what leads beyond its soft limits (M211); or an endstop was "
        f"hit.{why}"
    )
