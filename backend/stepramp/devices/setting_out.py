"""Setting out: how anything that moves a motor begins, and what ends by that."""

from collections.abc import Callable, Collection, Iterator
from contextlib import contextmanager
from dataclasses import replace
from time import monotonic

from stepramp.controllers.contract import Controller
from stepramp.controllers.inputs import InTheWay
from stepramp.devices.contact import Contact
from stepramp.devices.leases import Lease, Leases
from stepramp.devices.live_view import LiveView
from stepramp.devices.permit import Permit
from stepramp.devices.stopping import Stopping
from stepramp.devices.stops import OVERTAKEN, Order, Overtaken
from stepramp.devices.view import UNDER_WAY
from stepramp.devices.watch import Watch
from stepramp.errors import DeviceLost, Rescaled, StepRampError


def _nothing() -> None:
    pass


class SettingOut:
    """Has axes set out, if no stop has come since that was asked for. order: of all that is asked and stopped."""

    def __init__(
        self,
        view: LiveView,
        contact: Contact,
        watch: Watch,
        leases: Leases,
        permit: Permit,
        stopping: Stopping,
        order: Order,
    ) -> None:
        self._view = view
        self._contact = contact
        self._watch = watch
        self._leases = leases
        self._permit = permit
        self._stopping = stopping
        self._order = order

    def moment(self, request_number: int | None) -> int:
        """Return when something was asked for, in the order of all that is asked; None: now."""
        return self._order.next() if request_number is None else request_number

    def begin(
        self,
        what: str,
        axes: Collection[int],
        begin: Callable[[Controller], None],
        request_number: int | None,
        lease: Lease | None = None,
        then: Callable[[], None] = _nothing,
    ) -> None:
        """Have the worker set axes in motion, if no stop has come since it was asked for. From any thread.

        what: how the log calls it. lease: what they run on, if they do. then: called once it is granted.
        """
        at = self.moment(request_number)

        def set_out(controller: Controller) -> None:
            self._refuse_untold()
            self.newly(axes, lambda: self.permitted(axes, at, lambda: begin(controller), lease), lease, then)

        try:
            self._contact.ask(set_out)
        except StepRampError as error:
            self._view.log("%s: refused: %s", what, error)
            raise
        self._view.log("%s: begun", what)

    def go_on(self, renew: Callable[[Controller], None], request_number: int | None) -> None:
        """Let what moves go on, if no stop has come since that was asked for. From any thread."""
        at = self.moment(request_number)

        def renewed(controller: Controller) -> None:
            with self._permit.given(at):
                renew(controller)

        self._contact.ask(renewed)

    # From here on: in the thread of the port.

    def _refuse_untold(self) -> None:
        """Refuse once what a shuttle was refused once: who asks now has made steps of lengths, and need not know."""
        ended_by = self._view.now.ended_by
        self._view.change(lambda view: replace(view, ended_by=None))
        if isinstance(ended_by, Rescaled):
            raise Rescaled(str(ended_by))

    def newly(
        self,
        axes: Collection[int],
        job: Callable[[], None],
        lease: Lease | None = None,
        then: Callable[[], None] = _nothing,
    ) -> None:
        """Do what is asked of axes now. Once it is granted, what went on with them by itself ends."""
        view = self._view.now
        if view.soft_limits and (
            view.state in UNDER_WAY or any(each.microsteps or each.steps_per_mm for each in view.axes)
        ):
            # What is asked counts from where the axes would come to rest, not from where they were last heard, and by
            # the microsteps, or steps per mm, that they have now.
            self._watch.refresh()
        begun_s = monotonic()
        with self._permit.setting_out():
            job()
            with self._taken_back_on_failure(axes):
                self._leases.drop(axes)
                if lease is not None:
                    self._leases.take(lease, begun_s)
                self._view.change(lambda view: view.without_errand(axes).without_homing(axes))
                self._watch.refresh()
        with self._taken_back_on_failure(axes):
            then()

    def again(self, axes: Collection[int], request_number: int, begin: Callable[[], None]) -> None:
        """Set axes in motion that go on by themselves, for what was asked then."""
        with self._permit.setting_out():
            self.permitted(axes, request_number, begin)
            with self._taken_back_on_failure(axes):
                self._watch.refresh()

    def allow(self, request_number: int | None, job: Callable[[], None]) -> None:
        """Do what moves nothing itself, but lets motions be taken again, unless a stop has come since."""
        with self._seen_in_the_way(), self._permit.given(self.moment(request_number)):
            job()
        self._watch.refresh()

    @contextmanager
    def _seen_in_the_way(self) -> Iterator[None]:
        """Show at once what an input does that is in the way: at rest, the next look may be half a second away."""
        try:
            yield
        except InTheWay:
            self._watch.refresh()
            raise

    @contextmanager
    def _taken_back_on_failure(self, axes: Collection[int]) -> Iterator[None]:
        """Stop axes that have set out when what follows fails: whoever asked is told that, and expects no motion."""
        try:
            yield
        except DeviceLost:
            self._stopping.owe_what_may_have_set_out()
            raise
        except Exception:
            self._stopping.take_back(axes)
            raise

    def permitted(
        self, axes: Collection[int], request_number: int, begin: Callable[[], None], lease: Lease | None = None
    ) -> None:
        """Set axes in motion for what was asked then."""
        self._stopping.heed_others()
        try:
            with self._seen_in_the_way(), self._permit.given(request_number, lease):
                begin()
            self._stopping.settle_refused(request_number)
            if self._stopping.heed_others():
                # What was told in between set out after it, or was stopped by it.
                raise Overtaken(OVERTAKEN)
        except DeviceLost:
            # It may wait on the way, in a machine that hangs or a network, and set out once that goes on.
            if self._permit.has_sent:
                self._stopping.owe_what_may_have_set_out()
            raise
        except Exception as error:
            if self._permit.may_have_set_out(error):
                # A stop of other axes doesn't end it: what is refused must not move.
                self._stopping.take_back(axes)
            raise
