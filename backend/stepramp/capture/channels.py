"""Channels: which of them steps the motor, and which says in what direction."""

import re
from dataclasses import dataclass

from stepramp.capture.recording import Recording
from stepramp.capture.steps import Edge
from stepramp.errors import Rejected, Rejection

EACH_EDGE = "each edge"
"""In the name of a channel: each of its edges is a step."""
_STEP = re.compile(r"step|stp|pul|clk|clock", re.IGNORECASE)
_DIRECTION = re.compile(r"dir|cw", re.IGNORECASE)
MOST_NAMED = 20


@dataclass(frozen=True)
class Choice:
    """Channels by number, counted from 0, and the edge that steps."""

    step: int
    direction: int | None
    edge: Edge


def chosen(recording: Recording, step: str | None, direction: str | None, edge: Edge | None) -> Choice:
    """Return the channels of these names; what is None is guessed, and an empty direction is none.

    Raises Rejected for a channel that isn't there, and for one that is both.
    """
    step_number = likely_step(recording) if step is None else _numbered("step_channel", step, recording)
    if direction is None:
        direction_number = likely_direction(recording, step_number)
    else:
        direction_number = _numbered("direction_channel", direction, recording) if direction else None
    if direction_number == step_number:
        allowed = "another channel than the step channel, or none"
        raise Rejected([Rejection("direction_channel", recording.channels[step_number], allowed)])
    return Choice(step_number, direction_number, edge or likely_edge(recording.channels[step_number]))


def likely_step(recording: Recording) -> int:
    """Return the channel that most likely steps: by its name if it has edges, else the one with most edges."""
    edges = recording.edges_of()
    named = [each for each, name in enumerate(recording.channels) if _STEP.search(name) and edges[each]]
    return max(named or range(len(recording.channels)), key=lambda each: int(edges[each]))


def likely_direction(recording: Recording, step: int) -> int | None:
    """Return the channel whose name says direction, if there is one."""
    named = (each for each, name in enumerate(recording.channels) if _DIRECTION.search(name) and each != step)
    return next(named, None)


def likely_edge(name: str) -> Edge:
    """Return the edge that steps, as the name of a channel says; most drivers step at the rising one."""
    return "both" if EACH_EDGE in name.lower() else "rising"


def _numbered(field: str, name: str, recording: Recording) -> int:
    if name in recording.channels:
        return recording.channels.index(name)
    names = ", ".join(recording.channels[:MOST_NAMED]) + (" …" if len(recording.channels) > MOST_NAMED else "")
    raise Rejected([Rejection(field, name, f"one of the file's channels: {names}")])
