"""Which motion may set out just now: asked at the last instant before bytes go out. In the thread of a port."""

from collections.abc import Iterator
from contextlib import contextmanager

from stepramp.controllers.contract import AnswerUnknown
from stepramp.devices.leases import Lease
from stepramp.devices.stops import Overtaken, Stops
from stepramp.errors import Refused, StepRampError


class LetGo(Refused):
    """The lease that it was to run on has run out, or was ended, before it had set out."""

    def __init__(self) -> None:
        super().__init__("It was let go, or not told to go on in time, before it began.")


class Permit:
    """What was asked for at one moment may be sent, unless a stop has come since, or its lease no longer holds."""

    def __init__(self, stops: Stops) -> None:
        self._stops = stops
        self._request_number: int | None = None
        self._lease: Lease | None = None
        self.has_sent = False
        """Bytes of what was let through last have gone out."""
        self.is_unseen = False
        """Something may have set out, and it has not been looked since."""

    def check(self) -> None:
        """Raise Overtaken when what is about to be sent sets out what a stop came after, LetGo without a lease."""
        if self._request_number is not None:
            self._stops.refuse_overtaken(self._request_number)
            if self._lease is not None and not self._lease.holds:
                raise LetGo
            self.has_sent = True

    @contextmanager
    def given(self, request_number: int, lease: Lease | None = None) -> Iterator[None]:
        """Let that be sent which was asked for then, and runs on this lease, if on any."""
        self._request_number, self._lease, self.has_sent = request_number, lease, False
        try:
            # Refused here too: what the controller is asked first, as its state, may not have to be sent.
            self._stops.refuse_overtaken(request_number)
            yield
        finally:
            self._request_number = None

    @contextmanager
    def set_aside(self) -> Iterator[None]:
        """Let a stop be sent in the midst of what sets axes in motion."""
        request_number, self._request_number = self._request_number, None
        try:
            yield
        finally:
            self._request_number = request_number

    @contextmanager
    def setting_out(self) -> Iterator[None]:
        """Until it is seen what has set out, each stop in between looks itself: what it shows is not from before."""
        self.is_unseen = True
        try:
            yield
        finally:
            self.is_unseen = False

    def may_have_set_out(self, error: Exception) -> bool:
        """Tell whether what failed may be carried out all the same: the controller has not surely said no, or gone."""
        says_no = isinstance(error, StepRampError) and not isinstance(error, (Overtaken, LetGo, AnswerUnknown))
        return self.has_sent and not says_no
