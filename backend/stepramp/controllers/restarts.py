"""What is said of a controller that has started anew by itself."""

from stepramp.errors import DeviceLost


def restarted(port: str, *, is_connecting: bool) -> DeviceLost:
    """Return what is raised where it has started anew; is_connecting: again, before it was known at all."""
    if is_connecting:
        return DeviceLost(
            f"The controller at {port} started anew again while it was being connected. Connect it once more; if it "
            "does so each time, it keeps restarting: look at its power supply, its cable, and what resets it."
        )
    return DeviceLost(f"The controller at {port} was restarted: its position is no longer known.")
