"""Why there is no talking with what is at a port, in words for people."""

from stepramp.errors import DeviceLost, Refused


def nobody(port: str, *, has_heard: bool) -> Refused | DeviceLost:
    """Return what is raised where no Marlin has told who it is."""
    if has_heard:
        return Refused(f"Something talks at {port}, but it is no Marlin, or its baud rate is another one.")
    return DeviceLost(
        f"Nothing answers at {port} as Marlin does: has it power, is its baud rate that of the family named? "
        "A controller of another family is to be connected as that."
    )


def busy(port: str) -> Refused:
    """Return what is raised where it says that it is busy, and nothing else."""
    return Refused(
        f"What is at {port} says that it is busy, as a Marlin does while it heats: connect it once that is done."
    )


def silent(port: str) -> DeviceLost:
    """Return what is raised where no answer has come, however often it was asked for."""
    return DeviceLost(f"The controller at {port} does not answer.")


def halted(port: str) -> DeviceLost:
    """Return what is raised where it takes nothing more until it is reset."""
    return DeviceLost(f"The controller at {port} has halted: reset it at the machine, then connect again.")


def no_axes(port: str) -> Refused:
    """Return what is raised where it counts the steps of motors that aren't its axes."""
    return Refused(
        f"The Marlin at {port} doesn't count the steps of X, Y and Z: motors of a delta or a CoreXY move several axes, "
        "and are not moved here."
    )
