"""Leases: axes run only as long as somebody says, again and again, that they shall."""

import threading
from collections.abc import Iterable, Mapping
from time import monotonic

JOG_S = 0.4
"""How long an axis runs on without being told so again while a button is held [s]: a few renewals may be late, a finger
never is."""


class Lease:
    """What axes run on, for any thread. Once it has run out or was ended, nothing brings it back.

    speeds: those of the axes that run on it, negative for backwards [steps/s]. lasts_s: how long, and how long again
    after each renewal [s]. page: whose it is, if a page's: it holds only while that page is in control. is_to_home:
    they run until they have found their switches. name: by which whoever asked for it renews it.
    """

    def __init__(
        self,
        speeds: Mapping[int, float],
        lasts_s: float = JOG_S,
        page: str | None = None,
        *,
        is_to_home: bool = False,
        name: str = "",
    ) -> None:
        self.speeds = {axis: speed for axis, speed in speeds.items() if speed}
        self.page = page
        self.is_to_home = is_to_home
        self.name = name
        self._lasts_s = lasts_s
        self._lock = threading.Lock()
        self._until_s = monotonic() + lasts_s

    @property
    def holds(self) -> bool:
        """Whether it has neither run out nor been ended."""
        with self._lock:
            return monotonic() < self._until_s

    def holds_with(self, in_control: str | None) -> bool:
        """Whether it holds when that page is in control, or none."""
        return self.holds and self.page in (None, in_control)

    def renew(self, lasts_s: float | None = None) -> bool:
        """Let it last as long again, or so long from now on [s]; return whether it still held."""
        with self._lock:
            held = monotonic() < self._until_s
            if held:
                self._lasts_s = self._lasts_s if lasts_s is None else lasts_s
                self._until_s = monotonic() + self._lasts_s
            return held

    @property
    def lasts_s(self) -> float:
        """How long it lasts after it began, or was renewed [s]."""
        return self._lasts_s

    def end(self) -> None:
        """Let it run out now."""
        with self._lock:
            self._until_s = 0.0


class Leases:
    """Which axes of a device run on which lease. In the thread of its port."""

    def __init__(self) -> None:
        self._of_axes: dict[int, Lease] = {}
        self._set_out_s: dict[int, float] = {}

    def take(self, lease: Lease, set_out_s: float) -> None:
        """Note that axes run on a lease, and on no other, since that instant at the earliest [s]."""
        self._of_axes |= dict.fromkeys(lease.speeds, lease)
        self._set_out_s |= dict.fromkeys(lease.speeds, set_out_s)

    def drop(self, axes: Iterable[int] | None = None) -> None:
        """Note that these axes, or all, no longer run."""
        self._of_axes = {} if axes is None else {axis: self._of_axes[axis] for axis in set(self._of_axes) - set(axes)}

    def named(self, name: str, speeds: Mapping[int, float]) -> Lease | None:
        """Return the lease of a name that axes run on at these speeds, and no others do; None without one."""
        wanted = {axis: speed for axis, speed in speeds.items() if speed}
        leases = {self._of_axes.get(axis) for axis in wanted}
        lease = leases.pop() if len(leases) == 1 else None
        return lease if lease is not None and lease.name == name and lease.speeds == wanted else None

    def run_out(self, in_control: str | None) -> list[int]:
        """Return the axes whose lease no longer holds, when that page is in control."""
        return sorted(axis for axis, lease in self._of_axes.items() if not lease.holds_with(in_control))

    def set_out_s(self, axis: int) -> float:
        """Return when an axis set out that runs on a lease, at the earliest [s]."""
        return self._set_out_s[axis]

    @property
    def speeds(self) -> dict[int, float]:
        """Speeds that axes run at on a lease, negative for backwards [steps/s]; of those being homed none is known."""
        return {axis: lease.speeds[axis] for axis, lease in self._of_axes.items() if not lease.is_to_home}
