"""Motions: what axes are told to do, each checked against what is known of them at the instant when they set out."""

from collections.abc import Collection, Mapping, Sequence

from stepramp.controllers.capabilities import DrawsLines, ZeroesGauges
from stepramp.controllers.contract import AxisCommand, Controller
from stepramp.devices.contact import Contact
from stepramp.devices.control import Control
from stepramp.devices.leases import Lease, Leases
from stepramp.devices.limit_checks import (
    refuse_absent,
    refuse_limited,
    refuse_outward,
    refuse_running,
    refuse_targets,
)
from stepramp.devices.live_view import LiveView
from stepramp.devices.permit import LetGo
from stepramp.devices.setting_out import SettingOut
from stepramp.devices.soft_limits import Span
from stepramp.devices.view import DeviceState
from stepramp.devices.watch import Watch
from stepramp.errors import Refused

GIVEN_UP = "The run was given up: it was not told to go on in time, and has slowed down. Begin it again."


class Motions:
    """Moves the axes of a device, and says where they are. From any thread; see Device for what each call does."""

    def __init__(
        self,
        view: LiveView,
        contact: Contact,
        watch: Watch,
        leases: Leases,
        control: Control,
        setting_out: SettingOut,
    ) -> None:
        self._view = view
        self._contact = contact
        self._watch = watch
        self._leases = leases
        self._control = control
        self._setting_out = setting_out

    def move_by(self, steps: Sequence[AxisCommand], request_number: int | None) -> None:
        """Begin to move axes by so many steps."""

        def begin(controller: Controller) -> None:
            refuse_running(self._view.now, self._leases.speeds, steps)
            refuse_targets(self._view.now, steps, relative=True)
            controller.move_by(steps)

        self._setting_out.begin(f"move by {_told(steps)}", _axes_of(steps), begin, request_number)

    def move_to(self, positions: Sequence[AxisCommand], request_number: int | None) -> None:
        """Begin to move axes to positions [steps]."""

        def begin(controller: Controller) -> None:
            refuse_targets(self._view.now, positions, relative=False)
            controller.move_to(positions)

        self._setting_out.begin(f"move to {_told(positions)}", _axes_of(positions), begin, request_number)

    def line(self, steps: Sequence[AxisCommand], ramp_axis: int | None, request_number: int | None) -> None:
        """Begin to move axes along a straight line."""

        def begin(controller: Controller) -> None:
            able = self._contact.capable(controller, DrawsLines)
            refuse_targets(self._view.now, steps, relative=True)
            able.line(steps, ramp_axis)

        self._setting_out.begin(f"line by {_told(steps)}", _axes_of(steps), begin, request_number)

    def run(self, speeds: Sequence[AxisCommand], lease: Lease, request_number: int | None) -> None:
        """Run axes at speeds [steps/s] as long as a lease holds."""

        def begin(controller: Controller) -> None:
            self._control.refuse_without(lease.page)
            if not lease.holds:
                raise LetGo
            refuse_outward(self._view.now, speeds, controller.steps_to_rest)
            spans = self._view.now.soft_limits
            controller.keep_within({axis: (span.lowest_steps, span.highest_steps) for axis, span in spans.items()})
            controller.run(speeds)

        self._setting_out.begin(f"run at {_told(speeds)}", _axes_of(speeds), begin, request_number, lease)

    def renew_run(self, lease: Lease, request_number: int | None) -> None:
        """Let a run go on, as long from now as a new lease of the same name and speeds lasts.

        Nothing is sent, and what has run out isn't brought back: who was silent for so long finds the motor at rest.
        """

        def renew(_: Controller) -> None:
            self._control.refuse_without(lease.page)
            held = self._leases.named(lease.name, lease.speeds)
            runs = {axis.axis for axis in self._view.now.axes if axis.state is DeviceState.MOVING}
            if held is None or not runs.issuperset(held.speeds) or not held.renew(lease.lasts_s):
                raise Refused(GIVEN_UP)

        self._setting_out.go_on(renew, request_number)

    def zero(self, axes: Collection[int], steps: int, request_number: int | None) -> None:
        """Call the places where axes are so many steps and move them to 0."""

        def begin(controller: Controller) -> None:
            able = self._contact.capable(controller, ZeroesGauges)
            refuse_limited(self._view.now, axes)
            able.zero(axes, steps)

        what = f"zero from {steps} steps on: axes {sorted(axes)}"
        self._setting_out.begin(what, axes, begin, request_number, then=lambda: self._zero(axes))

    def set_position(self, positions: Sequence[AxisCommand]) -> None:
        """Call the places where axes are these positions [steps]. Nothing moves."""
        axes = _axes_of(positions)

        def set_position(controller: Controller) -> None:
            self._setting_out.newly(
                axes, lambda: controller.set_position(positions), then=lambda: self._know_positions(axes)
            )

        self._contact.ask(set_position)

    def limit(self, spans: Mapping[int, Span]) -> None:
        """Keep these axes within soft limits from now on. Nothing moves."""

        def limit(_: Controller) -> None:
            # Those that were shown to whoever asked.
            shown = self._view.now.axes
            self._watch.refuse_under_way()
            refuse_absent(self._view.now, spans)
            self._view.change(lambda view: view.limited(spans, shown))
            # What was said of those before doesn't hold any more.
            self._watch.refresh()

        self._contact.ask(limit)

    def _zero(self, axes: Collection[int]) -> None:
        # Looked at once more: a short way may be over already.
        self._view.change(lambda view: view.with_zeroing(axes))
        self._watch.refresh()

    def _know_positions(self, axes: Collection[int]) -> None:
        self._view.change(lambda view: view.with_known_positions(axes))


def _told(commands: Sequence[AxisCommand]) -> str:
    return ", ".join(f"{each.value:.15g} (axis {each.axis})" for each in commands)


def _axes_of(commands: Sequence[AxisCommand]) -> list[int]:
    return [each.axis for each in commands]
