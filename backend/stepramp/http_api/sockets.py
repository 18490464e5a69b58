"""What the routes share that talk over WebSockets."""

import json

from stepramp.errors import Rejected, Rejection


def parsed(text: str, allowed: str) -> object:
    """Return a message's JSON.

    Raises Rejected when it is none.
    """
    try:
        return json.loads(text)
    except ValueError:
        raise Rejected([Rejection("message", text, allowed)]) from None
