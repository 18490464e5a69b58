"""What the route about roles answers."""

from pydantic import Field

from stepramp.http_api.access import Role
from stepramp.http_api.answer import Answer


class AccessAnswer(Answer):
    """What somebody may do."""

    role: Role = Field(description="view: see everything, compute and stop. operate: also connect, push and move")
    is_shared: bool = Field(description="Whether other machines may use the server, too, by a token")
    place: str | None = Field(description="Address that whoever asks has; null for a server of its own machine only")
