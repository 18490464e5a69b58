"""What the routes that make designs of a controller's settings take and answer."""

from typing import Annotated

from pydantic import Field

from stepramp.design import Design
from stepramp.examples import all_examples
from stepramp.http_api.answer import Answer
from stepramp.http_api.error_items import TOLD_OF_EACH, ToldAnswer
from stepramp.validation import Document, Text

MOST_CHARACTERS = 100_000


class BasePayload(Document):
    """What a controller doesn't tell."""

    design: Design | None = Field(
        None,
        description="Holds where the controller says nothing: timer, method, move, motor; null: the first example",
    )

    @property
    def base(self) -> Design:
        """That design."""
        return Design.checked(all_examples()[0]["design"]) if self.design is None else self.design


class ImportPayload(BasePayload):
    """What a controller tells of itself."""

    text: Annotated[str, Text(MOST_CHARACTERS)] = Field(description="Lines as it tells them; others are left out")


class ReadAxisAnswer(Answer):
    """One axis of a controller, as a design."""

    name: str = Field(description="What the controller calls it")
    design: Design
    remarks: list[str] = Field(description="What is not as the controller has it, as sentences")
    remarks_told: list[list[ToldAnswer]] = Field(description=TOLD_OF_EACH)


class ImportAnswer(Answer):
    """A controller's settings as designs."""

    family: str = Field(description="The family whose settings they are")
    axes: list[ReadAxisAnswer] = Field(description="In the controller's order")
