"""Homing: axes find their limit switches, and their places are called what was asked once they have."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from stepramp.controllers.capabilities import HasInputs
from stepramp.controllers.contract import AxisCommand, Controller
from stepramp.devices.contact import Contact
from stepramp.devices.control import Control
from stepramp.devices.leases import Lease, Leases
from stepramp.devices.live_view import LiveView
from stepramp.devices.permit import LetGo
from stepramp.devices.setting_out import SettingOut
from stepramp.devices.view import AxisView, DeviceState
from stepramp.devices.watch import Watch
from stepramp.errors import Refused, Rejected


@dataclass(frozen=True)
class Homing:
    """How axes are to find their switches."""

    fast: Sequence[AxisCommand]
    """Towards which, and how fast, negative for backwards [steps/s]."""
    slow: AxisCommand
    """How fast they come back, without sign; of all [steps/s]."""
    back_off_steps: int
    positions_steps: Mapping[int, int]
    """What the place is to be called that each finds."""

    @property
    def axes(self) -> list[int]:
        """Which axes."""
        return [each.axis for each in self.fast]


class Homings:
    """Homes axes of a device on a lease, and takes its motions up again after an emergency stop. From any thread.

    Soft limits don't hold meanwhile: where they are isn't known before the switch is found.
    """

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

    def begin(self, homing: Homing, lease: Lease, request_number: int | None) -> None:
        """Have axes set out to their switches; see Device.home."""

        def begin(controller: Controller) -> None:
            able = self._contact.capable(controller, HasInputs)
            self._control.refuse_without(lease.page)
            if not lease.holds:
                raise LetGo
            able.home(homing.fast, homing.slow, homing.back_off_steps)

        self._setting_out.begin(
            f"home axes {sorted(homing.axes)}",
            homing.axes,
            begin,
            request_number,
            lease,
            then=lambda: self._view.change(lambda view: view.with_homing(homing.positions_steps)),
        )

    def acknowledge(self, request_number: int | None) -> None:
        """Let motions be taken again after an emergency stop or a driver's fault; see Device.acknowledge."""
        at = self._setting_out.moment(request_number)

        def acknowledge(controller: Controller) -> None:
            able = self._contact.capable(controller, HasInputs)
            self._setting_out.allow(at, able.acknowledge)

        self._contact.ask(acknowledge)
        self._view.log("acknowledged: motions are taken again")

    # From here on: in the thread of the port.

    def go_on(self) -> None:
        """Once axes are homed, or have given that up, their leases end, and their places get their names.

        Only the controller knows whether one was stopped before its end, so stops change nothing here.
        """
        view = self._view.now
        over = [axis for axis in view.axes if axis.axis in view.after_homing and not axis.homing]
        if not over:
            return
        self._leases.drop(axis.axis for axis in over)
        # Another name than 0 is taken only while all rest; what was found stays counted until then.
        waits = {axis.axis for axis in over if axis.counts_from_known and view.after_homing[axis.axis]}
        is_at_rest = all(axis.state is DeviceState.READY for axis in view.axes)
        settled = [axis for axis in over if axis.axis not in waits or is_at_rest]
        if homed := [axis for axis in settled if axis.counts_from_known]:
            self._name(homed)
        if settled:
            self._view.change(lambda view: view.without_homing([axis.axis for axis in settled]))
            self._watch.refresh()

    def _name(self, homed: Sequence[AxisView]) -> None:
        # A switch stops an axis some steps beyond the place that it finds: those stay counted.
        called = self._view.now.after_homing
        renamed = [
            AxisCommand(axis.axis, called[axis.axis] + axis.position_steps, "position_steps")
            for axis in homed
            if called[axis.axis]
        ]
        try:
            if renamed:
                self._contact.controller.set_position(renamed)
        except (Refused, Rejected) as refused:
            # Where they are stays unknown then.
            self._view.log("homed, but not called %s: %s", dict(called), refused)
            return
        self._view.change(lambda view: view.with_known_positions([axis.axis for axis in homed]))
        self._view.log("homed: axes %s", [axis.axis for axis in homed])
