"""Which kinds of requests and notices there are."""

from stepramp.controllers.stepramp.messages.body import Notice, Request
from stepramp.controllers.stepramp.messages.message import Message
from stepramp.controllers.stepramp.messages.motion import (
    AcknowledgeRequest,
    HaltRequest,
    HomeRequest,
    LineRequest,
    MoveByRequest,
    MoveToRequest,
    RunRequest,
    SetPositionRequest,
    StopRequest,
    ZeroRequest,
)
from stepramp.controllers.stepramp.messages.ramps import (
    BeginRequest,
    CommitRequest,
    DataRequest,
    EndRequest,
    ReadRequest,
    RollBackRequest,
    TryRequest,
)
from stepramp.controllers.stepramp.messages.report import ReportNotice, ReportRequest
from stepramp.controllers.stepramp.messages.session import HelloRequest
from stepramp.controllers.stepramp.messages.settings import (
    ReadLimitsRequest,
    ReadSettingsRequest,
    WriteLimitsRequest,
    WriteSettingsRequest,
)
from stepramp.controllers.stepramp.messages.status import StatusRequest
from stepramp.controllers.stepramp.messages.trace import TraceNotice, TraceRequest

REQUESTS: dict[int, type[Request]] = {
    request.KIND: request
    for request in (
        HelloRequest,
        StatusRequest,
        ReportRequest,
        TraceRequest,
        BeginRequest,
        DataRequest,
        EndRequest,
        CommitRequest,
        ReadRequest,
        TryRequest,
        RollBackRequest,
        ReadSettingsRequest,
        WriteSettingsRequest,
        ReadLimitsRequest,
        WriteLimitsRequest,
        MoveByRequest,
        MoveToRequest,
        RunRequest,
        LineRequest,
        SetPositionRequest,
        ZeroRequest,
        AcknowledgeRequest,
        HomeRequest,
        StopRequest,
        HaltRequest,
    )
}
NOTICE_KINDS: dict[int, type[Notice]] = {notice.KIND: notice for notice in (ReportNotice, TraceNotice)}


def unpack_notice(message: Message) -> Notice | None:
    """Return a message as a notice; None for a kind that is not known, or a body that makes no sense."""
    kind = NOTICE_KINDS.get(message.kind)
    try:
        return None if kind is None else kind.unpack(message.body)
    except ValueError:
        return None
