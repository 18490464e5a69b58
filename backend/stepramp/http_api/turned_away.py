"""Who asks without a token that counts: told in the log, of each place once a minute, so that nobody can fill it."""

import logging
import time
from collections import OrderedDict
from collections.abc import Callable

from starlette.types import Scope

from stepramp.errors import brief

EACH_S = 60.0
MOST_PLACES = 1000
"""So many are told apart; of who was told of longest ago it is forgotten."""

_logger = logging.getLogger(__name__)


class TurnedAway:
    """Those who were, by their places. In the server's loop."""

    def __init__(self, now_s: Callable[[], float] = time.monotonic) -> None:
        self._now_s = now_s
        self._told: OrderedDict[str, tuple[float, int]] = OrderedDict()
        """When each was told of last [s], and how often it was turned away since."""

    def note(self, scope: Scope) -> None:
        """Tell of a request or WebSocket, or count it where its place was told of in the last minute."""
        place = str((scope.get("client") or ("somewhere",))[0])
        told_at_s, others = self._told.get(place, (None, 0))
        now_s = self._now_s()
        if told_at_s is not None and now_s - told_at_s < EACH_S:
            self._told[place] = (told_at_s, others + 1)
            return
        self._told[place] = (now_s, 0)
        self._told.move_to_end(place)
        while len(self._told) > MOST_PLACES:
            self._told.popitem(last=False)
        asked = f"{scope.get('method', 'WebSocket')} {brief(scope['path'])}"
        more = f", and {others:,} times more since it was told last" if others else ""
        _logger.warning("%s asked without a token of this server: %r%s.", place, asked, more)
