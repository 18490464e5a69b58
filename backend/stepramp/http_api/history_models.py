"""What the routes over the history of pushes take and answer."""

from typing import Annotated

from pydantic import Field

from stepramp.http_api.answer import Answer
from stepramp.validation import Document, Within


class PushesPayload(Document):
    """Which pushes are asked for; nothing: all of them."""

    device_id: str | None = Field(None, description="To this device only, as `GET /library/devices` calls it")
    design_id: str | None = Field(None, description="Of any revision of this design only")
    first: Annotated[int, Within(0, 1_000_000)] = Field(0, description="So many are left out, the newest ones")
    most: Annotated[int, Within(1, 500)] = Field(100, description="So many are told")


class SeenDeviceAnswer(Answer):
    """A controller that was connected."""

    id: str = Field(description="What the library calls it: the same whenever it is connected, and in any library")
    family: str = Field(description="The name of its family")
    identity: str = Field(description="What tells it apart: its USB serial number, else its port or host")
    name: str = Field(description="What it was called last")
    port: str = Field(description="Where it was last")
    first_seen_at: str = Field(description="In UTC")
    last_seen_at: str = Field(description="In UTC")
    pushes: int = Field(description="How many there were")


class SeenDevicesAnswer(Answer):
    """The controllers that were connected."""

    devices: list[SeenDeviceAnswer] = Field(description="That seen last first")


class KeptRevisionAnswer(Answer):
    """A revision of the library."""

    design_id: str = Field(description="What the library calls its design")
    name: str = Field(description="Of the design")
    number: int = Field(description="Of the revision, counted from 1")


class PushedAxisAnswer(Answer):
    """What an axis was given."""

    axis: int = Field(description="Counted from 0")
    name: str = Field(description="Of the design that was pushed")
    content_hash: str = Field(description="Of that design, as revisions have it")
    revisions: list[KeptRevisionAnswer] = Field(description="Those that are the same, up to 20, the newest first")


class PushedToAnswer(Answer):
    """A push."""

    id: str = Field(description="What the routes call it")
    device_id: str = Field(description="To which device, as `GET /library/devices` calls it")
    device: str = Field(description="What that was called last")
    pushed_at: str = Field(description="When it ended, in UTC")
    client: str | None = Field(description="Who asked for it, on a shared server; null: nobody is told apart")
    mode: str = Field(description="keep: to be stored; try: until it is rolled back")
    trouble: str | None = Field(description="Why it failed; null: it didn't")
    verified: bool | None = Field(description="Whether all that was read back is as sent; null: nothing was, it failed")
    backup: str | None = Field(description="The last backup that was saved before; null for none")
    axes: list[PushedAxisAnswer] = Field(description="Of each axis that was given a ramp")


class PushedDesignAnswer(Answer):
    """The design that an axis was given."""

    axis: int = Field(description="Counted from 0")
    design: dict[str, object] = Field(description="The document, as it was pushed")


class PushedToWithDesignsAnswer(PushedToAnswer):
    """A push with what was sent and read back."""

    report: dict[str, object] | None = Field(description="As the push was answered; null where it failed")
    designs: list[PushedDesignAnswer] = Field(description="Of each axis")


class PushesAnswer(Answer):
    """Pushes that were found."""

    count: int = Field(description="How many there are, also those that aren't told")
    pushes: list[PushedToAnswer] = Field(description="The newest first")
