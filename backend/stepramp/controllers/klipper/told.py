"""What Moonraker tells, as JSON: texts in it are such as can be told on."""

import json

from stepramp.errors import escaped


def told_json(message: bytes) -> object:
    """Return what a message says; ValueError when it is no JSON, or is nested too deeply.

    Half a surrogate pair is escaped: nothing that holds it could be answered to anybody.
    """
    try:
        return _whole(json.loads(message))
    except RecursionError:
        raise ValueError("It is nested too deeply.") from None


def _whole(told: object) -> object:
    if isinstance(told, str):
        return escaped(told)
    if isinstance(told, list):
        return [_whole(each) for each in told]
    return {escaped(name): _whole(each) for name, each in told.items()} if isinstance(told, dict) else told
