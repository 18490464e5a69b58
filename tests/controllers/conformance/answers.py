"""What controllers answer, and what they report."""

from __future__ import annotations

from controllers.protocol_line import Line
from stepramp.controllers.stepramp.messages.body import Request
from stepramp.controllers.stepramp.messages.motion import TargetsReply
from stepramp.controllers.stepramp.messages.reply import Refusal, ReplyStatus
from stepramp.controllers.stepramp.messages.report import ReportNotice

LONG_MOVE = 100_000
TOLERANCE_US = 10


def refused(line: Line, request: Request, status: ReplyStatus, detail: int | None = None) -> None:
    reply = line.ask(request)
    assert isinstance(reply, Refusal), reply
    assert reply.status is status
    assert detail in (None, reply.detail)


def moved(line: Line, request: Request) -> tuple[int, ...]:
    return line.good(request, TargetsReply).targets_steps


def reports(line: Line) -> list[ReportNotice]:
    return [notice for _, notice in line.notices if isinstance(notice, ReportNotice)]
