"""A family of controllers that can do no more than all can, at a connection that is no serial port."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence

from stepramp.controllers.contract import (
    Activity,
    AxisCommand,
    AxisStatus,
    Controller,
    ControllerStatus,
    PushMode,
    PushPreview,
    PushReport,
)
from stepramp.controllers.families import Family
from stepramp.controllers.progress import Tell
from stepramp.design import Design
from stepramp.link.connection import Connection
from stepramp.link.remote_ports import RemotePorts
from stepramp.link.serial_port import NO_REMOTE_PORTS


class NoWire:
    """A connection over which nothing goes."""

    def __init__(self, name: str, _: Callable[[], None], __: RemotePorts = NO_REMOTE_PORTS) -> None:
        self.name = name

    def write(self, data: bytes) -> None:
        raise AssertionError(f"{data!r} was sent")

    def read(self, timeout_s: float) -> bytes:
        raise AssertionError(f"read for {timeout_s} s")

    def pending(self) -> bytes:
        return b""

    def close(self) -> None:
        pass


class PlainController(Controller):
    """One axis that is where it was sent at once. asked: what was asked of it, in that order. It tells its trouble."""

    def __init__(self, connection: Connection, _give_way: Callable[[float], None], _tell: Tell) -> None:
        self.connection = connection
        self.asked: list[str] = []
        self.trouble: str | None = None
        self._position = 0

    @property
    def clocks_hz(self) -> tuple[int, ...]:
        return ()

    @property
    def timer_hz(self) -> int | None:
        return None

    @property
    def most_axes(self) -> int:
        return 1

    @property
    def firmware_version(self) -> str | None:
        return None

    def connect(self, greeted: Callable[[], None] = lambda: None) -> None:
        greeted()

    def disconnect(self) -> None:
        self.asked.append("disconnect")

    def status(self) -> ControllerStatus:
        axis = AxisStatus(0, Activity.READY, self._position, self._position, 0.0, 0)
        return ControllerStatus(Activity.READY, (axis,), None, on_trial=False, motors_on=True, trouble=self.trouble)

    def listen(self) -> ControllerStatus | None:
        return None

    def prepare_push(
        self, designs: Sequence[Design], first_axis: int | None = None, mode: PushMode = "keep"
    ) -> Callable[[], PushReport]:
        raise AssertionError(f"{len(designs)} designs for axis {first_axis} to {mode}")

    def preview_push(self, designs: Sequence[Design], first_axis: int | None = None) -> PushPreview:  # noqa: ARG002
        return PushPreview((), same=False, segments=None, bytes=8, largest_deviation_us=None, warnings=())

    def move_by(self, steps: Sequence[AxisCommand]) -> None:
        self.asked.append("move_by")
        self._position += int(steps[0].value)

    def move_to(self, positions: Sequence[AxisCommand]) -> None:
        self.asked.append("move_to")
        self._position = int(positions[0].value)

    def run(self, speeds: Sequence[AxisCommand]) -> None:
        self.asked.append(f"run at {speeds[0].value}")

    def set_position(self, positions: Sequence[AxisCommand]) -> None:
        self.asked.append("set_position")
        self._position = int(positions[0].value)

    def stop(self, axes: Collection[int] | None = None) -> None:
        self.asked.append(f"stop {axes}")

    def halt(self, axes: Collection[int] | None = None) -> None:
        self.asked.append(f"halt {axes}")

    def steps_to_rest(self, axis: int, speed_steps_per_s: float) -> int:  # noqa: ARG002
        return 0


PLAIN = Family("plain", "Plain", NoWire, PlainController)
