"""A stop of what is at a port, without a server, once all that knows its family is loaded."""

from pathlib import Path

from stepramp.command_line.in_process import ports_of
from stepramp.command_line.stop import places_of
from stepramp.devices.registry import Devices


def stop_at(port: str, family: str, *, halt: bool = False, data: Path | None = None) -> str:
    """Connect to a port, have what is there stop, and return what is told of that. Raises as Devices.connect."""
    devices = Devices(remote_ports=ports_of(port), data=data)
    try:
        device = devices.connect(port, family)
        (device.halt if halt else device.stop)().result()
        axes = device.view.axes
        places = places_of((axis.axis, axis.position_steps if axis.position_told else None) for axis in axes)
        return f"Stopped: {port}{places}."
    finally:
        devices.close()
