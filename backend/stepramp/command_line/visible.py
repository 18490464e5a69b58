"""Text of others as a terminal may show it: what would steer it, or turn the order of letters, is escaped."""

import json
import re

_STEERING = re.compile(
    # Controls but line ends and tabs, marks of direction and what has no width, halves of surrogate pairs. What joins
    # letters in some scripts, and pictures, stays.
    r"[\x00-\x08\x0b-\x1f\x7f-\x9f\xad\u061c\u180e\u200b\u200e\u200f\u2028-\u202e\u2060-\u206f\ufeff\ufff9-\ufffb"
    r"\ud800-\udfff\U000e0000-\U000e007f]"
)


def visible(text: str) -> str:
    """Return text with a backslash and a number in place of what steers a terminal."""
    return _STEERING.sub(lambda found: found[0].encode("unicode_escape").decode(), text)


def visible_json(text: str) -> str:
    """Return JSON that says the same, without what steers a terminal."""
    return _STEERING.sub(lambda found: json.dumps(found[0])[1:-1], text)
