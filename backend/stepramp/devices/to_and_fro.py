"""To and fro: an axis goes there and back by itself, one leg after the other."""

from dataclasses import replace

from stepramp.controllers.contract import AxisCommand, Controller
from stepramp.devices.contact import Contact
from stepramp.devices.control import Control
from stepramp.devices.limit_checks import refuse_targets, refuse_there_and_back
from stepramp.devices.live_view import LiveView
from stepramp.devices.setting_out import SettingOut
from stepramp.devices.shuttle import Shuttle
from stepramp.devices.stops import Overtaken, Stops
from stepramp.devices.view import DeviceState
from stepramp.devices.watch import Watch
from stepramp.errors import Refused, Rejected


class ToAndFro:
    """Begins each leg of a shuttle, until it is done or something else comes."""

    def __init__(
        self, view: LiveView, contact: Contact, watch: Watch, control: Control, setting_out: SettingOut, stops: Stops
    ) -> None:
        self._view = view
        self._contact = contact
        self._watch = watch
        self._control = control
        self._setting_out = setting_out
        self._stops = stops

    def begin(self, shuttle: Shuttle, leg: AxisCommand, request_number: int | None = None) -> None:
        """Set out on the first leg; see Device.go_there_and_back. From any thread."""
        shuttle = replace(shuttle, request_number=self._setting_out.moment(request_number))

        def begin(controller: Controller) -> None:
            self._control.refuse_without(shuttle.page)
            self._watch.refuse_under_way()
            refuse_there_and_back(self._view.now, leg)
            controller.move_by([leg])

        what = f"go there and back by {leg.value:.15g} (axis {leg.axis})"
        self._setting_out.begin(
            what, [shuttle.axis], begin, shuttle.request_number, then=lambda: self._show_leg(shuttle)
        )

    # From here on: in the thread of the port.

    def go_on(self) -> None:
        """Set out on the next leg, there or back, once the pause is over; it ends when it rests elsewhere."""
        view = self._view.now
        if view.shuttle is None or view.state is not DeviceState.READY:
            return
        shuttle = view.shuttle.arrived()
        if shuttle.ended or self._target_steps(shuttle.axis) != shuttle.expected_steps:
            self._show(None)
        elif shuttle.is_due():
            self._begin_leg(shuttle)
        else:
            self._show(shuttle)

    def _begin_leg(self, shuttle: Shuttle) -> None:
        controller, leg = self._contact.controller, AxisCommand(shuttle.axis, shuttle.next_by_steps, "by_steps")
        try:
            self._control.refuse_without(shuttle.page)
        except Refused:
            self._show(None)
            return
        try:
            refuse_targets(self._view.now, [leg], relative=True)
            self._setting_out.again([shuttle.axis], shuttle.request_number, lambda: controller.move_by([leg]))
        except Overtaken:
            self._show(None)
        except (Refused, Rejected) as error:
            self._end(error)
        else:
            self._show_leg(shuttle)

    def _end(self, error: Refused | Rejected) -> None:
        """End it by what it was refused, and show that: nobody waits for an answer who could be told."""
        self._view.change(lambda view: replace(view, shuttle=None, ended_by=error))
        self._watch.refresh()

    def _show_leg(self, shuttle: Shuttle) -> None:
        """Note where the leg leads that has just been begun, unless it has been stopped meanwhile."""
        if not self._stops.have_overtaken(shuttle.request_number):
            self._show(shuttle.set_out(self._target_steps(shuttle.axis)))

    def _show(self, shuttle: Shuttle | None) -> None:
        self._view.change(lambda view: replace(view, shuttle=shuttle))

    def _target_steps(self, axis: int) -> int:
        return self._view.now.axes[axis].target_steps
