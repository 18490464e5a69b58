"""What a stop asks for: the axes that its body names, or else all, since no stop may fail for form's sake."""

from collections.abc import Sequence

from stepramp.errors import Rejected
from stepramp.http_api.stopping_models import AxesPayload
from stepramp.json_text import parsed_json

MOST_BYTES = 1024
"""Many times what `{"axes": [0, 1, 2, 3]}` takes; nobody waits for what is longer to be understood [bytes]."""


def axes_of_stop(body: bytes) -> Sequence[int] | None:
    """Return the axes that a stop's body names, in ascending order; None, which is all, when it names none rightly."""
    if len(body) > MOST_BYTES:
        return None
    try:
        return AxesPayload.checked(parsed_json(body.decode())).axes
    except (Rejected, ValueError):
        return None
