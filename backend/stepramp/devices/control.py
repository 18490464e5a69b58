"""Which page is in control of a device."""

from dataclasses import replace

from stepramp.devices.live_view import LiveView
from stepramp.devices.view import DeviceView
from stepramp.errors import Refused


class Control:
    """The page in control of a device, if one is. For any thread."""

    def __init__(self, view: LiveView) -> None:
        self._view = view

    def take(self, page: str, place: str | None = None, *, over: bool = False) -> None:
        """Put a page in control; Refused while another one is, unless it is taken over. place: where it is."""

        def taken(view: DeviceView) -> DeviceView:
            if not over:
                _refuse_others(view, page)
            return replace(view, in_control=page, in_control_at=place)

        self._view.change(taken)

    def leave(self, page: str) -> None:
        """Note that a page is gone."""

        def left(view: DeviceView) -> DeviceView:
            return replace(view, in_control=None, in_control_at=None) if view.in_control == page else view

        self._view.change(left)

    def refuse_others(self, page: str) -> None:
        """Refused while a page other than this one is in control."""
        _refuse_others(self._view.now, page)

    def refuse_without(self, page: str | None) -> None:
        """Refused for what ends with a page, when that is not in control; None: it ends with none."""
        if page is not None:
            self.refuse_others(page)
            if self._view.now.in_control != page:
                raise Refused("Nothing moved: its page is gone.")


def _refuse_others(view: DeviceView, page: str) -> None:
    if view.in_control not in (None, page):
        at = "" if view.in_control_at is None else f" at {view.in_control_at}"
        raise Refused(f"Another page{at} is in control of {view.name}: take over first.")
