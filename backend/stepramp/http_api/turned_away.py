"""Who asks without a token that counts: told in the log, of each place once a minute, so that nobody can fill it."""

import logging
import time
from collections import OrderedDict
from collections.abc import Callable
from ipaddress import IPv6Address, IPv6Network, ip_address

from starlette.types import Scope

from stepramp.errors import brief

EACH_S = 60.0
MOST_LINES = 100
"""So many lines are written within that, of all places together."""
MOST_PLACES = 1000
"""So many are told apart; of who was told of longest ago it is forgotten."""
NETWORK_BITS = 64
"""Of an IPv6 address: the rest of it whoever has such a network chooses at will."""

_logger = logging.getLogger(__name__)


class TurnedAway:
    """Those who were, by their places. In the server's loop."""

    def __init__(self, now_s: Callable[[], float] = time.monotonic) -> None:
        self._now_s = now_s
        self._told: OrderedDict[str, tuple[float, int]] = OrderedDict()
        """When each was told of last [s], and how often it was turned away since."""
        self._since_s: float | None = None
        """When the present minute began [s], in which so many lines were written, and so many not."""
        self._lines = self._left_out = 0

    def note(self, scope: Scope) -> None:
        """Tell of a request or WebSocket, or count it where its place was told of in the last minute."""
        place = str((scope.get("client") or ("somewhere",))[0])
        network, now_s = _network_of(place), self._now_s()
        told_at_s, others = self._told.get(network, (None, 0))
        if told_at_s is not None and now_s - told_at_s < EACH_S:
            self._told[network] = (told_at_s, others + 1)
            return
        if not self._may_write(now_s):
            return
        self._told[network] = (now_s, 0)
        self._told.move_to_end(network)
        while len(self._told) > MOST_PLACES:
            self._told.popitem(last=False)
        asked = f"{scope.get('method', 'WebSocket')} {brief(scope['path'])}"
        more = f", and {others:,} times more since it was told last" if others else ""
        _logger.warning("%s asked without a token of this server: %r%s.", place, asked, more)

    def _may_write(self, now_s: float) -> bool:
        """Take one of the minute's lines; count it as left out where there is none any more."""
        if self._since_s is None or now_s - self._since_s >= EACH_S:
            if self._left_out:
                _logger.warning(
                    "Others asked %s times without a token: more than %d lines a minute are not written.",
                    f"{self._left_out:,}",
                    MOST_LINES,
                )
            self._since_s, self._lines, self._left_out = now_s, 0, 0
        is_room = self._lines < MOST_LINES
        self._lines += is_room
        self._left_out += not is_room
        return is_room


def _network_of(place: str) -> str:
    """Return what counts as one place: an IPv4 address, or the network of an IPv6 one."""
    try:
        address = ip_address(place)
    except ValueError:
        return place
    if not isinstance(address, IPv6Address):
        return place
    mapped = address.ipv4_mapped
    return str(IPv6Network((int(address), NETWORK_BITS), strict=False)) if mapped is None else str(mapped)
